# SPDX-License-Identifier: BSD-2-Clause
"""Runs the commands and Python blocks of the documentation and checks its keys and links."""

import json
import os
import pathlib
import re
import shutil
import tempfile
import tomllib
import unittest
import unittest.mock

import h5py
import numpy as np

import pages
from programs import BIN, Command, Run, kernel_server

PAGES = sorted(
    path for glob in ("*.md", "docs/**/*.md", "benchmarks/*.md") for path in pages.SOURCE.glob(glob)
)


class Reader(unittest.TestCase):
    """The two rods have unit mass per length, wave speed 1 and length 10. Kernels are computed on one rank."""

    @classmethod
    def setUpClass(cls):
        launcher = " ".join(kernel_server()) or "env"
        cls.enterClassContext(unittest.mock.patch.dict(os.environ, {"RICOCHET_LAUNCHER": launcher}))

    def run_page(self, name):
        scope = tempfile.TemporaryDirectory(prefix="ricochet-page-")
        self.addCleanup(scope.cleanup)
        folder = pathlib.Path(scope.name)
        pages.make_folder(folder)
        return pages.Page(pages.SOURCE / name, folder, quick=True).run()

    def test_the_readme_runs(self):
        page = self.run_page("README.md")
        self.assertTrue((page.folder / "meshes/two-rods/out/slow.result.h5").is_file())
        self.assertTrue((page.folder / "meshes/two-rods/out/two-rods-contact.png").is_file())

    def test_the_kernel_s_has_frequencies_and_admittance_of_a_free_rod(self):
        names = self.run_page("docs/formats/kernel.md").names
        n = np.arange(10)
        # 100 linear elements have a relative error of (n pi / 100)^2 / 24.
        np.testing.assert_allclose(names["omega"], n * np.pi / 10, rtol=4e-3, atol=1e-12)
        # cos(n pi x / L) for the mass 10 gives 1/10 for the rigid mode and 2/10 for
        # each other mode, with a similar error.
        np.testing.assert_allclose(names["admittance"], [1.9], rtol=1e-2)

    def test_the_result_s_has_the_force_and_velocity_of_two_rods_that_meet(self):
        names = self.run_page("docs/formats/result.md").names
        # Waves of speed 1 return after 2 · 10. Until then the force is half the product of mass
        # per length, wave speed and velocity. 30 modes resolve the ends of contact to the
        # wavelength of the highest mode, 2 · 10 / 30.
        self.assertAlmostEqual(names["when"][-1], 20, delta=0.7)
        self.assertAlmostEqual(names["total"].sum() / 20, 10, delta=0.1)  # N s, the entire momentum
        self.assertAlmostEqual(np.median(names["total"]), 0.5, delta=0.02)
        np.testing.assert_allclose(names["pressure"][:, 0], names["total"])  # the area is 1
        np.testing.assert_allclose(names["v"][[0, -1], 0], [1, 0], atol=0.02)

    def test_results_are_read_as_shown(self):
        names = self.run_page("docs/results.md").names
        self.assertAlmostEqual(names["total"].sum() * names["step"], 10, delta=0.1)
        self.assertEqual(len(names["place"]), 101)
        self.assertGreater(names["together"].sum(), 100)
        relative = names["v_a"] - names["v_b"]
        self.assertLess(abs(relative[1:][names["together"]]).max(), 1e-10)  # round-off of u/Δ
        # The wave from the struck end passes the middle with half the impact speed; its
        # reflection restores the full speed.
        self.assertAlmostEqual(names["v"][np.searchsorted(names["t"], 10), 0], 0.5, delta=0.1)

    def test_python_runs_as_shown(self):
        names = self.run_page("docs/python.md").names
        self.assertEqual(names["kernel"].frequency.shape, (30,))
        self.assertAlmostEqual(names["result"].summary["impulse_ns"], 10, delta=0.1)
        self.assertAlmostEqual(names["block"].total_force.mean(), 0.5, delta=0.02)  # wave solution
        self.assertEqual(names["page"].name, "two-rods.report.html")

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed: scripts/setup --tests")
    def test_bodies_of_other_programs_are_imported_and_meet_as_shown(self):
        folder = self.run_page("docs/interchange.md").folder / "build/imported"
        box, plate = (
            json.loads((folder / f"out/{name}.summary.json").read_text()) for name in ("box", "box-on-plate")
        )
        # The impulse is the momentum that the box loses: 30 x 20 x 20 mm of aluminium at 1 m/s.
        for found in (box, plate):
            self.assertGreater(found["contact_steps"], 4)
            self.assertAlmostEqual(
                found["impulse_ns"] / (2700 * 12e-6 * (1 + found["exit_velocity"]["box"][2])), 1, delta=1e-6
            )
        self.assertLess(plate["exit_velocity"]["plate"][2], 0)
        (kernel,) = folder.glob("out/plate-*.kernel.h5")
        (of_mesh,) = folder.glob("draft/plate-*.kernel.h5")
        with h5py.File(kernel) as file, h5py.File(of_mesh) as mesh:
            for one in file, mesh:
                self.assertAlmostEqual(one.attrs["mass"] / (7850 * 0.12 * 0.08 * 0.01), 1, delta=1e-6)
        self.assertTrue(list(folder.glob("problems/*.hdf5")))
        self.assertIn("pm.modeFilter", (folder / "plate.dsp").read_text())


def keys_of(table, prefix=()):
    for key, value in table.items():
        yield (*prefix, key)
        for inner in value if isinstance(value, list) else [value]:
            if isinstance(inner, dict):
                yield from keys_of(inner, (*prefix, key))


class Keys(unittest.TestCase):
    def setUp(self):
        text = Run([BIN / "ricochet-contact", "--keys"]).out
        self.known, section = set(), ""
        for line in text.splitlines():
            if found := re.match(r"## `\[+([^]]+)\]+`", line):
                section = found[1] + "."
            elif found := re.match(r"\| `(\w+)` \|", line):
                self.known.add(section + found[1])
        self.assertIn("bodies.NAME.material.young", self.known)

    def is_key(self, dotted):
        """Whether `dotted` is a known key with a name of the user in place of NAME. Keys below geometry and
        support are free."""

        def pattern(key):
            free = r"(\.[^.]+)?" if key.endswith((".geometry", ".support")) else ""
            return key.replace(".", r"\.").replace("NAME", r"[^.]+") + free

        return (
            any(re.fullmatch(pattern(key), dotted) for key in self.known)
            or re.fullmatch(r"(bodies|obstacles)\.[^.]+", dotted) is not None
        )

    def test_of_scenes_in_the_documentation_exist(self):
        scenes = 0
        for page in PAGES:
            for line, kind, info, text in pages.blocks(page):
                table = tomllib.loads(text) if kind == "toml" else {}
                if not set(table) & {"bodies", "contact", "loads", "motion", "output", "time"}:
                    continue
                scenes += 1
                for key in keys_of(table):
                    self.assertTrue(self.is_key(".".join(key)), f"{page}:{line}: {'.'.join(key)}")
        self.assertGreater(scenes, 4)

    def test_that_studies_in_the_documentation_vary_exist(self):
        studies = 0
        for page in PAGES:
            for line, kind, info, text in pages.blocks(page):
                table = tomllib.loads(text) if kind == "toml" else {}
                if "scene" not in table:
                    continue
                studies += 1
                varied = {
                    key for part in ("set", "grid", "list", "random") for key in table.get(part, {})
                } - {"count", "seed"}
                for key in varied:
                    self.assertTrue(self.is_key(re.sub(r"\[\d+\]", "", key)), f"{page}:{line}: {key}")
        self.assertEqual(studies, 2)

    def test_that_prose_names_exist(self):
        named = set()
        for page in PAGES:
            if page == pages.SOURCE / "docs/formats/kernel.md":
                continue  # kernels keep their scene with keys of their own
            for key in re.findall(
                r"`((?:contact|modes|motion|time|loads|output)\.[a-z_.]+)`", page.read_text()
            ):
                named.add(key)
                self.assertTrue(self.is_key(key), f"{page}: {key}")
        self.assertGreater(len(named), 5)


class Surfaces(unittest.TestCase):
    def test_are_drawn_beside_the_drawing_under_its_whole_name(self):
        with tempfile.TemporaryDirectory(prefix="ricochet-page-") as name:
            folder = pathlib.Path(name)
            (folder / "sheet.geo").write_text('SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 1, 1};\n')
            done = Command("surfaces", folder / "sheet.geo")
            written = [folder / f"sheet.geo-surfaces.{kind}" for kind in ("png", "html")]
            self.assertEqual(done.out.splitlines()[-2:], [str(path) for path in written])
            self.assertTrue(all(path.is_file() for path in written))

    def test_of_what_is_no_drawing_are_refused_in_one_line(self):
        done = Command("surfaces", "none.step")
        self.assertEqual(
            (done.status, done.err),
            (2, "ricochet surfaces: none.step: there is no such file: name a .step, .brep, .geo or .msh\n"),
        )


class Links(unittest.TestCase):
    def test_lead_to_files_and_headings(self):
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
                if re.match(r"\w+:", target):
                    continue
                name, _, anchor = target.partition("#")
                there = (page.parent / name) if name else page
                self.assertTrue(there.exists(), f"{page}: {target}")
                if anchor and there.suffix == ".md":
                    self.assertIn(anchor, headings(there), f"{page}: {target}")


def headings(page):
    """Link targets of the headings of a page. A repeated heading gets a number."""
    found = []
    text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    for title in re.findall(r"^#+ (.*)$", text, re.MULTILINE):
        name = re.sub(r"[^\w\- ]", "", re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", title).lower()).replace(
            " ", "-"
        )
        found.append(name + (f"-{found.count(name)}" if name in found else ""))
    return found


if __name__ == "__main__":
    unittest.main()
