# SPDX-License-Identifier: BSD-2-Clause
"""The web page of a result: one file with motion, charts, sound, and the commands that repeat the run."""
from pathlib import Path

from ricochet.pages.page import save_page
from ricochet.pages.run import run_of
from ricochet.result_file import expected


def write_page(result: Path, path: Path | None = None, kernels: Path | None = None) -> Path:
    """Writes the page of the result file `result` and returns its path, by default <slug>.report.html in the
    same folder.

    @param kernels  folder of the kernels (default: folder of the result)
    Raises InputError.
    """
    with expected(result):
        run = run_of(result, kernels)
        path = path or result.parent / f"{run['slug']}.report.html"
        save_page(run, path)
    return path
