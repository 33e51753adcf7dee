# SPDX-License-Identifier: BSD-2-Clause
"""The kernel of a body does not depend on the number of ranks that compute it."""

import unittest

import h5py
import numpy as np

from programs import ProgramTest, displacement_kernel, kernel, static_responses

GEO = """
SetFactory("Built-in");
Point(1) = {0, 0, 0, 0.7}; Point(2) = {1.1, 0, 0, 0.7}; Point(3) = {1.0, 1.3, 0, 0.7}; Point(4) = {0, 1, 0, 0.7};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
block[] = Extrude {0, 0, 0.7} { Surface{1}; };
Physical Volume("block") = {block[1]};
Physical Surface("foot") = {1};
Physical Surface("top") = {block[0]};
Physical Surface("side") = {block[2]};
"""

SCENE = """
title = "Ranks"
[bodies.free]
mesh = "block.geo"
order = 2
material = { density = 2.0, young = 3.0, poisson = 0.3 }
contact = "foot"
translate = [0, 0, 1]
[bodies.clamped]
mesh = "block.geo"
order = 2
material = { density = 2.0, young = 3.0, poisson = 0.3 }
contact = "top"
support = { foot = "xyz", side = "y" }
[modes]
count = 40
[contact]
between = ["free", "clamped"]
direction = [0, 0, -1]
[time]
duration = 1.0
[[loads.traction]]
body = "clamped"
group = "top"
vector = [0, 0, 1]
[[loads.point]]
body = "clamped"
at = [0.7, 0.8, 0.35]
vector = [1, 0, 0]
[[loads.motion]]
body = "clamped"
group = "foot"
vector = [1, 1, 1]
[[loads.motion]]
body = "clamped"
group = "side"
vector = [0, 1, 0]
[[output.receiver]]
name = "mic"
body = "clamped"
at = [0.2, 0.9, 0.4]
[[output.gauge]]
name = "foil"
body = "clamped"
at = [0.3, 0.6, 0.7]
direction = [1, 0, 0]
length = 0.2
"""


class Ranks(ProgramTest):
    def test_one_two_and_three_give_the_same_kernel_functions_of_modes(self):
        self.compare("{ count = 40 }")

    def test_one_two_and_three_give_the_same_kernel_functions_of_modes_that_contact_needs(self):
        self.compare("{ up_to_hz = 1.0, flexibility_error = 1e-2 }")

    def test_one_two_and_three_give_the_same_kernel_functions_of_vectors_fitted_to_contact(self):
        self.compare('{ up_to_hz = 1.0, basis = "contact" }')

    def sag(self, file):
        """Largest static displacement of the elastic modes at the candidates under unit accelerations [s²]."""
        omega = file["modes/angular_frequency"][:]
        elastic = omega > 0
        shape = file["surface/shape"][:].reshape(-1, omega.size)[:, elastic] / omega[elastic] ** 2
        return np.abs(shape @ file["loads/body_force"][:][:, elastic].T).max()

    def compare(self, modes):
        self.write("block.geo", GEO)
        scene = self.write("ranks.toml", SCENE)
        for ranks in (1, 2, 3):
            self.succeed(kernel(scene, self.folder / str(ranks), f"modes={modes}", ranks=ranks))
        # A few periods of the lowest mode and of the highest mode.
        times = np.concatenate([np.linspace(0, 30, 50), np.linspace(0, 1, 50)])
        for body in ("free", "clamped"):
            paths = [next((self.folder / str(ranks)).glob(f"{body}-*.kernel.h5")) for ranks in (1, 2, 3)]
            self.assertEqual(len({path.name for path in paths}), 1)
            one = displacement_kernel(paths[0], times)
            self.assertGreater(np.abs(one).max(), 1e-3)
            for path in paths[1:]:
                other = displacement_kernel(path, times)
                self.assertLess(np.abs(other - one).max(), 1e-8 * np.abs(one).max())
                with h5py.File(paths[0]) as a, h5py.File(path) as b:
                    np.testing.assert_array_equal(a["surface/node"][:], b["surface/node"][:])
                    for name in ("surface/residual_flexibility", "loads/body_force_residual"):
                        # Both are what modes leave of a static displacement. A uniform acceleration does not
                        # deform a free body, whose second dataset is round-off of 1 s².
                        scale = max(np.abs(a[name][:]).max(), 1e-6)
                        if name == "loads/body_force_residual":
                            scale = max(scale, self.sag(a))
                        self.assertLess(np.abs(a[name][:] - b[name][:]).max(), 1e-8 * scale)
        paths = [next((self.folder / str(ranks)).glob("clamped-*.kernel.h5")) for ranks in (1, 2, 3)]
        one, *others = (static_responses(path) for path in paths)
        self.assertEqual(len(one), 21)
        for other in others:
            for key, value in one.items():
                self.assertLess(np.abs(other[key] - value).max(), 1e-8 * max(np.abs(value).max(), 1e-3), key)


if __name__ == "__main__":
    unittest.main()
