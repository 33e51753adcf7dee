# SPDX-License-Identifier: BSD-2-Clause
"""The notebooks in examples/notebooks run from top to bottom and are as short as they promise."""

import os
import shutil

import nbformat
from nbclient import NotebookClient

from programs import SOURCE, ProgramTest

FOLDER = SOURCE / "examples" / "notebooks"


def html_of(cell):
    """The HTML output of the cell."""
    return "".join(output.get("data", {}).get("text/html", "") for output in cell.outputs)


class Notebooks(ProgramTest):
    def run_notebook(self, name):
        """Runs the notebook in a copy of the folder. Returns its code cells with their outputs."""
        folder = self.folder / "notebooks"
        shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("out"))
        notebook = nbformat.read(folder / name, as_version=4)
        os.environ |= {
            "HOME": str(self.folder),
            "JUPYTER_PLATFORM_DIRS": "1",
            "PYDEVD_DISABLE_FILE_VALIDATION": "1",
        }
        NotebookClient(notebook, timeout=240, resources={"metadata": {"path": folder}}).execute()
        return [cell for cell in notebook.cells if cell.cell_type == "code"]

    def test_drop_shows_modes_and_force_of_a_step_part_in_ten_lines(self):
        cells = self.run_notebook("drop.ipynb")
        lines = [line for cell in cells[:2] for line in cell.source.splitlines() if line.strip()]
        self.assertLessEqual(len(lines), 10)
        self.assertIn("frequency [Hz]", html_of(cells[0]))
        self.assertIn("peak force", html_of(cells[1]))
        self.assertIn("<svg", html_of(cells[1]))
        self.assertTrue((self.folder / "notebooks/out/bracket.report.html").is_file())

    def test_study_runs(self):
        self.assertIn(
            "True",
            [
                output.data["text/plain"]
                for cell in self.run_notebook("study.ipynb")
                for output in cell.outputs
                if output.output_type == "execute_result"
            ],
        )

    def test_hold_no_outputs(self):
        for path in FOLDER.glob("*.ipynb"):
            for cell in nbformat.read(path, as_version=4).cells:
                self.assertFalse(cell.get("outputs"), path)


if __name__ == "__main__":
    import unittest

    unittest.main()
