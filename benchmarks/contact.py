# SPDX-License-Identifier: BSD-2-Clause
"""Speed of contact stepping on one core, in look-ahead blocks and in single steps, and the slowest steps.

    scripts/bench contact            # multiples of real time at 44.1 kHz, medians of 5 rounds
    scripts/bench contact --worst    # percentiles of the time of one step and of 64, over a million steps
    scripts/bench contact --least    # least CPU times, comparable while other programs run
    scripts/bench contact --turning  # steps of bodies that turn, and their flight

The scene is two plates with modes in closed form, pressed together (benchmarks/plates.hpp), and with
--turning, boxes of 300 modes each (benchmarks/lattice.hpp). Run scripts/build first.
"""
import json

from benchmarks import launch, tables
from ricochet import programs

COLUMNS = [
    ("scene", "scene", ""),
    ("steps", "steps", ""),
    ("touching", "touching", ".0f"),
    ("us a step", "us", ".2f"),
    ("x real time", "speed", ".2f"),
    ("x single steps", "gain", ".1f"),
]


def add_arguments(parser):
    parser.add_argument(
        "--worst",
        nargs="?",
        type=int,
        const=1000000,
        metavar="STEPS",
        help="print percentiles over so many steps instead (default: 1000000)",
    )
    parser.add_argument(
        "--least",
        nargs="?",
        const="",
        metavar="NAME",
        help="print least and median CPU times instead, of scenes whose name contains NAME",
    )
    parser.add_argument("--turning", action="store_true", help="measure bodies that turn instead")
    parser.add_argument("--rounds", type=int, default=5, help="runs of each, in random order (default: 5)")


def run(options):
    launch.build("bench_contact")
    program = programs.BIN / "bench_contact"
    if options.worst:
        programs.call([program, "--worst", options.worst])
        return
    if options.least is not None:
        programs.call([program, "--least", options.least])
        return
    if options.turning:
        programs.call([program, "--turning", options.rounds])
        return
    # Google Benchmark itself alternates the variants.
    command = [
        program,
        "--benchmark_format=json",
        "--benchmark_min_time=0.2",
        "--benchmark_enable_random_interleaving=true",
        f"--benchmark_repetitions={options.rounds}",
        "--benchmark_report_aggregates_only=true",
    ]
    found = json.loads(programs.call(command, capture=True))["benchmarks"]
    rows = {b["run_name"]: b for b in found if b.get("aggregate_name", "median") == "median"}
    table = tables.Table(COLUMNS)
    for name in sorted(rows, key=lambda name: (int(name.split()[0]), -rows[name]["cpu_time"])):
        scene, steps = name.split(": ")
        speed, plain = rows[name]["x_real_time"], rows[scene + ": single steps"]["x_real_time"]
        row = {"scene": scene, "steps": steps, "touching": rows[name]["touching"], "speed": speed}
        table.row(row | {"us": 1e6 / 44100 / speed, "gain": speed / plain})
