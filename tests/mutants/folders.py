# SPDX-License-Identifier: BSD-2-Clause
"""The folders of folders.toml, from which mutants are drawn, and the tests that reach them, the fastest first.

A test is a program of serial tests (`test_…`), which runs without ctest, or has its name in ctest."""
import dataclasses
import itertools
import tomllib
from pathlib import Path

import cpp_sites
import python_sites

PROGRAMS = ["ricochet-contact", "ricochet-kernel", "ricochet-recast", "ricochet_python", "ricochet_lv2"]
PROGRAMS += ["ricochet_web", "test_fork_server", "test_fork_client"]


@dataclasses.dataclass(frozen=True)
class Folder:
    """Sources by their pattern, and tests by their names. Those that know most of a part of the sources are in
    `first`, by the start of a path."""

    pattern: str
    tests: list
    first: dict = dataclasses.field(default_factory=dict)

    @property
    def find(self):
        """The function that finds the sites in a file of this folder."""
        return python_sites.sites if self.pattern.endswith(".py") else cpp_sites.sites

    def order(self, file):
        """The tests in the order in which they run on a mutant of a file."""
        near = (names for start, names in self.first.items() if file.startswith(start))
        return list(dict.fromkeys([*itertools.chain.from_iterable(near), *self.tests]))

    def sources(self, root):
        return sorted(root.glob(self.pattern))


def targets(test):
    """What must be built to run a test."""
    if test.startswith("test_"):
        return [test]
    name, _, ranks = test.partition(".np")
    if ranks:
        return [f"test_{name}", "test_sleep_in_yield"]
    if test.startswith("fuzz/"):
        return [f"test_fuzz_{test[len('fuzz/'):]}"]
    return [*PROGRAMS, "test_sleep_in_yield"]


FOLDERS = {
    name: Folder(**entry)
    for name, entry in tomllib.loads(Path(__file__).with_suffix(".toml").read_text()).items()
}
