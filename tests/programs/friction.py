# SPDX-License-Identifier: BSD-2-Clause
"""A box that slides on a floor with friction, from mesh to result: its deceleration, its distance, the belt that carries it
along, which kernels are computed, and what is refused."""

import unittest

import h5py
import numpy as np

from boxes import Box
from programs import BIN, ProgramTest, Run, contact, kernel, settings

GRAVITY, FRICTION, SPEED = 9.81, 0.3, 1.0
STOP = SPEED / (FRICTION * GRAVITY)
# The box is stiff enough to sag by 2e-4 m only. Strong damping brings it to rest on its foot within a few ms.
SCENE = """
title = "Slide"
[bodies.box]
mesh = "box.msh"
material = { density = 2.0, young = 3e4, poisson = 0.3 }
damping = { ratio = 0.3 }
contact = "foot"
velocity = [1, 0, 0]
[obstacles.floor]
normal = [0, 0, 1]
[modes]
count = 30
[contact]
between = ["box", "floor"]
gap = 1e-6
friction = 0.3
[time]
rate_hz = 8000
duration = 0.5
[loads]
gravity = [0, 0, -9.81]
"""


class Friction(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("box.msh", Box().gmsh())
        self.scene = self.write("slide.toml", SCENE)
        self.out = self.folder / "out"

    def kernels(self):
        return sorted(path.name for path in self.out.glob("*.kernel.h5"))

    def run_scene(self, *sets):
        """The summary, the times and the velocities of the box."""
        self.succeed(kernel(self.scene, self.out, *sets))
        self.succeed(contact(self.scene, self.out, *sets))
        (path,) = self.out.glob("*.result.h5")
        with h5py.File(path) as file:
            return self.summary(self.out), file["time"][:], file["bodies/box/velocity"][:]

    def refused(self, program, *sets):
        run = program(self.scene, self.out, *sets)
        self.assertEqual(run.status, 2, run.err)
        self.assertEqual(len(run.err.splitlines()), 1, run.err)
        self.assertEqual(list(self.out.glob("*.h5")), [])
        return run.err

    def test_stops_the_box_after_the_distance_of_coulomb(self):
        figures, time, velocity = self.run_scene()
        # While the box is laid on its foot and its foot bends, the force differs from the weight, but its mean does not.
        # 0.5 %: the static deflection of 2e-4 m and the shear of the box, both far below the distance.
        for share in (0.25, 0.5, 0.75):
            self.assertAlmostEqual(
                np.interp(share * STOP, time, velocity[:, 0]), (1 - share) * SPEED, delta=0.005
            )
        distance = np.trapz(velocity[:, 0], time)
        self.assertAlmostEqual(distance, SPEED**2 / (2 * FRICTION * GRAVITY), delta=0.005 * distance)
        np.testing.assert_allclose(velocity[time > 1.2 * STOP], 0, atol=0.005)
        # The heat is the kinetic energy, relative to which it is given.
        self.assertAlmostEqual(figures["energy_lost_friction"], 1, delta=0.01)
        mass = 2.0 * 0.35
        self.assertAlmostEqual(figures["friction_impulse_ns"], mass * SPEED, delta=0.01 * mass)
        self.assertAlmostEqual(figures["max_slip_m"], distance, delta=0.01 * distance)
        self.assertLess(figures["energy_drift"], 1e-9)
        self.assertEqual(figures["ambiguous_steps"], 0)

    def test_holds_the_box_at_rest_up_to_its_limit(self):
        """Weight first, then a push at the foot that grows with its history."""
        weight = 2.0 * 0.35 * GRAVITY
        self.write("push.csv", "t, factor\n0, 0\n1, 1\n")
        for share in (0.9, 1.1):
            push = share * FRICTION * weight
            self.scene = self.write(
                "push.toml",
                SCENE.replace("gap = 1e-6", 'scheme = "static"\ngap = 1e-6').replace(
                    "velocity = [1, 0, 0]\n", ""
                )
                + f'[[loads.point]]\nbody = "box"\nat = [0.5, 0.35, 0]\nvector = [{push}, 0, 0]\nhistory = "push.csv"\n',
            )
            self.succeed(kernel(self.scene, self.out))
            if share > 1:
                run = contact(self.scene, self.out)
                self.assertEqual(run.status, 2, run.err)
                self.assertIn("raise contact.friction", run.err)
                continue
            self.succeed(contact(self.scene, self.out))
            (pair,) = self.summary(self.out)["pairs"]
            # 1e-4: the displaced nodes of the box change its volume.
            self.assertAlmostEqual(pair["force_n"], weight, delta=1e-4 * weight)
            self.assertAlmostEqual(pair["friction_n"], push, delta=1e-6 * weight)
            self.assertEqual(pair["sticking_points"] + pair["slipping_points"], pair["contact_points"])
            result = next(self.out.glob("*.result.h5"))
            with h5py.File(result) as file:
                np.testing.assert_array_equal(file["time"][:], [0, 1])
                pushed = file["contact/tangential_force"][:, :, 0].sum(axis=1)
            np.testing.assert_allclose(np.abs(pushed), [0, push], atol=1e-6 * weight)
            problems = self.summary(self.out)["iterations"]
            self.succeed(contact(self.scene, self.out, "contact.increments=2"))
            self.assertLess(self.summary(self.out)["iterations"], problems / 4)  # 2 parts of 20

    def test_prints_its_figures(self):
        self.succeed(kernel(self.scene, self.out))
        text = self.succeed(contact(self.scene, self.out, quiet=False)).out
        for line in ("energy to friction", "friction impulse", "longest slip"):
            self.assertIn(line, text)
        smooth = self.succeed(contact(self.scene, self.out, "contact.friction=0", quiet=False)).out
        self.assertNotIn("friction", smooth)

    def test_of_a_belt_carries_the_box_along(self):
        rest = "bodies.box.velocity=[0,0,0]"
        _, time, velocity = self.run_scene(rest, "obstacles.floor.velocity=[0,0.6,0]")
        self.assertAlmostEqual(np.interp(0.1, time, velocity[:, 1]), FRICTION * GRAVITY * 0.1, delta=0.005)
        np.testing.assert_allclose(velocity[-1], [0, 0.6, 0], atol=0.005)
        # The same motion, as a history.
        self.write("belt.csv", "0, 0\n10, 6\n")
        motion = 'loads.motion=[{obstacle="floor",vector=[0,1,0],history="belt.csv"}]'
        np.testing.assert_allclose(self.run_scene(rest, motion)[2], velocity, atol=1e-9)
        # Without friction, nothing moves, and this is said.
        smooth = contact(self.scene, self.out, rest, motion, "contact.friction=0")
        self.succeed(smooth)
        warnings = self.summary(self.out)["warnings"]
        self.assertTrue(any("has no effect without friction" in warning for warning in warnings), warnings)

    def test_needs_kernels_that_serve_all_other_coefficients(self):
        direction = "contact.direction=[0,0,-1]"
        self.succeed(kernel(self.scene, self.out))
        (rough,) = self.kernels()
        with h5py.File(self.out / rough) as file:
            self.assertEqual(file["surface/shape"].shape[1], 3)
            rows = file["surface/residual_flexibility"].shape[0]
            self.assertEqual(rows, 3 * len(file["surface/area"]))
        for same in (
            ["contact.friction=0.7"],
            ["contact.friction=0"],
            [direction],
            ["contact.friction={static=0.4,dynamic=0.2,stribeck_velocity=0.1}"],
        ):
            self.succeed(contact(self.scene, self.out, "time.duration=0.01", *same))
            self.succeed(kernel(self.scene, self.out, *same))
            self.assertEqual(self.kernels(), [rough], same)
        # Without friction, one direction is enough, and it is derived from the kernel of all.
        run = self.succeed(kernel(self.scene, self.out, direction, "contact.friction=0", quiet=False))
        self.assertEqual(len(self.kernels()), 2)
        self.assertIn(rough, run.out + run.err)

    def test_does_not_take_kernels_of_normals_alone(self):
        self.succeed(kernel(self.scene, self.out, "contact.friction=0"))
        (smooth,) = self.kernels()
        run = contact(self.scene, self.out)
        self.assertEqual(run.status, 2)
        self.assertIn("no kernel for body", run.err)
        self.succeed(kernel(self.scene, self.out))
        self.assertEqual(len(self.kernels()), 2)
        self.assertIn(smooth, self.kernels())

    def test_is_refused_where_it_has_no_meaning(self):
        for sets, words in (
            (["contact.scheme=impulse"], 'is not possible with scheme = "impulse"'),
            (["contact.kernel=table"], 'is not possible with kernel = "table"'),
            (["contact.friction=-0.1"], "contact.friction = -0.1: must be from 0 to 10"),
            (["contact.friction=nan"], "contact.friction = nan: must be finite"),
            (["contact.friction={statik=0.3}"], 'Did you mean "static"?'),
            (["obstacles.floor.velocity=[0,0,1]"], "has the component 1 m/s along the normal"),
        ):
            for program in (kernel, contact):
                self.assertIn(words, self.refused(program, *sets))

    def test_is_refused_where_its_matrices_exceed_the_memory(self):
        """361 points close together: 34 matrices of 1083 rows are 319 MB; without friction, 26 of 361 rows are 27 MB."""
        self.write("box.msh", Box(cells=(18, 18, 1)).gmsh())
        self.scene.write_text(SCENE.replace("count = 30", "count = 6\nresidual_flexibility = false"))
        self.succeed(kernel(self.scene, self.out))
        for limit_mb, sets, fits in ((380, [], False), (600, [], True), (380, ["contact.friction=0"], True)):
            words = [BIN / "ricochet-contact", self.scene, "--out", self.out, "--quiet"]
            run = Run(["prlimit", f"--as={limit_mb}000000", *words, *settings([*sets, "time.duration=4e-4"])])
            self.assertEqual(run.status, 0 if fits else 2, run.err)
            if not fits:
                need = r"361 contact points with friction need 0\.3\d+ GB of memory, and there are 0\.3\d+\. Set fewer"
                self.assertRegex(
                    run.err, rf"^ricochet-contact: \S+slide\.toml: {need} candidates: contact\.spacing.*\n$"
                )

    def test_is_refused_on_rods(self):
        rod = """
Point(1) = {0, 0, 0, 1};
Point(2) = {10, 0, 0, 1};
Line(1) = {1, 2};
Physical Line("rod") = {1};
Physical Point("left") = {1};
"""
        self.write("rod.geo", rod)
        text = SCENE.replace("box.msh", "rod.geo").replace('"foot"', '"left"')
        text = text.replace("poisson = 0.3 }", "area = 1.0 }\norder = 1").replace("count = 30", "count = 8")
        text = text.replace("normal = [0, 0, 1]", "normal = [1, 0, 0]").replace("velocity = [1, 0, 0]", "")
        self.scene = self.write("rod.toml", text.replace("[0, 0, -9.81]", "[-9.81, 0, 0]"))
        self.assertIn("bodies.box is a rod", self.refused(kernel))
        # Impacts with a kernel of the scene without friction are refused as well.
        self.succeed(kernel(self.scene, self.out, "contact.friction=0"))
        run = contact(self.scene, self.out)
        self.assertEqual(run.status, 2)
        self.assertEqual(len(run.err.splitlines()), 1, run.err)
        self.assertRegex(run.err, "bodies.box is a rod|no kernel for body")


if __name__ == "__main__":
    unittest.main()
