# SPDX-License-Identifier: BSD-2-Clause
"""Spinning cubes, from mesh to result: the momenta of rigid bodies at the start, and their balance in an impact."""

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


if __name__ == "__main__":
    unittest.main()
