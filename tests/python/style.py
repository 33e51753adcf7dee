# SPDX-License-Identifier: BSD-2-Clause
"""All Python is formatted by Debian's black and passes flake8; the package passes mypy (strict). Each tool runs on
its own."""

import shutil
import subprocess
import unittest

from programs import BIN, SOURCE

PYTHON = SOURCE / "python"
OTHERS = [SOURCE / name for name in ("benchmarks", "tests", "scripts/coverage", "scripts/fuzz")]


class Style(unittest.TestCase):
    def check(self, *command):
        if not shutil.which(command[0]):
            self.skipTest(f"{command[0]} is not installed: scripts/setup --tests")
        done = subprocess.run([*map(str, command)], cwd=PYTHON, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_black_leaves_all_files_as_they_are(self):
        self.check("black", "--check", "--quiet", "--config", "pyproject.toml", "ricochet", *OTHERS)

    def test_flake8_has_no_complaint(self):
        self.check("flake8", "--config", ".flake8", "ricochet", *OTHERS)

    def test_types_agree(self):
        self.check("mypy", "--cache-dir", BIN.parent / "mypy", "ricochet")


if __name__ == "__main__":
    unittest.main()
