# SPDX-License-Identifier: BSD-2-Clause
"""Uzawa's iteration for the pressures of a ball at rest, compared with the exact solver of the same complementarity problem."""

import unittest

import h5py
import numpy as np

from programs import MESHES, ProgramTest, contact, kernel

SCENE = MESHES / "hertz" / "resting-ball.toml"
MESH = "bodies.ball.geometry={size=1e-4}"


class Uzawa(ProgramTest):
    def rest(self, *sets):
        self.succeed(contact(SCENE, self.folder, MESH, *sets))
        with h5py.File(self.folder / "resting-ball.result.h5") as file:
            return file["contact/force"][0], self.summary(self.folder)

    def test_agrees_with_the_exact_solver(self):
        self.succeed(kernel(SCENE, self.folder, MESH))
        exact, _ = self.rest()
        slow, summary = self.rest("contact.solver=uzawa")
        self.assertGreater(summary["iterations"], 100)
        # The iteration stops at 1e-9 of the closed gap. The condition number of the flexibility,
        # some hundreds, amplifies this error.
        self.assertLess(np.abs(slow - exact).max(), 1e-5 * exact.max())


if __name__ == "__main__":
    unittest.main()
