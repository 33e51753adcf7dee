# SPDX-License-Identifier: BSD-2-Clause
"""Cost of the stress of a surface: processor time of kernel and impact with and without it, in turn.

    scripts/bench stress                                   # a bracket with 500 modes, about 2000 nodes
    scripts/bench stress meshes/phone/phone.toml --set modes.count=100

The files are those that hold stress: the kernels, and the result. Run scripts/build first.
"""
import tempfile
from pathlib import Path

from benchmarks import launch, tables, timing
from ricochet import programs

BRACKET = Path(__file__).resolve().parents[1] / "meshes" / "bracket" / "bracket.toml"
SETTINGS = ["modes={count=500}", "bodies.bracket.geometry.largest=0.0028"]
COLUMNS = [
    ("program", "program", ""),
    ("without (s)", "without", ".2f"),
    ("with stress (s)", "with", ".2f"),
    ("ratio", "ratio", ".2f"),
    ("written without (MB)", "mb_without", ".1f"),
    ("with (MB)", "mb_with", ".1f"),
]


def add_arguments(parser):
    parser.add_argument("scene", nargs="?", type=Path, metavar="SCENE.toml", help="default: the bracket")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="override a key of the scene"
    )
    parser.add_argument("--rounds", type=int, default=3, help="default: 3")


def once(scene, settings, stress):
    """Processor times [s] and sizes of the files [MB] of both programs, by name."""
    with tempfile.TemporaryDirectory(prefix="ricochet-bench-") as folder:
        words = [
            scene,
            "--out",
            folder,
            *programs.with_set([*settings, f"output.stress={str(stress).lower()}"]),
        ]
        out, before = {}, 0
        for program in ("kernel", "contact"):
            done = launch.measured([programs.BIN / f"ricochet-{program}", *words])
            written = sum(file.stat().st_size for file in Path(folder).rglob("*") if file.is_file())
            out[program] = {"seconds": done.cpu_seconds, "mb": (written - before) / 1e6}
            before = written
        return out


def run(options):
    scene = options.scene or BRACKET
    settings = [*([] if options.scene else SETTINGS), "output.view=true", *options.set]
    found = timing.alternate(
        options.rounds,
        {name: lambda name=name: once(scene, settings, name == "with") for name in ("without", "with")},
    )
    table = tables.Table(COLUMNS)
    for program in ("kernel", "contact"):
        row = {name: timing.median([each[program] for each in found[name]]) for name in found}
        table.row(
            {
                "program": f"ricochet-{program}",
                **row,
                "ratio": row["with"] / row["without"],
                **{f"mb_{name}": found[name][-1][program]["mb"] for name in found},
            }
        )
