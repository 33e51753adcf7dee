# SPDX-License-Identifier: BSD-2-Clause
"""Compares the contact-adapted basis with modes: vectors, time, and error of an impact with each.

    scripts/bench basis meshes/two-disks/two-disks.toml
    scripts/bench basis meshes/two-disks/two-disks.toml --errors 1e-2 1e-3 --modes 100 200 --figure basis.png

The reference is the impact computed with the lowest 400 modes of each body. The errors are those of the
impulse and of the rebound velocity of one body along its initial velocity. The errors with fewer modes
(--modes) show how accurately modes predict the impact at all. Times are medians of alternating runs, summed
over the bodies. The times of contact-adapted bases include the residual flexibility; those of the searches
for modes do not.
"""
import json
import sys
import tempfile
from pathlib import Path

from matplotlib.figure import Figure

from benchmarks import impacts, launch, tables, timing
from benchmarks.impacts import Impacts, compare, error_columns, vectors_of

ERRORS = [1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 1e-4]


def timed(options, bodies, requests):
    """Runs each request, a pair (solver, [modes]), in turn. Returns its median time [s], summed over the
    bodies."""

    cases = [launch.Case(options.scene, body, settings=options.set) for body in bodies]

    def search(solver, modes):
        runs = [launch.search(solver, case, modes, options.ranks) for case in cases]
        print(f"{solver} {modes}: {sum(run['seconds'] for run in runs):.2f} s", file=sys.stderr)
        return runs

    candidates = {request: lambda request=request: search(*request) for request in requests}
    rounds = timing.alternate(options.rounds, candidates)
    return {
        request: sum(timing.median(of_body) for of_body in zip(*runs)) for request, runs in rounds.items()
    }


def measure(options, folder):
    computed = Impacts(options, folder, options.set)
    all_modes = launch.modes_words(options.reference)
    fitted = {f"contact, error {error:g}": f"flexibility_error={error:g}" for error in options.errors}
    fitted |= {f"contact, {count} vectors": f"count={count}" for count in options.counts}
    wanted = {
        name: ("contact", f'{{basis="contact",up_to_hz={options.band:g},{text}}}')
        for name, text in fitted.items()
    }
    wanted |= {f"{count} modes": ("ricochet", launch.modes_words(count)) for count in options.modes}
    reference = computed.compute(all_modes)
    peers = [("ricochet", all_modes), ("krylov-schur", all_modes)]
    times = timed(options, computed.bodies, list(dict.fromkeys([*wanted.values(), *peers])))
    rows = []
    for name, (solver, modes) in wanted.items():
        found = computed.compute(modes)
        seconds = times[solver, modes]
        rows.append(
            {
                "basis": name,
                "solver": solver,
                "vectors": found["vectors"],
                "estimate": found["estimate"],
                "errors": compare(found, reference),
                "seconds": seconds,
                "faster_than": {peer: times[peer, all_modes] / seconds for peer, _ in peers},
            }
        )
    return {
        "scene": str(options.scene),
        "settings": options.set,
        "band_hz": options.band,
        "reference": reference,
        "seconds": {solver: times[solver, all_modes] for solver, _ in peers},
        "rows": rows,
    }


def print_table(found, speeds):
    times = ", ".join(f"{solver} {seconds:.2f} s" for solver, seconds in found["seconds"].items())
    print(f"Reference: modes, {vectors_of(found['reference'])}: {times}. Band: {found['band_hz']:g} Hz.\n")
    for speed in speeds:
        impact = found["reference"]["impacts"][speed]
        rebound = tables.show(impact["rebound"], ".6g")
        print(f"At {speed:g} m/s: rebound {rebound} m/s, impulse {impact['impulse']:.6g} N s.")
    print()
    table = tables.Table(
        [
            ("basis", "basis", ""),
            ("vectors", vectors_of, ""),
            ("estimate", lambda row: row["estimate"] or None, ".1e"),
            *error_columns(speeds),
            ("time (s)", "seconds", ".2f"),
            *(
                (f"faster than {peer} by", lambda row, peer=peer: row["faster_than"][peer], ".1f")
                for peer in found["seconds"]
            ),
        ]
    )
    for row in found["rows"]:
        table.row(row)


def draw(found, speeds, path):
    figure = Figure(figsize=(11, 4.2), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)

    def vectors(row):
        return sum(row["vectors"].values())

    rows = sorted(found["rows"], key=vectors)
    panels = [("vectors of both bodies", vectors), ("time (s)", lambda row: row["seconds"])]
    for ax, (label, of) in zip(axes, panels):
        for k, speed in enumerate(speeds):
            for solver, marker in (("contact", "o-"), ("ricochet", "s--")):
                points = [
                    (of(row), row["errors"][speed]["rebound"])
                    for row in rows
                    if row["solver"] == solver and row["errors"][speed]["rebound"]
                ]
                if points:
                    name = "contact" if solver == "contact" else "modes"
                    ax.loglog(*zip(*points), marker, color=f"C{k}", label=f"{name}, {speed:g} m/s")
        ax.set(xlabel=label)
        ax.grid(True, which="both", color="#e4e4e4")
    axes[0].set(ylabel="relative error of rebound velocity")
    modes, thin = max(found["reference"]["vectors"].values()), {"color": "black", "linewidth": 1}
    for (solver, seconds), style in zip(found["seconds"].items(), (":", "--")):
        axes[1].axvline(seconds, linestyle=style, label=f"{modes} modes, {solver}", **thin)
    axes[0].axvline(vectors(found["reference"]), linestyle=":", label="modes of the reference", **thin)
    for ax in axes:
        ax.legend(frameon=False, fontsize=8)
    tables.save(figure, path)


def add_arguments(parser):
    impacts.add_arguments(parser)
    parser.add_argument(
        "--errors",
        type=float,
        nargs="*",
        default=ERRORS,
        help=f"flexibility errors to request (default: {' '.join(f'{e:g}' for e in ERRORS)})",
    )
    parser.add_argument(
        "--counts", type=int, nargs="*", default=[], help="numbers of vectors of each body to request"
    )
    parser.add_argument(
        "--modes", type=int, nargs="*", default=[], help="smaller numbers of modes to compare as well"
    )
    parser.add_argument(
        "--reference", type=int, default=400, help="modes of each body in the reference (default: 400)"
    )
    parser.add_argument("--rounds", type=int, default=1, help="timed runs of each (default: 1)")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="override a scene key"
    )
    parser.add_argument(
        "--work", type=Path, help="keep kernels and results in this folder and use those already there"
    )
    parser.add_argument("--figure", type=Path, help="draw error against vectors and time into this file")


def run(options):
    launch.build("bench_modes", "ricochet-kernel", "ricochet_python")
    if options.work:
        options.work.mkdir(parents=True, exist_ok=True)
        found = measure(options, options.work)
    else:
        with tempfile.TemporaryDirectory(prefix="ricochet-basis-") as folder:
            found = measure(options, Path(folder))
    print_table(found, options.speeds)
    if options.json:
        options.json.write_text(json.dumps(found, indent=1) + "\n")
    if options.figure:
        draw(found, options.speeds, options.figure)
