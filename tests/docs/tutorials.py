# SPDX-License-Identifier: BSD-2-Clause
"""The tutorials and the page on convergence behave as they describe. The examples are coarser here; scripts/verify --tutorials runs them
unchanged."""

import json
import pathlib
import tempfile
import unittest

import numpy as np
import pages
import slurm

TUTORIALS = pages.SOURCE / "docs" / "tutorials"


class Tutorials(unittest.TestCase):
    def place(self):
        scope = tempfile.TemporaryDirectory(prefix="ricochet-page-")
        self.addCleanup(scope.cleanup)
        folder = pathlib.Path(scope.name)
        pages.make_folder(folder)
        return folder

    def test_do_what_they_say_one_after_the_other(self):
        folder = self.place()
        out = folder / "meshes" / "bell" / "out"

        pages.Page(TUTORIALS / "bell.md", folder, quick=True).run()
        self.assertTrue((out / "bell-ringing.mic.wav").is_file())

        study = pages.Page(TUTORIALS / "study.md", folder, quick=True).run().names
        self.assertEqual(len(study["speed"]), 12)
        # Momentum of a ball of this mass: the impulse is once this if it
        # sticks, twice if it bounces off a wall.
        mass = study["density"] * 4 / 3 * np.pi * 0.035**3
        by_momentum = study["impulse"] / (mass * study["speed"])
        self.assertTrue(((by_momentum > 0.7) & (by_momentum < 2)).all(), by_momentum)

        # The kernel of the bell is kept. SLURM jobs then compute the kernel of the clapper and the impacts.
        for pattern in ("blows.*", "clapper-*"):
            for path in out.glob(pattern):
                path.unlink()
        self.enterContext(slurm.node(folder / "slurm"))
        pages.Page(TUTORIALS / "cluster.md", folder, quick=True).run()

    def test_the_page_on_convergence_varies_what_it_says(self):
        folder = self.place()
        pages.Page(pages.SOURCE / "docs/converged.md", folder, quick=True).run()
        out = folder / "meshes/two-disks/out"
        fine, given, coarse, points, estimated = (
            json.loads((out / f"{name}.summary.json").read_text())
            for name in ("fine-step", "two-disks", "coarse-step", "more-points", "estimated")
        )
        # Shorter steps lose less energy in contact (theory, section 11). Steps of
        # 1 ms are too coarse and cause warnings.
        self.assertLess(fine["energy_lost_contact"], given["energy_lost_contact"])
        self.assertLess(given["energy_lost_contact"], coarse["energy_lost_contact"])
        self.assertGreater(len(coarse["warnings"]), len(given["warnings"]))
        self.assertGreater(points["candidates"], given["candidates"])
        self.assertIsNotNone(estimated["error_estimate"]["spacing"])


class Runner(unittest.TestCase):
    """The runner detects faults of pages."""

    def run_page(self, text):
        with tempfile.TemporaryDirectory(dir=pages.SOURCE / "tests" / "docs") as name:
            folder = pathlib.Path(name)
            (folder / "page.md").write_text(text)
            pages.Page(folder / "page.md", folder, quick=False).run()

    def test_commands_carry_on_and_hidden_ones_run(self):
        self.run_page(
            "```sh\nexport A=5\nmkdir b; cd b\n```\n<!-- run: B=6; export B -->\n"
            "```sh\necho $A$B $PWD\n```\n```text\n56 …/b\n```\n"
        )
        self.run_page(
            "```python\nx = 2\n```\n```python\nprint('x is', x * 1.01)\n```\n```text\nx is 2\n```\n"
        )
        self.run_page("<!-- not run: never -->\n```sh\nfalse\n```\n```sh\ntrue\n```\n")

    def test_a_command_that_fails_is_reported_with_its_line(self):
        with self.assertRaisesRegex(pages.Failed, r"page.md:3: status 1"):
            self.run_page("text\n\n```sh\nfalse\ntrue\n```\n")

    def test_output_that_differs_is_reported(self):
        for shown in ("found 3.1 files", "found 3 file", "3 files", "found 3 files\nmore"):
            with self.assertRaisesRegex(pages.Failed, "no such line"):
                self.run_page(f"```sh\necho found 3 files\n```\n```text\n{shown}\n```\n")

    def test_a_file_that_reads_otherwise_is_reported(self):
        with self.assertRaisesRegex(pages.Failed, "reads otherwise"):
            self.run_page("```geo meshes/bell/bell.geo\nPoint(1) = {0, 0, 0};\n```\n")


if __name__ == "__main__":
    unittest.main()
