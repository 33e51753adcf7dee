# SPDX-License-Identifier: BSD-2-Clause
"""Overhead of a sweep in addition to its impacts.

    scripts/bench sweep
    scripts/bench sweep --impacts 10000 --scenes two-rods --set modes.count=20 --set time.rate_hz=20.0

The bare impacts run in as many processes as --jobs. Each process reads its share of the requests from its
standard input. The time of the bare impacts is the sum of the times in their summaries, from kernels in
memory to results in memory. The sweep needs additional time for starts, checks, the journal and the tables.
The overhead is this additional time, as wall time × processes, divided by the time of the bare impacts. If
other work runs on the machine, compare processor times instead; those of the bare processes include reading
their requests. Kernels are kept in build/bench-sweep.
"""
import json
import os
import resource
import subprocess

from benchmarks import launch, tables, timing
from ricochet import errors, programs
from ricochet.errors import InputError
from ricochet.studies.study import Study

# Scene: velocity component that is varied, and its range [m/s].
SCENES = {
    "two-disks": ("bodies.upper.velocity[1]", -2.0, -0.5),
    "two-rods": ("bodies.moving.velocity[0]", 0.5, 2.0),
}
COLUMNS = [
    ("scene", "scene", ""),
    ("impacts", "impacts", ""),
    ("bare (s)", "bare", ".1f"),
    ("sweep (s)", "sweep", ".1f"),
    ("overhead", "overhead", ".1%"),
    ("processor time: bare (s)", "bare_cpu", ".1f"),
    ("sweep (s)", "sweep_cpu", ".1f"),
    ("beside an impact (ms)", "beside_ms", ".2f"),
]


def write_study(folder, name, options):
    key, low, high = SCENES[name]
    path = folder / f"{name}.toml"
    path.write_text(
        f'scene = "{programs.ROOT}/meshes/{name}/{name}.toml"\n[set]\n"output.view" = false\n'
        + "".join(f'"{key}" = {value}\n' for key, value in (setting.split("=", 1) for setting in options.set))
        + f"[random]\ncount = {options.impacts}\n"
        f'"{key}" = {{ uniform = [{low}, {high}] }}\n"contact.gap" = {{ uniform = [1e-4, 1e-3] }}\n'
    )
    return path


def sweep(study, folder, options, *more):
    """Runs the sweep. Returns its wall and processor time [s]."""
    words = ["sweep", study, "--out", folder, "--jobs", options.jobs, *more]
    done = launch.measured([programs.BIN / "ricochet", *words])
    return done.seconds, done.cpu_seconds


def bare(study, folder, options):
    """Runs the bare impacts. Returns the sum of the times that they report, and the processor time [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words = programs.with_set(programs.settings(study.fixed), folder)
    command = [str(word) for word in (programs.BIN / "ricochet-contact", study.scene, "--batch", *words)]
    lines = [json.dumps({"set": programs.settings(setting)}) + "\n" for setting in study.settings]
    running = []
    for k in range(options.jobs):
        requests, answers = folder / f"requests.{k}", folder / f"answers.{k}"
        requests.write_text("".join(lines[k :: options.jobs]))
        with open(requests) as given, open(answers, "w") as found:
            environment = os.environ | programs.ONE_THREAD
            process = subprocess.Popen(command, stdin=given, stdout=found, env=environment)
        running.append((process, answers))
    for process, _ in running:
        if process.wait() != 0:
            raise errors.failure(process.returncode)
    reported = [json.loads(line) for _, answers in running for line in answers.read_text().splitlines()]
    failed = [answer["error"] for answer in reported if answer["status"] != 0]
    if failed:
        raise InputError(f"{len(failed)} impacts failed: {failed[0]}")
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_seconds = used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime
    return sum(answer["summary"]["wall_s"] for answer in reported), cpu_seconds


def measure(name, options, folder):
    """Measures a scene. Returns the row of the round with the median overhead."""
    path = write_study(folder, name, options)
    sweep(path, folder, options, "--kernels")

    def anew():
        for journal in folder.glob(f"{name}.sweep.*"):
            journal.unlink()
        return sweep(path, folder, options)

    found = timing.alternate(
        options.rounds, {"bare": lambda: bare(Study(path), folder, options), "sweep": anew}
    )
    rounds = [
        {
            "scene": name,
            "impacts": options.impacts,
            "bare": own,
            "sweep": wall,
            "overhead": wall * options.jobs / own - 1,
            "bare_cpu": own_cpu,
            "sweep_cpu": cpu,
            "beside_ms": 1e3 * (cpu - own_cpu) / options.impacts,
        }
        for (own, own_cpu), (wall, cpu) in zip(found["bare"], found["sweep"])
    ]
    return sorted(rounds, key=lambda row: row["overhead"])[len(rounds) // 2]


def add_arguments(parser):
    parser.add_argument(
        "--scenes", nargs="+", choices=SCENES, default=list(SCENES), help="scenes of meshes/ (default: all)"
    )
    parser.add_argument("--impacts", type=int, default=10000, help="impacts of the study (default: 10000)")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, help="processes (default: all cores)"
    )
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="override a key of the scenes"
    )
    parser.add_argument(
        "--rounds", type=int, default=1, help="rounds, of which the median counts (default: 1)"
    )


def run(options):
    launch.build("ricochet-kernel", "ricochet-contact")
    folder = programs.ROOT / "build" / "bench-sweep"
    folder.mkdir(parents=True, exist_ok=True)
    print(f"{options.jobs} processes\n")
    table = tables.Table(COLUMNS)
    for name in options.scenes:
        table.row(measure(name, options, folder))
