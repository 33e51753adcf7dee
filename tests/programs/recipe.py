# SPDX-License-Identifier: BSD-2-Clause
"""Lints the conda recipe, which cannot be run here: fields that conda-forge requires, and agreement with CMake and pip."""

import re
import shlex
import sys
import tomllib
import unittest

import yaml

from programs import SOURCE, Command, ProgramTest
from ricochet.cli import VERBS

sys.path.append(str(SOURCE / "python/backend"))
import ricochet_backend  # noqa: E402

# In the order that conda-forge requires.
SECTIONS = [
    *("schema_version", "context", "package", "source", "build", "requirements", "tests", "about", "extra"),
]
FUNCTIONS = {"compiler", "stdlib"}  # of recipes, called with one string
# The packages of conda-forge that have what CMake looks for, and pkg-config modules by the names in CMakeLists.txt.
PROVIDED = {
    **{"Eigen3": "eigen", "fmt": "fmt", "tomlplusplus": "tomlplusplus", "nlohmann_json": "nlohmann_json"},
    **{"OpenSSL": "openssl", "CLI11": "cli11", "SNDFILE": "libsndfile", "SAMPLERATE": "libsamplerate"},
    **{"HDF5": "hdf5", "LV2": "lv2", "KISSFFT_INCLUDE_DIR": "kissfft", "pybind11": "pybind11"},
}
NOT_IN_WHEELS = {
    "MPI",
    "SLEPC",
    "METIS_LIBRARY",
    "GMSH_LIBRARY",
    "MUMPS_LIBRARY",
    "OPENBLAS_LIBRARY",
    "PkgConfig",
}


def rendered(value, context):
    """The value with its expressions ${{ … }} replaced. Raises KeyError for a name that is not defined."""
    if isinstance(value, dict):
        return {key: rendered(item, context) for key, item in value.items()}
    if isinstance(value, list):
        return [rendered(item, context) for item in value]
    if not isinstance(value, str):
        return value

    def replaced(found):
        call = re.fullmatch(r'(\w+)\("(\w+)"\)', found[1])
        if call and call[1] in FUNCTIONS:
            return f"{call[1]}-{call[2]}"
        return context[found[1]]

    text = re.sub(r"\$\{\{ *(.*?) *\}\}", replaced, value)
    assert "{{" not in text and "}}" not in text, text
    return text


class Recipe(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.raw = yaml.safe_load((SOURCE / "recipe/recipe.yaml").read_text())
        cls.recipe = rendered(cls.raw, cls.raw["context"] | {"PYTHON": "python"})

    def names(self, section):
        return [line.split()[0] for line in self.recipe["requirements"][section]]

    def test_it_has_the_sections_and_fields_that_conda_forge_requires(self):
        self.assertEqual(list(self.raw), SECTIONS)
        self.assertEqual(self.raw["schema_version"], 1)
        for field in ("summary", "license", "license_file"):
            self.assertTrue(self.recipe["about"][field].strip(), field)
        self.assertEqual(self.recipe["about"]["license"], "BSD-2-Clause")
        self.assertTrue((SOURCE / self.recipe["about"]["license_file"]).is_file())
        self.assertLessEqual(len(self.recipe["about"]["summary"]), 80)
        self.assertIsInstance(self.recipe["build"]["number"], int)
        self.assertTrue(self.recipe["extra"]["recipe-maintainers"])
        self.assertTrue(self.recipe["tests"])
        self.assertRegex(self.recipe["package"]["name"], r"^[a-z0-9-]+$")
        self.assertNotIn("noarch", self.recipe["build"])  # it compiles
        self.assertLessEqual({"compiler-c", "compiler-cxx", "stdlib-c"}, set(self.names("build")))
        for section in ("build", "host", "run"):
            for line in self.recipe["requirements"][section]:
                self.assertRegex(
                    line, r"^[a-z0-9_.-]+( [<>=!0-9.,*]+)?$"
                )  # one space between name and version
            self.assertEqual(len(set(self.names(section))), len(self.names(section)))

    def test_its_version_and_its_run_requirements_are_those_of_pip(self):
        self.assertEqual(self.recipe["package"]["version"], ricochet_backend.version())
        project = tomllib.loads((SOURCE / "python/pyproject.toml").read_text())["project"]
        by_pip = {re.sub("(?=[<>=])", " ", text, count=1) for text in project["dependencies"]}
        by_pip = {text.replace("matplotlib ", "matplotlib-base ") for text in by_pip}
        by_pip |= {f"python {project['requires-python']}", "util-linux"}  # setpriv
        self.assertEqual(set(self.recipe["requirements"]["run"]), by_pip)

    def test_its_host_has_what_cmake_looks_for(self):
        wanted = set()
        for path in ("CMakeLists.txt", "lv2/CMakeLists.txt", "python/CMakeLists.txt"):
            text = (SOURCE / path).read_text()
            wanted |= set(re.findall(r"^(?:find_package|find_path|pkg_\w+)\((\w+)", text, re.MULTILINE))
        self.assertEqual(
            {PROVIDED[name] for name in wanted - NOT_IN_WHEELS}, set(self.names("host")) - {"python", "pip"}
        )

    def test_its_tests_are_commands_that_ricochet_has(self):
        (script,) = (test["script"] for test in self.recipe["tests"] if "script" in test)
        for words in map(shlex.split, script):
            if words[0] == "ricochet" and not words[1].startswith("-"):
                self.assertIn(words[1], VERBS)
                options = {word for word in words[2:] if word.startswith("-")}
                described = Command(words[1], "--help").out
                self.assertEqual([option for option in options if option not in described], [])


if __name__ == "__main__":
    unittest.main()
