# SPDX-License-Identifier: BSD-2-Clause
"""Another Python, first on PATH or used by mistake: the command finds its own, and the package complains in one line."""

import glob
import os
import pathlib
import sys
import unittest

from programs import BIN, SOURCE, ProgramTest, Run
from ricochet import interpreter

PACKAGE = f"{SOURCE}/python:{BIN.parent}/python"
OTHERS = glob.glob(os.path.expanduser("~/.pyenv/versions/*/bin/python3")) + glob.glob("/opt/*/bin/python3")


class Interpreters(ProgramTest):
    def call(self, *command, **variables):
        found = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        return Run(command, env=found | variables)

    def test_the_command_and_scripts_use_their_own_whatever_the_environment_names(self):
        broken = self.folder / "broken"
        broken.mkdir()
        for name in ("python", "python3", "python3.11"):
            (broken / name).write_text("#!/bin/sh\necho another Python >&2\nexit 99\n")
            (broken / name).chmod(0o755)
        for name in ("numpy", "h5py", "tomllib", "ricochet"):
            (broken / f"{name}.py").write_text("raise SystemExit('of another Python')\n")
        other = {
            "PATH": f"{broken}:/usr/bin:/bin",
            "PYTHONPATH": str(broken),
            "PYTHONHOME": str(broken),
            "VIRTUAL_ENV": str(broken),
            "CONDA_PREFIX": str(broken),
            "RICOCHET_BIN": str(BIN),
        }
        for command in (
            [BIN / "ricochet", "--version"],
            [BIN / "ricochet", "sweep", "--help"],  # imports numpy
            [SOURCE / "scripts/verify", "--help"],
            [SOURCE / "scripts/mutants", "--help"],
        ):
            done = self.call(*command, **other)
            self.assertEqual((done.status, done.err), (0, ""), command)
        done = self.call(SOURCE / "scripts/bench", "--help", **other)
        if (SOURCE / "build/python").is_dir():
            self.assertEqual((done.status, done.err), (0, ""))
        else:
            self.assertEqual((done.status, done.err.count("\n")), (2, 1), done.err)
            self.assertIn("run scripts/build first", done.err)

    def test_one_without_packages_is_refused_in_one_line(self):
        done = self.call("/usr/bin/python3", "-S", "-m", "ricochet", "--version", PYTHONPATH=PACKAGE)
        self.assertEqual((done.status, done.err.count("\n")), (2, 1), done.err)
        self.assertRegex(
            done.err,
            r"^ricochet: /usr/bin/python3 is Python 3\.\d+ without numpy, .*: use /usr/bin/python3",
        )
        done = self.call("/usr/bin/python3", "-S", "-c", "import ricochet", PYTHONPATH=PACKAGE)
        self.assertRegex(done.err.splitlines()[-1], "^ImportError: .* without numpy, h5py, matplotlib: use ")

    def test_a_module_of_another_version_is_named(self):
        (self.folder / "_core.cpython-399-x86_64-linux-gnu.so").write_text("")
        complaint = interpreter.complaint([str(self.folder)])
        self.assertIn(f"{sys.executable} is Python {sys.version_info[0]}.{sys.version_info[1]}", complaint)
        self.assertIn("for another one (_core.cpython-399-", complaint)
        (built,) = pathlib.Path(BIN.parent / "python/ricochet").glob("_core.*.so")
        self.assertEqual(interpreter.complaint([str(self.folder), str(built.parent)]), "")

    @unittest.skipUnless(OTHERS, "no other Python is installed")
    def test_real_ones_are_refused_in_one_line(self):
        for other in OTHERS:
            done = self.call(other, "-m", "ricochet", "--version", PYTHONPATH=PACKAGE)
            self.assertEqual((done.status, done.err.count("\n")), (2, 1), done.err)
            self.assertRegex(done.err, f"^ricochet: {other} is Python 3.*: use /usr/bin/python3")


if __name__ == "__main__":
    unittest.main()
