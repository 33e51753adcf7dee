# SPDX-License-Identifier: BSD-2-Clause
"""A free cube on 3 ranks and a clamped box on 2, compared with Rayleigh–Ritz solutions, which do not use finite elements."""

import unittest

import numpy as np

import ricochet
import ritz
from block import GEO, SCENE
from programs import ProgramTest, scene_of

DENSITY, YOUNG, POISSON = 2700.0, 70e9, 0.33


class Box(ProgramTest):
    def frequencies(self, sides, support, ranks):
        self.write("box.geo", GEO)
        scene = self.write("box.toml", SCENE.format(density=DENSITY, young=YOUNG, poisson=POISSON, count=26))
        a, b, c = sides
        geometry = f"bodies.box.geometry={{ a = {a}, b = {b}, c = {c}, n = 2 }}"
        scene = scene_of(scene, "bodies.box.order=4", geometry, f"bodies.box.support={support}")
        return ricochet.kernels(scene, ranks)["box"].frequency

    def compare(self, sides, support, degree, rigid, bound, ranks):
        law = ritz.isotropic(YOUNG, POISSON)
        oracle = ritz.box(sides, degree, DENSITY, law, clamped=rigid == 0)[rigid:60]
        coarser = ritz.box(sides, degree - 2, DENSITY, law, clamped=rigid == 0)[rigid:60]
        frequencies = self.frequencies(sides, support, ranks)
        self.assertEqual(np.count_nonzero(frequencies == 0), rigid)
        elastic = frequencies[rigid:]
        n = len(elastic)
        self.assertGreaterEqual(n, 26 - rigid)
        # The error of the oracle itself is well within the bound.
        self.assertLess(np.abs(coarser[:n] / oracle[:n] - 1).max(), bound / 2)
        error = np.abs(elastic / oracle[:n] - 1).max()
        print(f"box {sides}, support {support}: largest error of {n} elastic frequencies {error:.1e}")
        self.assertLess(error, bound)
        return elastic, oracle[:n]

    def test_free_cube_has_its_multiple_modes(self):
        found, oracle = self.compare((0.1, 0.1, 0.1), "{}", 9, 6, 1e-3, ranks=3)
        # Elements of order 4 split a pair from a third mode of the same frequency by 1e-5.
        groups = ritz.multiplicities(found, 1e-4)
        self.assertEqual(groups, ritz.multiplicities(oracle, 1e-4))
        self.assertEqual(max(groups), 3)

    def test_clamped(self):
        # Stresses are singular along the clamped edges, where both solutions converge slowly.
        self.compare((0.1, 0.13, 0.17), '{ foot = "xyz" }', 9, 0, 1e-2, ranks=2)


if __name__ == "__main__":
    unittest.main()
