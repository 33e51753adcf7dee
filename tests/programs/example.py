# SPDX-License-Identifier: BSD-2-Clause
"""The examples of the package: their kernels belong to their scenes, and run without ricochet-kernel, as after pip install."""

import contextlib
import json
import os
import shutil
import unittest
from unittest import mock

import numpy as np

import ricochet
from programs import BIN, SOURCE, Command, ProgramTest
from ricochet import programs

EXAMPLES = SOURCE / "python/ricochet/examples"


class Example(ProgramTest):
    @contextlib.contextmanager
    def installed_by_pip(self):
        """The programs that a wheel has, in its folder, and no others."""
        bin = self.folder / "bin"
        bin.mkdir()
        for name in ("ricochet-contact", "ricochet-recast"):
            shutil.copy(BIN / name, bin)
        without = {name: value for name, value in os.environ.items() if name != "RICOCHET_BIN"}
        with (
            mock.patch.multiple(programs, BIN=bin, WHEEL=bin),
            mock.patch.dict(os.environ, without | {"PATH": "/usr/bin:/bin"}, clear=True),
        ):
            yield

    def bell(self):
        shutil.copytree(EXAMPLES / "bell", self.folder / "bell")
        return self.folder / "bell/bell.toml"

    def test_each_example_is_listed_and_copied_with_the_kernels_of_its_scene(self):
        names = sorted(path.name for path in EXAMPLES.iterdir())
        listed = self.succeed(Command("example")).out.splitlines()
        self.assertEqual([line.split()[0] for line in listed], names)
        for name in names:
            folder = self.folder / name
            copied = self.succeed(Command("example", name, "--out", folder))
            self.assertEqual(copied.out, f"{folder}/{name}.toml\n")
            scene = ricochet.Scene(folder / f"{name}.toml")
            there = {body: there for body, _, there in scene._core.kernel_files(scene.out)}
            advice = "run scripts/examples, and commit what it writes"
            self.assertEqual(there, dict.fromkeys(scene.bodies, True), advice)
            self.refused(Command("example", name, "--out", folder), f"{folder}: is there already")
        choice = ", ".join(names)
        self.refused(Command("example", "gong"), f"gong: no such example: choose from {choice}")

    def test_the_bell_takes_the_momentum_that_the_mallet_loses(self):
        scene = self.bell()
        short = ("--set", "time.duration=1e-3", "--set", "output.every=1")
        with self.installed_by_pip():
            done = self.succeed(Command("run", scene, *short))
        self.assertNotIn("warning", done.err)
        self.assertTrue((scene.parent / "out/hand-bell.report.html").is_file())
        # The sleeve lets the mallet move along its axis only. Facets of the coarse contact surface tilt the force against the axis
        # by up to 25 degrees, and 1 − cos 25° < 0.1.
        kernel = ricochet.Kernel(self.one(scene.parent / "out", "mallet-*.kernel.h5"))
        summary = json.loads((scene.parent / "out/hand-bell.summary.json").read_text())
        before, after = np.array([-0.963, 0, -0.271]), np.array(summary["exit_velocity"]["mallet"])
        lost = kernel.mass * np.linalg.norm(after - before)
        self.assertGreater(float(after @ before), -1)  # it leaves no faster than it came
        self.assertLess(float(after @ before), 0)
        self.assertLess(lost, summary["impulse_ns"])
        self.assertGreater(lost, 0.9 * summary["impulse_ns"])

    def test_what_needs_ricochet_kernel_says_what_to_install(self):
        scene = self.bell()
        with self.installed_by_pip():
            for words in (
                ("kernel", scene),
                ("run", scene, "--set", "modes.up_to_hz=5000"),
                ("modes", scene),
                ("tradeoff", scene),
            ):
                with self.subTest(verb=words[0]):
                    self.refused(Command(*words), "ricochet-kernel: no such program: pip does not install it")


if __name__ == "__main__":
    unittest.main()
