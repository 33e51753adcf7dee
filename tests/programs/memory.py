# SPDX-License-Identifier: BSD-2-Clause
"""The memory that the programs state before they allocate it is the memory that they reach."""

import os
import re
import unittest

from boxes import Box
from programs import ProgramTest, contact, kernel

os.environ.pop("RICOCHET_FORK_SERVER", None)  # a fork of it shares memory with it
SCENE = """
title = "Plate"
[bodies.box]
mesh = "box.msh"
material = { density = 2.0, young = 3e6, poisson = 0.3 }
contact = "foot"
velocity = [0, 0, -1]
[obstacles.floor]
normal = [0, 0, 1]
[modes]
count = 20
[contact]
between = ["box", "floor"]
gap = 1e-4
[time]
rate_hz = 1e5
duration = 4e-3
"""
# Of the memory reached: what users add to be safe, and what they pay for nothing.
LEAST, MOST = 0.95, 1.3


class Memory(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("box.msh", Box(size=(1.0, 0.7, 0.1), cells=(23, 23, 2)).gmsh())
        self.scene = self.write("plate.toml", SCENE)
        self.out = self.folder / "out"

    def compare(self, done):
        """Compares the largest figure that a program states with the last peak that it reports [MiB]."""
        self.succeed(done)
        stated = max(float(found) for found in re.findall(r"(\d+) MiB needed of \d+", done.err))
        reached = float(re.search(r"total .* (\d+) MiB", done.err)[1])
        self.assertGreater(stated / reached, LEAST, done.err)
        self.assertLess(stated / reached, MOST, done.err)
        return reached

    def test_of_steps_is_stated_with_the_points(self):
        """576 points: a matrix of their rows has 2.5 MiB."""
        self.compare(kernel(self.scene, self.out, quiet=False))
        self.assertGreater(self.compare(contact(self.scene, self.out, quiet=False)), 60)

    def test_of_steps_with_friction_is_stated_with_their_rows(self):
        """324 points with three rows each: a matrix has 7.2 MiB."""
        self.write("box.msh", Box(size=(1.0, 0.7, 0.1), cells=(17, 17, 2)).gmsh())
        sets = ["contact.friction=0.3", "contact.gap=2e-5", "time.duration=1e-4"]
        self.compare(kernel(self.scene, self.out, *sets, quiet=False))
        self.assertGreater(self.compare(contact(self.scene, self.out, *sets, quiet=False)), 200)

    def test_of_a_contact_adapted_basis_is_stated_with_its_loads(self):
        """576 loads along the normals on 5184 rows: a block has 23 MiB."""
        basis = 'modes={ basis = "contact", up_to_hz = 500, count = 100 }'
        done = kernel(self.scene, self.out, basis, quiet=False)
        self.assertGreater(self.compare(done), 200)


if __name__ == "__main__":
    unittest.main()
