# SPDX-License-Identifier: BSD-2-Clause
"""Compares the memory that the programs state with the memory that they reach, on one rank.

    scripts/bench memory
    scripts/bench memory meshes/hertz/two-balls.toml --set accuracy=1e-2

The stated figure is the largest "… MiB needed of …" of a program, the reached one the peak that the system reports.
"""
import re
import tempfile
from pathlib import Path

from benchmarks.launch import measured
from benchmarks.tables import Table
from ricochet import programs

MESHES = Path(__file__).resolve().parents[1] / "meshes"


def add_arguments(parser):
    parser.add_argument("scenes", nargs="*", type=Path, metavar="SCENE.toml", help="default: all of meshes/")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="override a key of each scene"
    )


def examples():
    """Scenes that name bodies: no studies, no tables, no files that are made first."""
    found = sorted(MESHES.glob("*/*.toml"))
    return [scene for scene in found if scene.parent.name != "imported" and "\n[bodies" in scene.read_text()]


def run(options):
    table = Table(
        [
            ("scene", "scene", ""),
            ("program", "program", ""),
            ("stated (MiB)", "stated", ".0f"),
            ("reached (MiB)", "reached", ".0f"),
            ("stated / reached", lambda row: row["stated"] / row["reached"], ".2f"),
        ]
    )
    for scene in options.scenes or examples():
        with tempfile.TemporaryDirectory(prefix="ricochet-bench-") as folder:
            words = [scene, *programs.with_set(options.set, folder)]
            for program in ("kernel", "contact"):
                done = measured([programs.BIN / f"ricochet-{program}", *words])
                stated = max(float(found) for found in re.findall(r"(\d+) MiB needed of \d+", done.text))
                table.row(
                    {"scene": scene.stem, "program": program, "stated": stated, "reached": done.peak_mib}
                )
