# SPDX-License-Identifier: BSD-2-Clause
"""The web page of a result: one file with the motion, charts, sound, and the commands that repeat the run."""
from pathlib import Path

from ricochet.pages.page import save_page
from ricochet.pages.run import run_of
from ricochet.result_file import expected


def write_page(result: Path, path: Path | None = None, kernels: Path | None = None) -> Path:
    """Writes the page of the result file `result`, by default as <slug>.report.html beside it, and returns its path.

    @param kernels  folder of the kernels (default: that of the result)
    Raises InputError.
    """
    with expected(result):
        run = run_of(result, kernels)
        path = path or result.parent / f"{run['slug']}.report.html"
        save_page(run, path)
    return path
