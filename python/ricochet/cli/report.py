# SPDX-License-Identifier: BSD-2-Clause
"""Makes one page of a run, which opens in any browser and needs nothing else: what was asked, the impact in motion, charts,
sound, energy, errors, and how to repeat it.

    ricochet report out/two-disks.result.h5 [--out PAGE.html] [--kernels DIR]

Writes <slug>.report.html beside the result and prints its path. Ends with status 2, and one line, when a file can't be read.
"""
import sys
from pathlib import Path

from ricochet.cli.command_line import Parser
from ricochet.pages.page import write_page
from ricochet.pages.run import run_of
from ricochet.result_file import BadInput, expected


def main():
    parser = Parser(__doc__, "RESULT.h5")
    parser.add_argument("result", type=Path, metavar="RESULT.h5")
    parser.add_argument("--out", type=Path, metavar="PAGE.html", help="the page (default: beside the result)")
    parser.add_argument("--kernels", type=Path, metavar="DIR", help="folder of the kernels (default: beside the result)")
    options = parser.parse_args()
    try:
        with expected(options.result):
            run = run_of(options.result, options.kernels)
            path = options.out or options.result.parent / f"{run['slug']}.report.html"
            write_page(run, path)
    except BadInput as error:
        print(f"report: {error}", file=sys.stderr)
        return 2
    print(path)
    return 0
