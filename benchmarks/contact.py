# SPDX-License-Identifier: BSD-2-Clause
"""Speed of contact stepping on one core, in look-ahead blocks and in single steps, and the slowest steps.

    scripts/bench contact            # multiples of real time at 44.1 kHz, medians of 5 rounds
    scripts/bench contact --worst    # percentiles of the time of one step and of 64, over a million steps

The scene is two plates with modes in closed form, pressed together (benchmarks/plates.hpp). Run scripts/build
first.
"""
import json
import subprocess

from benchmarks import launch, tables
from ricochet import errors, programs


def call(command, **options):
    done = subprocess.run([str(word) for word in command], **options)
    if done.returncode != 0:
        raise errors.ProgramError(done.returncode)
    return done


def add_arguments(parser):
    parser.add_argument(
        "--worst",
        nargs="?",
        type=int,
        const=1000000,
        metavar="STEPS",
        help="print percentiles over so many steps instead (default: 1000000)",
    )
    parser.add_argument("--rounds", type=int, default=5, help="runs of each, in random order (default: 5)")


def run(options):
    launch.build("bench_contact")
    program = programs.BIN / "bench_contact"
    if options.worst:
        call([program, "--worst", options.worst])
        return
    # Google Benchmark alternates by itself.
    done = call(
        [
            program,
            "--benchmark_format=json",
            "--benchmark_min_time=0.2",
            "--benchmark_enable_random_interleaving=true",
            f"--benchmark_repetitions={options.rounds}",
            "--benchmark_report_aggregates_only=true",
        ],
        stdout=subprocess.PIPE,
        text=True,
    )
    medians = [b for b in json.loads(done.stdout)["benchmarks"] if b["aggregate_name"] == "median"]
    rows = {b["run_name"]: b for b in medians}
    tables.head(["scene", "steps", "touching", "us a step", "x real time", "x single steps"])
    for name in sorted(rows, key=lambda name: (int(name.split()[0]), -rows[name]["cpu_time"])):
        scene, steps = name.split(": ")
        speed, plain = rows[name]["x_real_time"], rows[scene + ": single steps"]["x_real_time"]
        cells = [scene, steps, f"{rows[name]['touching']:.0f}", f"{1e6 / 44100 / speed:.2f}"]
        tables.row(cells + [f"{speed:.2f}", f"{speed / plain:.1f}"])
