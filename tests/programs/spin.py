# SPDX-License-Identifier: BSD-2-Clause
"""Spinning bodies, from mesh to result: the momenta of rigid cubes at the start, and their balance in an impact; the pattern of
a ring that is struck once."""

import unittest

import h5py
import numpy as np
import scenes

from programs import ProgramTest, impact

SIDE, DENSITY = 1.0, 2.0
MASS, INERTIA = DENSITY * SIDE**3, DENSITY * SIDE**5 / 6  # a cube, about any axis through its centre
CUBE = f"""
SetFactory("Built-in");
Point(1) = {{0, 0, 0, 0.5}}; Point(2) = {{{SIDE}, 0, 0, 0.5}};
Point(3) = {{{SIDE}, {SIDE}, 0, 0.5}}; Point(4) = {{0, {SIDE}, 0, 0.5}};
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 1}};
Curve Loop(1) = {{1:4}}; Plane Surface(1) = {{1}};
block[] = Extrude {{0, 0, {SIDE}}} {{ Surface{{1}}; }};
Physical Volume("block") = {{block[1]}}; Physical Surface("foot") = {{1}};
"""
BODY = f"""
mesh = "cube.geo"
order = 2
material = {{ density = {DENSITY}, young = 200.0, poisson = 0.3 }}
contact = "foot"
"""
TIME = "rate_hz = 4000.0\nduration = 0.3"


class Spin(ProgramTest):
    def run_scene(self, text):
        self.write("cube.geo", CUBE)
        out = self.folder / "out"
        result = impact(self.write("scene.toml", text), out)
        found = {"time": result.time, "contact/time": result.contact_time, "contact/force": result.force}
        found |= {"point_a": result.point_a, "normal": result.normal}
        for body, motion in result.bodies.items():
            with h5py.File(self.one(out, f"{body}-*.kernel.h5")) as of_body:
                found[body, "node"] = of_body["surface/node"][:]
                found[body, "centroid"] = of_body["surface/centroid"][:]
            found[body, "momentum"], found[body, "angular_momentum"] = (
                motion.momentum,
                motion.angular_momentum,
            )
        return found

    def at_start(self, found, body, centre, velocity, spin):
        """The first row has the momenta of a rigid cube, up to round-off of the mesh."""
        centre, velocity, spin = map(np.array, (centre, velocity, spin))
        np.testing.assert_allclose(found[body, "momentum"][0], MASS * velocity, atol=1e-10)
        expected = np.cross(centre, MASS * velocity) + INERTIA * spin
        np.testing.assert_allclose(found[body, "angular_momentum"][0], expected, atol=1e-10)

    def test_of_two_free_bodies_has_a_constant_sum_up_to_the_offsets_of_patches(self):
        bodies = {
            "upper": f"{BODY}translate = [0.2, 0.15, 0.01]\nvelocity = [0, 0, -0.5]\n"
            "angular_velocity = [0.1, -0.2, 0.3]\n",
            "lower": f"{BODY}rotate_deg = [180, 0, 0]\ntranslate = [0, 1, 0]\nvelocity = [0, 0.1, 0.2]\n"
            "angular_velocity = [-0.2, 0.1, 0]\n",
        }
        found = self.run_scene(scenes.scene(bodies, "count = 30", "", TIME, title="Two cubes"))
        self.at_start(found, "upper", (0.7, 0.65, 0.51), (0, 0, -0.5), (0.1, -0.2, 0.3))
        self.at_start(found, "lower", (0.5, 0.5, -0.5), (0, 0.1, 0.2), (-0.2, 0.1, 0))
        left = {of: found["upper", of] + found["lower", of] for of in ("momentum", "angular_momentum")}
        left = {of: np.linalg.norm(total - total[0], axis=1).max() for of, total in left.items()}
        self.assertLess(left["momentum"], 1e-12)
        # The point opposite a centroid is interpolated between nodes, but the forces of patches act at their
        # centroids. The two lines of action of a pair are at most this far apart.
        offset = sum(
            np.linalg.norm(found[body, "centroid"] - found[body, "node"], axis=1).max()
            for body in ("upper", "lower")
        )
        impulse = found["contact/force"].sum() / 4000
        self.assertGreater(impulse, 1)
        self.assertLess(left["angular_momentum"], offset * impulse)
        # The centres are 0.2 and 0.15 apart, so each cube gains spin, far more than is left over.
        exchanged = np.ptp(found["upper", "angular_momentum"], axis=0).max()
        self.assertGreater(exchanged, 10 * left["angular_momentum"])


RADIUS, THICKNESS, WIDTH = 0.05, 2e-3, 4e-3
SEGMENTS = 24  # a pattern with 2 or 3 waves has the same frequency wherever it is
RING = f"""
SetFactory("Built-in");
Point(1) = {{{RADIUS - THICKNESS / 2}, 0, {-WIDTH / 2}}}; Point(2) = {{{RADIUS + THICKNESS / 2}, 0, {-WIDTH / 2}}};
Point(3) = {{{RADIUS + THICKNESS / 2}, 0, {WIDTH / 2}}}; Point(4) = {{{RADIUS - THICKNESS / 2}, 0, {WIDTH / 2}}};
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 1}};
Curve Loop(1) = {{1:4}}; Plane Surface(1) = {{1}};
Transfinite Curve{{1:4}} = 2; Transfinite Surface{{1}}; Recombine Surface{{1}};
face = 1;
For i In {{1:4}}
  part[] = Extrude {{{{0, 0, 1}}, {{0, 0, 0}}, Pi/2}} {{ Surface{{face}}; Layers{{{SEGMENTS // 4}}}; Recombine; }};
  face = part[0]; volume[i - 1] = part[1];
EndFor
Physical Volume("ring") = {{volume[]}};
"""


class Precession(ProgramTest):
    """Bryan 1890: the pattern of a thin ring with n waves turns in the ring by 2/(n² + 1) of its spin, against it."""

    def pattern_rates(self, spin):
        """The rates at which patterns with 2 and 3 waves turn in the ring, by its spin after the impact, and the summary."""
        self.write("ring.geo", RING)
        body = f"""
mesh = "ring.geo"
order = 2
material = {{ density = 7800.0, young = 2e11, poisson = 0.3 }}
contact = "all"
translate = [{RADIUS + THICKNESS}, 0, 0]
velocity = [-0.5, 0, 0]
angular_velocity = [0, 0, {spin}]
"""
        more = '[motion]\nrotation = "finite"\n[output]\nsnapshot_every = 1'
        text = scenes.scene(
            {"ring": body},
            "count = 24\nresidual_flexibility = false",
            "",
            "rate_hz = 16000.0\nduration = 0.03",
            {"wall": "normal = [1, 0, 0]"},
            more=more,
        )
        out = self.folder / "out"
        result = impact(self.write("ring.toml", text), out)
        with h5py.File(self.one(out, "ring-*.kernel.h5")) as file:
            node, shape = file["surface/node"][:], file["surface/shape"][:]
        angle = np.arctan2(node[:, 1], node[:, 0])
        radial = np.einsum("m,mn->mn", np.cos(angle), shape[:, 0]) + np.einsum(
            "m,mn->mn", np.sin(angle), shape[:, 1]
        )
        time, q = result.snapshots["time"], result.snapshots["ring"]
        free = time > result.summary["contact_end_s"] + 1e-3
        rates = {}
        for waves in (2, 3):
            wave = (q[free] @ radial.T) @ np.exp(-1j * waves * angle)
            # The square of A cos ωt e^(−inψ), where ψ is the angle of the pattern, over some 2 ms
            square = np.convolve(wave**2, np.hanning(33), "valid")
            turned = -np.unwrap(np.angle(square)) / (2 * waves)
            rates[waves] = (
                np.polyfit(time[free][: len(turned)], turned, 1)[0] / result.bodies["ring"].spin[-1, 2]
            )
        return rates, result.summary

    def test_of_a_spinning_ring_is_that_of_bryan(self):
        for spin in (200.0, -200.0):
            rates, summary = self.pattern_rates(spin)
            for waves, rate in rates.items():
                # The ring is not quite thin: 0.04 of its radius, whose square counts.
                self.assertAlmostEqual(rate * (waves**2 + 1) / -2, 1, delta=0.01)
            self.assertLess(summary["neglected"]["ring"]["centrifugal_strain"], 1e-5)
            self.assertEqual([line for line in summary["warnings"] if "Coriolis" in line], [])


if __name__ == "__main__":
    unittest.main()
