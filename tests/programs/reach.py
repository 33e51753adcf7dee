# SPDX-License-Identifier: BSD-2-Clause
"""Kernels without the candidates beyond reach give the results of complete ones. They are found, or computed if needed."""

import shutil
import unittest
import warnings

import h5py
import numpy as np

import ricochet
from parts import grid, msh
from programs import ProgramTest, contact, displacement_kernel, kernel, scene_of

GEO = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 0.7};
MeshSize{:} = 0.3;
Physical Volume("block") = {1};
Physical Surface("foot") = {5};
"""

# One edge of the upper block is 0.052 m farther from the lower block than the other edge.
SCENE = """
title = "Reach"
[bodies.upper]
mesh = "block.geo"
order = 2
material = { density = 2.0, young = 3.0, poisson = 0.3 }
rotate_deg = [0, 3, 0]
translate = [0, 0, 0.1]
velocity = [0, 0, -0.05]
contact = "foot"
[bodies.lower]
mesh = "block.geo"
order = 2
material = { density = 2.0, young = 3.0, poisson = 0.3 }
rotate_deg = [180, 0, 0]
translate = [0.05, 1.02, 0]
contact = "foot"
[modes]
count = 30
[contact]
between = ["upper", "lower"]
gap = 0.01
reach = 0.03
[time]
rate_hz = 200
duration = 1.5
"""

WALL = """
title = "Parts"
[bodies.NAME]
mesh = "NAME.msh"
material = { density = 2.0, young = 3.0, poisson = 0.3 }
contact = "top"
[obstacles.wall]
point = [0, 0, 1.5]
normal = [0.1, 0, -1]
[modes]
count = 30
[contact]
between = ["NAME", "wall"]
reach = 0.4
[time]
duration = 1.0
"""


def held(path):
    with h5py.File(path) as file:
        return file["surface/whole/held"][:] if "surface/whole" in file else None


class Reach(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        scenes = {"block.geo": GEO, "reach.toml": SCENE, "whole.toml": SCENE.replace("reach = 0.03", "")}
        for name, text in scenes.items():
            (cls.made / name).write_text(text)
        for name in ("reach", "whole"):
            run = kernel(cls.made / f"{name}.toml", cls.made / name)
            assert run.status == 0, run.err

    def setUp(self):
        super().setUp()
        shutil.copytree(self.made, self.folder, dirs_exist_ok=True)
        self.scene = self.folder / "reach.toml"
        self.out, self.fresh = self.folder / "out", self.folder / "fresh"

    def kernels(self, folder):
        return {path.name for path in folder.glob("*.kernel.h5")}

    def forces(self, folder, *sets):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = ricochet.impact(scene_of(self.scene, *sets), folder)
        return result.force, result.initial_gap, result.point_b

    def test_impacts_are_those_of_whole_kernels(self):
        shutil.copytree(self.made / "reach", self.out)
        shutil.copytree(self.made / "whole", self.fresh)
        for body in ("upper", "lower"):
            with h5py.File(self.one(self.out, f"{body}-*")) as some, h5py.File(
                self.one(self.fresh, f"{body}-*")
            ) as every:
                points = some["surface/whole/held"][:]
                self.assertNotIn("surface/whole", every)
                self.assertLess(2, len(points))
                self.assertLess(len(points), 0.7 * len(every["surface/area"]))
                np.testing.assert_array_equal(some["surface/whole/node"][:], every["surface/node"][:])
                np.testing.assert_array_equal(some["surface/area"][:], every["surface/area"][:][points])
                # Nothing is tilted here, so both hold R along the normals.
                expected = every["surface/residual_flexibility"][:][np.ix_(points, points)]
                found = some["surface/residual_flexibility"][:]
                self.assertLess(np.abs(found - expected).max(), 1e-9 * np.abs(expected).max())
        for found, expected in zip(self.forces(self.out), self.forces(self.fresh)):
            self.assertEqual(found.shape, expected.shape)
            self.assertGreater(np.abs(expected).max(), 0)
            # Flexibilities agree to 1e-9. Forces follow with the condition number, over 300 steps.
            self.assertLess(np.abs(found - expected).max(), 1e-6 * np.abs(expected).max())

    def test_a_mesh_in_parts_leaves_out_the_same_on_any_number_of_ranks(self):
        nodes, elements = grid()
        for part in range(3):
            chosen = [e for e in range(len(elements)) if e // 4 % 3 == part]
            self.write(f"split_{part + 1}.msh", msh(nodes, elements, chosen))
        scene = self.write("split.toml", WALL.replace("NAME", "split"))
        for ranks in (1, 2, 3):
            self.succeed(kernel(scene, self.folder / str(ranks), ranks=ranks))
        self.same_on_all_ranks("split")

    def same_on_all_ranks(self, *bodies):
        times = np.linspace(0, 20, 40)
        for body in bodies:
            one, *others = [self.one(self.folder / str(ranks), f"{body}-*") for ranks in (1, 2, 3)]
            self.assertIsNotNone(held(one))
            expected = displacement_kernel(one, times)
            for other in others:
                self.assertEqual(other.name, one.name)
                found = displacement_kernel(other, times)
                self.assertLess(np.abs(found - expected).max(), 1e-8 * np.abs(expected).max())

    def test_kernels_serve_what_needs_no_other_points_and_are_computed_anew_for_what_does(self):
        shutil.copytree(self.made / "reach", self.out)
        before = self.kernels(self.out)
        for sets in (
            ["contact.reach=0.02"],
            ["bodies.upper.velocity=[0,0,-1]"],
            ["bodies.upper.translate=[0,0,0.3]"],
        ):
            run = self.succeed(kernel(self.scene, self.out, *sets, quiet=False))
            self.assertEqual(run.out.count("already there"), 2, run.out)
            self.assertNotIn("surface", run.out)
            self.succeed(contact(self.scene, self.out, *sets))
        for sets in (["contact.reach=0.06"], ["bodies.upper.rotate_deg=[0,-3,0]"]):
            self.refused(
                contact(self.scene, self.out, *sets), "holds too few candidates", "Run ricochet-kernel"
            )
            self.assertEqual(self.kernels(self.out), before)
        run = self.succeed(kernel(self.scene, self.out, "contact.reach=0.06", quiet=False))
        self.assertIn("assembly", run.err)
        self.assertGreater(len(self.kernels(self.out)), len(before))
        # The folder now contains several kernels to choose from.
        for sets in ([], ["contact.reach=0.06"]):
            self.succeed(contact(self.scene, self.out, *sets))

    def test_a_whole_kernel_serves_every_reach(self):
        shutil.copytree(self.made / "whole", self.out)
        before = self.kernels(self.out)
        run = self.succeed(kernel(self.scene, self.out, quiet=False))
        self.assertEqual(run.out.count("already there"), 2, run.out)
        self.assertEqual(self.kernels(self.out), before)

    def test_equal_bodies_are_computed_once_for_the_points_of_both(self):
        run = self.succeed(kernel(self.scene, self.out, quiet=False))
        both, some = self.one(self.out, "lower-*"), self.one(self.out, "upper-*")
        self.assertIn(f"upper: derived from {both.name}", run.out)
        self.assertLess(set(held(some)), set(held(both)))
        # If the two bodies differ, each one is computed separately.
        other = "bodies.lower.material.poisson=0.29"
        run = self.succeed(kernel(self.scene, self.fresh, other, quiet=False))
        self.assertNotIn("derived", run.out)
        alone = self.one(self.fresh, "upper-*")
        self.assertEqual(alone.name, some.name)
        times = np.linspace(0, 20, 40)
        found, expected = displacement_kernel(some, times), displacement_kernel(alone, times)
        self.assertLess(np.abs(found - expected).max(), 1e-8 * np.abs(expected).max())

    def test_nothing_within_reach_is_refused_before_modes_are_computed(self):
        run = kernel(self.scene, self.out, "contact.reach=0.005")
        self.refused(run, "reach = 0.005 m", "0.01 m apart")
        self.assertEqual(self.kernels(self.out), set())


if __name__ == "__main__":
    unittest.main()
