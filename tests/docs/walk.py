# SPDX-License-Identifier: BSD-2-Clause
"""Runs the tutorials command by command, as a newcomer would, with the time of each block.

    scripts/verify --tutorials                  # all of docs/tutorials
    scripts/verify --tutorials docs/tutorials/bell.md
    scripts/verify --tutorials --quick          # coarser examples, as the tests run them

It works in a folder of its own, which it removes afterwards. For docs/tutorials/cluster.md it starts a SLURM
of one node on the loopback address (scripts/setup --tests installs it). The lines of output that a page shows
must appear; without --quick their numbers are compared as well. The status is 1 if a page does not behave as
it describes.
"""
import sys
import tempfile
import time
from pathlib import Path

import pages
import slurm
from ricochet.programs import ROOT


def walk(path, quick):
    with tempfile.TemporaryDirectory(prefix="ricochet-page-") as name:
        folder = Path(name)
        pages.make_folder(folder)
        if path.name != "cluster.md":
            return pages.Page(path, folder, quick, print).run()
        with slurm.node(folder / "slurm"):
            return pages.Page(path, folder, quick, print).run()


def add_arguments(parser):
    parser.add_argument("pages", type=Path, nargs="*", help="default: all of docs/tutorials")
    parser.add_argument("--quick", action="store_true", help="coarser examples, numbers not compared")


def run(options):
    status = 0
    for path in options.pages or sorted((ROOT / "docs" / "tutorials").glob("*.md")):
        begun = time.monotonic()
        print(path)
        try:
            walk(path.resolve(), options.quick)
            print(f"{time.monotonic() - begun:7.1f} s  in all")
        except pages.Failed as problem:
            print(problem, file=sys.stderr)
            status = 1
    return status
