# SPDX-License-Identifier: BSD-2-Clause
"""The folders from which mutants are drawn, and the tests that reach them, the fastest first.

A test is a program of serial tests (`test_…`), which runs without ctest, or has its name in ctest."""
import dataclasses
import itertools

import cpp_sites
import python_sites

PROGRAMS = ["ricochet-contact", "ricochet-kernel", "ricochet-recast", "ricochet_python", "ricochet_lv2"]
PROGRAMS += ["ricochet_web", "test_small_memory", "test_fork_server", "test_fork_client"]


@dataclasses.dataclass(frozen=True)
class Folder:
    """Sources by their pattern, and tests by their names. Those that know most of a part of the sources are in
    `first`, by the start of a path."""

    pattern: str
    tests: tuple
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


def _programs(*names):
    return tuple(f"programs/{name}" for name in names)


FOLDERS = {
    "contact": Folder(
        "contact/**/*.cpp",
        ("test_contact", "test_contact_core", "test_contact_realtime", "test_impact", "fuzz/table")
        + ("verification/manual.rods", "verification/manual.belt")
        + _programs("spin", "table", "driven", "motion", "skins", "friction")
        + ("python/friction", "python/api", *_programs("exports", "report", "robust")),
    ),
    "player": Folder("player/*.cpp", ("test_player",)),
    "kernels": Folder(
        "kernels/*.cpp",
        ("test_kernels", "test_scene", "test_contact", "fuzz/kernel")
        + _programs("table", "spin", "exports", "algebra")
        + ("python/api",),
    ),
    "scene": Folder(
        "src/scene/*.cpp",
        ("test_scene", "test_impact", "fuzz/scene")
        + _programs("mistakes", "table", "driven", "errors", "parts", "imports", "algebra", "sweep")
        + ("python/api",),
    ),
    "store": Folder("src/store/*.cpp", ("test_store", *_programs("reach", "errors", "algebra"))),
    "accuracy": Folder("src/accuracy/*.cpp", ("test_accuracy", *_programs("accuracy"))),
    "kernel": Folder(
        "src/kernel/*.cpp",
        _programs("imports", "parts", "reach", "errors", "restart", "ranks", "accuracy"),
    ),
    "impact": Folder(
        "src/impact/*.cpp",
        ("test_impact", *_programs("table", "motion", "driven", "strikes", "friction", "sweep", "exports")),
    ),
    "elasticity": Folder(
        "src/elasticity/*.cpp",
        (
            "elasticity.np1",
            "elasticity.np2",
            "surface.np2",
            *_programs("imports", "parts", "errors"),
            "modes.np2",
        ),
    ),
    "surface": Folder(
        "src/surface/*.cpp",
        (
            "surface.np1",
            "surface.np2",
            *_programs("driven", "parts", "motion", "imports", "errors"),
            "modes.np2",
        ),
    ),
    "modes": Folder(
        "src/modes/*.cpp",
        (
            "modes.np2",
            "reduction.np2",
            "surface.np2",
            *_programs("imports", "restart", "errors", "ranks", "accuracy"),
        ),
    ),
    "reduction": Folder(
        "src/reduction/*.cpp",
        ("reduction.np2", "surface.np2", *_programs("driven", "imports", "errors", "accuracy")),
    ),
    "python": Folder(
        "python/ricochet/**/*.py",
        ("python/commands", "python/geometry", "python/histories", "python/api", "python/friction")
        + _programs(
            "command", "sweep", "sweep_faults", "import_command", "imports", "table", "exports", "report"
        )
        + _programs("files", "motion", "friction", "robust", "batch", "restart", "tradeoff", "mistakes")
        + ("python/interpreters",),
        {
            "python/ricochet/instruments": ("programs/lv2", "web/instrument"),
            "python/ricochet/interchange/": (
                *_programs("import_command", "exports", "imports", "lv2"),
                "web/instrument",
            ),
            "python/ricochet/pages/": (
                "python/histories",
                "python/geometry",
                *_programs("skins", "report", "page_view"),
                "web/instrument",
            ),
            "python/ricochet/pictures/": (
                "python/histories",
                "python/geometry",
                "python/friction",
                *_programs("skins", "command", "report", "page_view"),
            ),
            "python/ricochet/studies/": _programs("sweep", "sweep_faults", "sweep_histories", "batch"),
            "python/ricochet/tradeoffs/": ("python/commands", *_programs("tradeoff")),
            "python/ricochet/cli/": (
                "python/commands",
                *_programs("mistakes", "command", "sweep", "import_command", "tradeoff"),
            ),
        },
    ),
}
