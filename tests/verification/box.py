# SPDX-License-Identifier: BSD-2-Clause
"""A free cube and a clamped box on 1 to 3 ranks, compared with Rayleigh–Ritz solutions, which do not use finite elements."""

import unittest

import h5py
import numpy as np

import ritz
from block import GEO, SCENE
from programs import ProgramTest, kernel

DENSITY, YOUNG, POISSON = 2700.0, 70e9, 0.33


class Box(ProgramTest):
    def frequencies(self, sides, support, ranks):
        self.write("box.geo", GEO)
        scene = self.write("box.toml", SCENE.format(density=DENSITY, young=YOUNG, poisson=POISSON, count=40))
        a, b, c = sides
        out = self.folder / f"{ranks}"
        self.succeed(
            kernel(
                scene,
                out,
                f"bodies.box.geometry={{ a = {a}, b = {b}, c = {c}, n = 2 }}",
                f"bodies.box.support={support}",
                ranks=ranks,
            )
        )
        (path,) = out.glob("box-*.kernel.h5")
        with h5py.File(path) as file:
            return file["modes/angular_frequency"][:] / (2 * np.pi)

    def compare(self, sides, support, degree, rigid, bound, ranks):
        oracle = ritz.box(sides, degree, DENSITY, YOUNG, POISSON, held=rigid == 0)[rigid:60]
        coarser = ritz.box(sides, degree - 2, DENSITY, YOUNG, POISSON, held=rigid == 0)[rigid:60]
        found = [self.frequencies(sides, support, count) for count in ranks]
        for frequencies in found:
            self.assertEqual(np.count_nonzero(frequencies == 0), rigid)
            elastic = frequencies[rigid:]
            n = len(elastic)
            self.assertGreaterEqual(n, 40 - rigid)
            # The error of the oracle itself is well within the bound.
            self.assertLess(np.abs(coarser[:n] / oracle[:n] - 1).max(), bound / 2)
            error = np.abs(elastic / oracle[:n] - 1).max()
            print(f"box {sides}, support {support}: largest error of {n} elastic frequencies {error:.1e}")
            self.assertLess(error, bound)
            np.testing.assert_allclose(frequencies, found[0], rtol=1e-9)
        return found[0], oracle

    def test_free_cube_has_its_multiple_modes(self):
        found, oracle = self.compare((0.1, 0.1, 0.1), "{}", 10, 6, 1e-3, ranks=(1, 3))
        n = len(found) - 6
        groups = ritz.multiplicities(found[6:], 1e-6)
        self.assertEqual(groups, ritz.multiplicities(oracle[:n], 1e-6))
        self.assertEqual(max(groups), 3)

    def test_clamped(self):
        # Stresses are singular along the clamped edges, where both solutions converge slowly.
        self.compare((0.1, 0.13, 0.17), '{ foot = "xyz" }', 9, 0, 1e-2, ranks=(2,))


if __name__ == "__main__":
    unittest.main()
