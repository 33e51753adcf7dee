# SPDX-License-Identifier: BSD-2-Clause
"""Table kernels as a user runs them: what the shipped example refuses, and kernels sampled from modes compared with modal stepping. The
manual compares the example with d'Alembert's waves."""

import unittest

import h5py
import numpy as np

from programs import MESHES, ProgramTest, Run, contact, impact, kernel

ANALYTIC = MESHES / "two-rods-analytic"
SCENE = ANALYTIC / "two-rods-analytic.toml"
IMPULSE = "contact.scheme=impulse"
MASS = 0.5
HALF = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 0.5, 1, 1};
Mesh.MeshSizeMin = 0.5; Mesh.MeshSizeMax = 0.5;
Physical Volume("half") = {1}; Physical Surface("plane") = {1}; Physical Surface("bottom") = {5};
"""
HALF_SCENE = """
title = "Half"
[bodies.half]
mesh = "half.geo"
order = 1
material = { density = 1, young = 1e3, poisson = 0.3 }
velocity = [0, 0.25, -1]
contact = "bottom"
support = { plane = "x" }
[obstacles.floor]
point = [0, 0, -0.02]
normal = [0, 0, 1]
[modes]
count = 8
[contact]
between = ["half", "floor"]
[time]
rate_hz = 2000
duration = 0.2
"""


class AnalyticRods(ProgramTest):
    def table(self, *arguments):
        path = self.folder / "rods.table.h5"
        self.succeed(Run(["/usr/bin/python3", ANALYTIC / "table.py", *arguments, path]))
        return path

    def test_needs_no_kernels(self):
        run = self.succeed(kernel(SCENE, self.folder / "kernels", quiet=False))
        self.assertIn("nothing to compute", run.out + run.err)
        self.assertEqual(list(self.folder.glob("kernels/*")), [])

    def test_refusals_are_one_line(self):
        table = self.table("--duration", "5")
        with h5py.File(table) as file:
            self.assertEqual(file["table/velocity"].shape, (501, 1, 1))
        cases = [
            ([], "has samples for 5.01 s"),
            (
                ["time.duration=1", "time.rate_hz=200"],
                "time.rate_hz = 200: the table has a step of 0.01 s. Set 100.",
            ),
        ]
        for sets, part in cases:
            with self.subTest(part=part):
                self.refused(contact(SCENE, self.folder / "refused", f'contact.table="{table}"', *sets), part)
                self.assertEqual(list(self.folder.glob("refused/*")), [])
        run = contact(SCENE, self.folder / "refused", 'contact.table="nowhere.h5"')
        self.refused(run, "nowhere.h5: there is no such file")


class ModalRods(ProgramTest):
    def test_sampled_modes_give_what_modes_give(self):
        scene = MESHES / "two-rods" / "two-rods.toml"
        for scheme in (["contact.scheme=compliant"], [IMPULSE], [IMPULSE, "contact.admittance=difference"]):
            with self.subTest(scheme=scheme):
                table, modes = (
                    impact(scene, self.folder, f"title={kind}", f"contact.kernel={kind}", *scheme)
                    for kind in ("table", "modes")
                )
                for name in ("contact_time", "force", "gap", "point_a"):
                    np.testing.assert_allclose(getattr(table, name), getattr(modes, name), rtol=0, atol=1e-9)
                for body, name in (("moving", "velocity"), ("resting", "momentum")):
                    values = [getattr(one.bodies[body], name) for one in (table, modes)]
                    np.testing.assert_allclose(*values, rtol=0, atol=1e-9)

    # Half of a block is held on its plane of symmetry and free along it. Responses are those of the modes within round-off, which
    # the stiff contact amplifies.
    def test_half_a_body_rebounds_as_by_modes(self):
        self.write("half.geo", HALF)
        scene = self.write("half.toml", HALF_SCENE)
        self.succeed(kernel(scene, self.folder / "out"))
        table, modes = (
            impact(scene, self.folder / "out", f"title={kind}", f"contact.kernel={kind}")
            for kind in ("table", "modes")
        )
        for result in (table, modes):
            (episode,) = result.summary["episodes"]
            self.assertAlmostEqual(episode["approach_m_per_s"], 1, delta=1e-9)
        restitution = [result.summary["restitution"] for result in (table, modes)]
        self.assertAlmostEqual(*restitution, delta=1e-7)
        self.assertAlmostEqual(
            restitution[0], modes.summary["impulse_ns"] / MASS - 1, delta=1e-7
        )  # J = m (1 + e) v
        velocity = table.bodies["half"].velocity
        self.assertEqual(np.abs(velocity[:, 0]).max(), 0)  # held
        self.assertAlmostEqual(velocity[0, 1], 0.25, delta=1e-9)  # free


if __name__ == "__main__":
    unittest.main()
