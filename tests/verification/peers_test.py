# SPDX-License-Identifier: BSD-2-Clause
"""Comparisons with other codes: the input of CalculiX, its output, and differences of impacts."""

import contextlib
import dataclasses
import io
import os
import pathlib
import shutil
import tempfile
import unittest
import unittest.mock

import numpy as np

import calculix_contact
import peer_impact
import peer_report
import quarter_disks
from benchmarks.calculix import Cache
from peers import disks
from ricochet import programs
from ricochet.errors import InputError, SolverError

GEO = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 2, 3};
Mesh.MeshSizeMin = 2;
Mesh.MeshSizeMax = 2;
Physical Volume("box") = {1};
Physical Surface("side") = {3};
Physical Surface("bottom") = {5};
Physical Surface("top") = {6};
"""
TABLE = {
    "rotate_deg": [0, 0, 0],
    "translate": [0, 0, 0.5],
    "contact": ["bottom"],
    "support": {"side": "y"},
    "material": {"density": 2.0, "young": 1e3, "poisson": 0.2},
    "velocity": [0.3, 0.0, -0.1],
}
PRINTED = """
 statistics for slave set SBOX, master set SPLANE and time  0.1000000E+00

   total surface force (fx,fy,fz) and moment about the origin (mx,my,mz)

   -1.000000E+00  2.000000E+00  3.000000E+00  4.000000E+00  5.000000E+00  6.000000E+00

   center of gravity and mean normal

    1.000000E+00  0.000000E+00  0.000000E+00  0.000000E+00  0.000000E+00 -1.000000E+00

   moment about the center of gravity(mx,my,mz)

    0.000000E+00  0.000000E+00  0.000000E+00

   area,  normal force (+ = tension) and shear force (size)

    6.000000E-01 -3.000000E+00  2.236068E+00

 total kinetic energy for set EBOX and time  0.1000000E+00

        1.250000E+00

 total internal energy for set EBOX and time  0.1000000E+00

        2.500000E-01
"""


def impact(code, time, force, velocity, spin=0.0, cpu=1.0, area=0.0):
    parts = {"run": {"seconds": cpu, "cpu_seconds": cpu}}
    spin, area = np.array([0, spin, 0]), np.full(len(time), area)
    return peer_impact.Impact(code, "", time, force, np.array(velocity), spin, 1.0, parts, area)


FRAME = peer_impact.Frame(np.array([0.0, 0, 1]), np.array([1.0, 0, 0]), 2.0, 0.5)


class CalculixContactTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scope = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scope.name)
        (cls.folder / "box.geo").write_text(GEO)
        calculix_contact.mesh_file(cls.folder / "box.geo", {}, 2, cls.folder / "box.msh")
        cls.body = calculix_contact.body_of(cls.folder / "box.msh", "box", TABLE)

    @classmethod
    def tearDownClass(cls):
        cls.scope.cleanup()

    def test_mass_and_motion_of_a_box(self):
        body = self.body
        self.assertAlmostEqual(body.mass, 12, 9)
        np.testing.assert_allclose(body.centre, [0.5, 1, 2], atol=1e-9)
        np.testing.assert_allclose(body.inertia, np.diag([13, 10, 5]), atol=1e-9)
        spin, velocity = np.array([0.2, -0.3, 0.7]), np.array([1.0, 2, 3])
        v = velocity + np.cross(spin, body.node - body.centre)
        np.testing.assert_allclose(body.mean_velocity(v), velocity, rtol=1e-9)
        np.testing.assert_allclose(body.spin(v), spin, rtol=1e-9)

    def test_a_turned_box(self):
        table = TABLE | {"support": {}, "rotate_deg": [90, 0, 90]}
        body = calculix_contact.body_of(self.folder / "box.msh", "box", table)
        # y becomes z and then stays; z becomes -y and then x; x stays and then becomes y.
        np.testing.assert_allclose(body.centre, [1.5, 0.5, 1.5], atol=1e-9)
        np.testing.assert_allclose(body.inertia, np.diag([5, 13, 10]), atol=1e-9)
        oblique = calculix_contact.body_of(
            self.folder / "box.msh", "box", table | {"rotate_deg": [20, 30, 40]}
        )
        np.testing.assert_allclose(np.linalg.eigvalsh(oblique.inertia), [5, 10, 13], rtol=1e-9)
        spin = np.array([0.2, -0.3, 0.7])
        v = np.cross(spin, oblique.node - oblique.centre)
        np.testing.assert_allclose(oblique.spin(v), spin, rtol=1e-9)
        with self.assertRaisesRegex(InputError, "supports along the axes"):
            calculix_contact.body_of(self.folder / "box.msh", "box", TABLE | {"rotate_deg": [0, 0, 1]})

    def test_parameters_of_a_geometry(self):
        geo = self.folder / "cube.geo"
        geo.write_text(
            'DefineConstant[a = 1];\nSetFactory("OpenCASCADE");\nBox(1) = {0, 0, 0, a, a, a};\n'
            'Physical Volume("box") = {1};\nPhysical Surface("bottom") = {5};\n'
        )
        for parameters, volume in (({}, 1), ({"a": 3.0}, 27)):
            calculix_contact.mesh_file(geo, parameters, 2, self.folder / "cube.msh")
            body = calculix_contact.body_of(self.folder / "cube.msh", "box", TABLE | {"support": {}})
            self.assertAlmostEqual(body.mass, 2 * volume, 9)

    def test_the_bracket_stands_on_its_corner(self):
        path = programs.ROOT / "meshes" / "bracket" / "bracket.toml"
        scene, bodies, words = peer_impact.bodies(path, [], self.folder)
        bracket = bodies["bracket"]
        lowest = bracket.node[:, 2].argmin()
        # 1 µm in the scene; the nearest node is within half an element of 0.1 mm on a sphere of 5.8 mm.
        self.assertGreater(bracket.node[lowest, 2], 0.9e-6)
        self.assertLess(bracket.node[lowest, 2], 1.5e-6)
        self.assertLess(
            np.linalg.norm(bracket.node[bracket.contact] - bracket.node[lowest], axis=2).min(), 1e-4
        )
        # Two plates, but for the worn corner.
        self.assertAlmostEqual(bracket.mass / (7850 * (0.06 + 0.034) * 0.04 * 0.006), 1, 3)
        floor = peer_impact.half_space(scene, "floor", bracket)
        np.testing.assert_allclose(floor.nodes()[4:, 2], 0, atol=1e-12)
        self.assertIn("bodies.bracket.geometry={}", words)

    def test_quarters_of_the_disks_almost_touch(self):
        path = quarter_disks.write(self.folder)
        for words, hole in ((disks.SETTINGS, 0), (quarter_disks.geometry(hole=0.03, largest=5e-3), 0.03)):
            bodies = peer_impact.bodies(path, words, self.folder)[1]
            area = np.pi * (quarter_disks.RADIUS**2 - hole**2)
            for body in bodies.values():
                # Sides of order 2 deviate from the circle by the fourth power of their angle.
                self.assertAlmostEqual(body.mass / (11.3e3 * area * quarter_disks.THICKNESS / 4), 1, 4)
                self.assertEqual(body.node[body.supported[0], 0].min(), 0)
            upper, lower = bodies["upper"].node, bodies["lower"].node
            gap = disks.START if words is disks.SETTINGS else quarter_disks.GAP
            self.assertAlmostEqual(upper[:, 1].min() - lower[:, 1].max(), gap, 12)
            supported = bodies["lower"].supported
            np.testing.assert_allclose(np.hypot(*lower[supported[1], :2].T), quarter_disks.RADIUS, rtol=1e-9)
            self.assertLess(lower[supported[1], 1].max(), 1e-9)
            self.assertEqual(set(bodies["upper"].supported), {0, 2})

    def test_faces_and_supports(self):
        corners = self.body.node[self.body.contact]
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        self.assertAlmostEqual(area.sum() / 2, 2, 12)
        for (element, face), facet in zip(self.body.faces(), self.body.contact):
            self.assertLess(set(facet), set(self.body.element[element][:4]))
            self.assertRegex(face, "^S[1-4]$")
        np.testing.assert_allclose(self.body.node[self.body.supported[1]][:, 1], 0, atol=1e-12)

    def test_middle_nodes_follow_calculix(self):
        pairs = calculix_contact.TETRAHEDRON.edges
        for nodes in self.body.node[self.body.element]:
            for k, (a, b) in enumerate(pairs, 4):
                np.testing.assert_allclose(nodes[k], (nodes[a] + nodes[b]) / 2, atol=1e-12)

    def test_half_space(self):
        nodes = calculix_contact.HalfSpace("plane", [1, 2, 3], [0, 2, 0], 5.0).nodes()
        np.testing.assert_allclose(nodes[4:, 1], 2, atol=1e-12)
        np.testing.assert_allclose(nodes[:4, 1], -3, atol=1e-12)
        first, second, up = nodes[1] - nodes[0], nodes[3] - nodes[0], nodes[4] - nodes[0]
        self.assertAlmostEqual(np.dot(np.cross(first, second), up), 500, 9)

    def test_two_supports_may_hold_the_same_component(self):
        table = TABLE | {"support": {"side": "y", "top": "yz"}}
        body = calculix_contact.body_of(self.folder / "box.msh", "box", table)
        y, z = body.node[:, 1], body.node[:, 2]
        self.assertEqual(set(body.supported[1]), set(np.flatnonzero((y < 1e-9) | (z > 3.5 - 1e-9))))
        self.assertEqual(set(body.supported[2]), set(np.flatnonzero(z > 3.5 - 1e-9)))

    def test_printed_blocks(self):
        velocities = "".join(f"{n} 1.0E+00 0.0E+00 -2.0E+00\n" for n in range(1, len(self.body.node) + 1))
        text = f"{PRINTED}\n velocities (vx,vy,vz) for set NBOX and time  0.1000000E+00\n\n{velocities}"
        found = calculix_contact.read(text, [self.body])
        self.assertEqual((found["time"], found["force"]), ([0.1], [[-1, 2, 3]]))
        self.assertEqual((found["area"], found["energy"]), ([0.6], [1.5]))
        np.testing.assert_allclose(found["velocity"]["box"], [1, 0, -2], atol=1e-12)

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed: scripts/setup --tests")
    def test_free_flight_and_its_cache(self):
        obstacle = calculix_contact.HalfSpace("plane", [0, 0, 0], [0, 0, 1], 5.0)
        contact = calculix_contact.Contact("box", "plane", 1e6, 0.3, 1e5)
        steps = calculix_contact.Steps(0.1, 0.2)
        cache = Cache(self.folder / "cache.json")
        words = ([self.body], [obstacle], contact, steps)
        found = calculix_contact.run(self.folder / "run", *words, cache)
        self.assertTrue(found["complete"])
        np.testing.assert_allclose(found["force"], np.zeros((2, 3)), atol=1e-12)
        np.testing.assert_allclose(found["velocity"]["box"], TABLE["velocity"], atol=1e-6)
        np.testing.assert_allclose(found["energy"], 0.6, rtol=1e-5)
        again = calculix_contact.run(self.folder / "none", *words, Cache(self.folder / "cache.json"))
        self.assertEqual(again, found)

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed: scripts/setup --tests")
    def test_free_fall(self):
        obstacle = calculix_contact.HalfSpace("plane", [0, 0, 0], [0, 0, 1], 5.0)
        contact, gravity = calculix_contact.Contact("box", "plane", 1e6), [0.2, 0.0, -0.4]
        steps = calculix_contact.Steps(0.1, 0.2, gravity=gravity)
        body = dataclasses.replace(self.body, supported={})
        found = calculix_contact.run(self.folder / "fall", [body], [obstacle], contact, steps, Cache())
        # alpha delays the mean acceleration by a twentieth of a step at most.
        np.testing.assert_allclose(
            found["velocity"]["box"], TABLE["velocity"] + 0.2 * np.array(gravity), atol=0.005 * 0.4
        )

    def test_a_run_that_was_killed_is_not_kept(self):
        program = self.folder / "killed" / "ccx"
        program.parent.mkdir()
        program.write_text("#!/bin/sh\nkill -TERM $$\n")
        program.chmod(0o755)
        contact = calculix_contact.Contact("box", "plane", 1e6)
        cache, steps = Cache(), calculix_contact.Steps(0.1, 0.2)
        path = f"{program.parent}:{os.environ['PATH']}"
        with unittest.mock.patch.dict(os.environ, PATH=path), self.assertRaisesRegex(
            SolverError, "signal 15"
        ):
            calculix_contact.run(program.parent, [self.body], [], contact, steps, cache)
        self.assertEqual(cache.entries[0]["runs"], [])

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed: scripts/setup --tests")
    def test_two_elastic_bodies_exchange_momentum(self):
        table = TABLE | {"support": {}, "velocity": [0.0, 0.0, 0.0], "contact": ["top"]}
        lower = calculix_contact.body_of(self.folder / "box.msh", "lower", table)
        table |= {"translate": [0, 0, 3.501], "velocity": [0.0, 0.0, -0.5], "contact": ["bottom"]}
        upper = calculix_contact.body_of(self.folder / "box.msh", "upper", table)
        contact = calculix_contact.Contact("upper", "lower", 1e4)
        steps = calculix_contact.Steps(4e-3, 0.32)
        cache = Cache(self.folder / "pair.json")
        found = calculix_contact.run(self.folder / "pair", [upper, lower], [], contact, steps, cache)
        self.assertTrue(found["complete"])
        force = np.array(found["force"])[:, 2]
        self.assertGreater(force.max(), 0)
        self.assertEqual(force[-1], 0)
        change = {
            body.name: body.mass * (np.array(found["velocity"][body.name]) - body.velocity)[2]
            for body in (upper, lower)
        }
        # Newton's laws; the iterations end at residuals of half a per cent, and the steps cut the ends of the contact.
        self.assertAlmostEqual(change["upper"] / change["lower"], -1, 2)
        self.assertAlmostEqual(force.sum() * steps.step / change["upper"], 1, 2)

    def test_friction_is_written_only_where_it_acts(self):
        self.assertNotIn("FRICTION", calculix_contact.Contact("a", "b", 1e6).law())
        self.assertIn("FRICTION\n3.0", calculix_contact.Contact("a", "b", 1e6, 0.3, 1e5).law())


class ImpactTest(unittest.TestCase):
    def test_differences(self):
        time = np.linspace(0.01, 1, 100)
        push = np.sin(np.pi * time)[:, None]
        one = impact("Ricochet", time, push * [0.2, 0, 1], [1, 0, 2], spin=3)
        other = impact("CalculiX", time, push * [0.1, 0, 1.1], [1.2, 0, 1.9], spin=2)
        found = peer_impact.difference(one, other, FRAME)
        expected = {
            "normal": 1 / 11,
            "tangential": 1,
            "rebound": 0.05,
            "slide": 0.1,
            "spin": 0.25,
            "largest": 1,
        }
        for kind, value in expected.items():
            self.assertAlmostEqual(found[kind], value, 9, kind)
        self.assertAlmostEqual(one.duration(FRAME.normal), 1, 1)

    def test_only_the_kinds_of_a_frame_are_compared(self):
        frame = dataclasses.replace(FRAME, kinds=("normal", "rebound"))
        one, other = (
            impact("Ricochet", np.array([1.0]), np.array([[0, 0, f]]), [0, 0, f]) for f in (1.0, 2.0)
        )
        self.assertEqual(
            peer_impact.difference(one, other, frame), {"normal": 0.5, "rebound": 0.5, "largest": 0.5}
        )
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            peer_report.side_by_side([one], dataclasses.replace(frame, copies=4), 1.0)
        head, _, row = printed.getvalue().splitlines()
        self.assertEqual(head.count("friction") + head.count("spin"), 0)
        self.assertEqual(row.split(" | ")[1], "4")

    def test_the_width_of_a_strip_is_its_area_over_its_depth(self):
        frame = dataclasses.replace(FRAME, kinds=("normal",), copies=4, depth=0.5)
        time, force = np.array([1.0, 2.0]), np.array([[0, 0, 1.0], [0, 0, 1.0]])
        one, other = (impact("Ricochet", time, force, [0, 0, 0], area=area) for area in (0.03, 0.02))
        np.testing.assert_allclose(one.width(frame, np.array([0.5, 1.5, 3.0])), [0.12, 0.24, 0], rtol=1e-12)
        found = peer_impact.difference(one, other, frame)
        self.assertAlmostEqual(found["width"], 0.5, 12)
        self.assertEqual(found["largest"], 0)
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            peer_report.side_by_side([one], frame, 1.0)
            peer_report.convergence([one], {"Ricochet": one, "CalculiX": other}, frame)
        self.assertIn("| 240 |", printed.getvalue())
        self.assertIn("| – / 5.0e-01 |", printed.getvalue())

    def test_a_limit_is_extrapolated(self):
        time = np.array([0.5, 1.0])
        runs = [
            impact("CalculiX", time, np.full((2, 3), 1 + e), [e, 0, 2 - e], spin=e, area=4 + e)
            for e in (0.3, 0.1)
        ]
        limit = peer_impact.extrapolated(*runs, 3.0, "limit")
        np.testing.assert_allclose(limit.area, 4, rtol=1e-12)
        np.testing.assert_allclose(limit.force, 1, rtol=1e-12)
        np.testing.assert_allclose(limit.velocity, [0, 0, 2], atol=1e-12)
        self.assertAlmostEqual(limit.spin[1], 0, 12)

    def test_only_runs_that_no_other_beats_count(self):
        rows = [
            {"code": "Ricochet", "own": {"largest": error}, "cpu_seconds": seconds}
            for error, seconds in ((0.1, 1), (0.1, 2), (0.02, 5), (0.05, 7))
        ]
        self.assertEqual(peer_report.front(rows, "Ricochet", "own"), [(0.1, 1), (0.02, 5)])

    def test_times_at_equal_accuracy(self):
        points = [(0.1, 1.0), (0.025, 4.0)]
        seconds, mark = peer_report.time_within(points, 0.05)
        self.assertAlmostEqual(seconds, 2, 12)
        self.assertEqual(mark, "")
        self.assertEqual(peer_report.time_within(points, 0.2), (1.0, "≤ "))
        self.assertEqual(peer_report.time_within(points, 0.01), (None, ""))


if __name__ == "__main__":
    unittest.main()
