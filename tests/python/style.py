# SPDX-License-Identifier: BSD-2-Clause
"""All Python is formatted by Debian's black and passes flake8; the package passes mypy (strict). Each tool runs on
its own.

    style.py          # what changed lately: black and flake8 take a minute for all files, and mypy half a minute
    style.py --all    # all files
"""

import functools
import shutil
import subprocess
import sys
import unittest

from programs import BIN, SOURCE

sys.path.append(str(SOURCE / "tests"))
from hygiene import changed_lately, listed, new  # noqa: E402

PYTHON = SOURCE / "python"
CHECKED = [
    "python/ricochet/*.py",
    "python/backend/*.py",
    "benchmarks/*.py",
    "tests/*.py",
    "scripts/coverage",
    "scripts/fuzz",
    "scripts/release",
]
SETTINGS = ["python/pyproject.toml", "python/.flake8"]
ALL = "--all" in sys.argv


@functools.cache
def files():
    """What black and flake8 see: the files that changed in the last commits or since, or all if the settings did."""
    changed = changed_lately(SOURCE)
    every = listed(SOURCE, "ls-files", "--", *CHECKED) | new(SOURCE, *CHECKED)
    chosen = every if ALL or changed.intersection(SETTINGS) else every & changed
    return sorted(path for name in chosen if (path := SOURCE / name).is_file())


class Style(unittest.TestCase):
    def check(self, *command):
        if not shutil.which(command[0]):
            self.skipTest(f"{command[0]} is not installed: scripts/setup --tests")
        done = subprocess.run([*map(str, command)], cwd=PYTHON, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def check_files(self, *command):
        if not (SOURCE / ".git").exists():
            self.skipTest("not a git checkout")
        if files():
            self.check(*command, *files())

    def test_black_leaves_files_as_they_are(self):
        self.check_files("black", "--check", "--quiet", "--config", "pyproject.toml")

    def test_flake8_has_no_complaint(self):
        self.check_files("flake8", "--config", ".flake8")

    def test_types_agree(self):
        if not (SOURCE / ".git").exists() or any(
            path.is_relative_to(PYTHON / "ricochet") for path in files()
        ):
            self.check("mypy", "--cache-dir", BIN.parent / "mypy", "ricochet")


if __name__ == "__main__":
    unittest.main(argv=[word for word in sys.argv if word != "--all"])
