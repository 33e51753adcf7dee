# SPDX-License-Identifier: BSD-2-Clause
"""Times the search for modes against other solvers on one body of a scene, and prints medians and ratios.

    scripts/bench modes                                  # two-disks, order 2, 87 273 unknowns, 500 modes
    scripts/bench modes --count 100 200 500 1000 --size 3.3e-3 2.3e-3 1.7e-3 --figure modes.png
    scripts/bench modes meshes/two-disks/two-disks.toml lower --solvers ricochet calculix
    scripts/bench modes --ranks 1 2 --solvers ricochet   # gain from the second rank
    scripts/bench modes --accuracy --reference 4 4e-3 --cache calculix.json --figure accuracy.png

Times extend from assembled matrices to mode shapes in memory; for CalculiX, from reading its input to its
end. Residuals are computed afterwards. All solvers use the same BLAS kernels and one thread per rank.
CalculiX has threads in place of ranks. It runs with one thread and with as many as there are ranks, because
its second thread often costs more than it gains.

If there are three or more points, fitted exponents are printed: time ~ modes^a, time ~ unknowns^b.

With --accuracy, times are compared at equal error: the error of the lowest 140 elastic frequencies against a
fine reference. The body is the disk of benchmarks/, whose elements are refined in all directions.
"""
import json
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from benchmarks import calculix, equal_accuracy, launch, tables, timing
from ricochet import programs

SOLVERS = ["ricochet", "krylov-schur", "slicing", "calculix"]
COLUMNS = [
    ("modes", "modes", ""),
    ("unknowns", "unknowns", ""),
    ("ranks", "ranks", ""),
    ("solver", "solver", ""),
    ("time (s)", "seconds", ".2f"),
    ("runs (s)", "runs", ".2f"),
    ("ricochet is faster by", "faster_by", ".2f"),
    ("assembly (s)", "assembly_seconds", ".2f"),
    ("peak memory a rank (MiB)", "peak_mib", ".0f"),
    ("elastic modes found", "elastic", ""),
    ("worst residual", "worst_residual", ".1e"),
]


def case_runs(options, case, count, ranks, cache):
    """Runs each (solver, ranks or threads) in turn. CalculiX is compared with the largest number of ranks."""
    modes = launch.modes_words(count, options.tolerance)
    upto_hz, rounds = None, 0

    def one(solver, n):
        nonlocal upto_hz, rounds
        if solver == "calculix":
            rounds += n == options.threads[0]
            run = calculix.run(case, count, n, rounds, cache)[-1]
        else:
            # Slicing needs the upper end that our own search has found.
            run = launch.search(solver, case, modes, n, upto_hz if solver == "slicing" else None)
        if solver == "ricochet":
            upto_hz = run["upto_hz"]
        figures = f"{count} modes, {run['unknowns']} unknowns, {solver} on {n}: {run['seconds']:.2f} s"
        print(figures, file=sys.stderr)
        return run

    threads = options.threads if ranks == max(options.ranks) else []
    chosen = [
        (solver, n) for solver in options.solvers for n in (threads if solver == "calculix" else [ranks])
    ]
    return timing.alternate(options.rounds, {key: lambda key=key: one(*key) for key in chosen})


def rows_of(options, case, count, ranks, cache):
    found = case_runs(options, case, count, ranks, cache)
    ours = found.get(("ricochet", ranks))
    for (solver, n), runs in found.items():
        residuals = [run["worst_residual"] for run in runs if "worst_residual" in run]
        yield {
            "scene": str(case.scene),
            "body": case.body,
            "order": case.order,
            "size": case.size,
            "modes": count,
            "unknowns": runs[0]["unknowns"],
            "ranks": n,
            "solver": solver,
            "seconds": timing.median(runs),
            "runs": [run["seconds"] for run in runs],
            "faster_by": timing.median(runs) / timing.median(ours) if ours and runs is not ours else None,
            "assembly_seconds": runs[0].get("assembly_seconds"),
            "peak_mib": max(run["peak_mib"] for run in runs),
            "elastic": runs[-1]["elastic"],
            "worst_residual": max(residuals, default=None),
            "command": runs[0]["command"],
        }


# ---- Growth with modes and unknowns ----


GROWTH = (("modes", "unknowns"), ("unknowns", "modes"))  # what varies, and what is fixed


def series(rows, x, fixed):
    """Yields (solver and ranks, label of the value of `fixed`, [x], [time]) for rows that share the first two
    and have several x."""
    groups = {}
    for row in rows:
        name = f"{row['solver']} on {row['ranks']}", f"{row[fixed]} {fixed}"
        groups.setdefault(name, {})[row[x]] = row["seconds"]
    for (solver, value), times in groups.items():
        if len(times) > 1:
            at = sorted(times)
            yield solver, value, at, [times[k] for k in at]


def exponents(rows):
    fits = []
    for x, fixed in GROWTH:
        for solver, value, at, times in series(rows, x, fixed):
            if len(at) > 2:
                slope = float(np.polyfit(np.log(at), np.log(times), 1)[0])
                fits.append({"of": x, "series": f"{solver}, {value}", "exponent": slope, "points": len(at)})
    return fits


def draw(rows, path):
    panels = [(x, lines) for x, fixed in GROWTH if (lines := list(series(rows, x, fixed)))]
    if not panels:
        print("bench modes: nothing to draw: give several --count or --size", file=sys.stderr)
        return
    figure = Figure(figsize=(6 * len(panels), 5), layout="constrained")
    axes = figure.subplots(1, len(panels), squeeze=False)
    for ax, (x, lines) in zip(axes[0], panels):
        solvers, values = (list(dict.fromkeys(line[k] for line in lines)) for k in (0, 1))
        for solver, value, at, times in lines:
            colour, marker = f"C{solvers.index(solver)}", "os^Dv<>"[values.index(value) % 7]
            ax.loglog(at, times, color=colour, marker=marker, label=f"{solver}, {value}")
        measured = sorted({k for line in lines for k in line[2]})
        ax.set_xticks(measured, [str(k) for k in measured])
        ax.set_xticks([], minor=True)
        ax.set(xlabel=x, ylabel="time (s)")
        ax.grid(True, which="both", color="#e4e4e4")
        ax.legend(frameon=False, fontsize=8, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.15))
    tables.save(figure, path)


# ---- Program ----


def add_arguments(parser):
    parser.add_argument(
        "scene",
        type=Path,
        nargs="?",
        metavar="SCENE.toml",
        help="(default: two-disks; with --accuracy: benchmarks/disk.toml)",
    )
    parser.add_argument("body", nargs="?", help="its name in the scene (default: that of the default scene)")
    parser.add_argument(
        "--size", nargs="+", help="geometry.size (default: the scene's; of two-disks: 2.3e-3)"
    )
    parser.add_argument("--order", help="element order (default: the scene's; of two-disks: 2)")
    parser.add_argument(
        "--count", type=int, nargs="+", default=[500], help="modes, rigid ones included (default: 500)"
    )
    parser.add_argument("--ranks", type=int, nargs="+", default=[2], help="ranks under mpirun (default: 2)")
    parser.add_argument(
        "--threads", type=int, nargs="+", help="threads of CalculiX (default: 1, and as many as ranks)"
    )
    parser.add_argument("--rounds", type=int, default=1, help="runs of each (default: 1)")
    parser.add_argument(
        "--solvers", nargs="+", default=SOLVERS[:3], choices=SOLVERS, help="(default: the first three)"
    )
    parser.add_argument("--tolerance", help="modes.relative_residual of ricochet (default: 1e-8)")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="override a scene key"
    )
    parser.add_argument("--cache", type=Path, help="JSON file with runs of CalculiX: none is repeated")
    parser.add_argument("--json", type=Path, help="write the rows into this file")
    parser.add_argument(
        "--figure", type=Path, help="draw time against modes and unknowns, or error against time"
    )
    equal_accuracy.add_arguments(parser)


def complete(options):
    """Fills in defaults that depend on each other, and refuses options that contradict each other."""
    if options.scene and not options.body:
        options.parser.error(f"name a body of {options.scene}")
    if not options.scene and options.accuracy:
        options.scene, options.body = programs.ROOT / "benchmarks" / "disk.toml", "disk"
    elif not options.scene:
        options.scene, options.body = programs.ROOT / "meshes" / "two-disks" / "two-disks.toml", "upper"
        options.size = options.size or ["2.3e-3"]
        options.order = options.order or "2"
    options.threads = options.threads or sorted({1, *options.ranks})
    # In the order of SOLVERS, because slicing needs the upper end that ricochet finds.
    options.solvers = [solver for solver in SOLVERS if solver in options.solvers]
    if "slicing" in options.solvers and "ricochet" not in options.solvers:
        options.parser.error("slicing needs ricochet among --solvers, which finds its upper end")


def times(options, cache):
    if "calculix" in options.solvers and not calculix.installed():
        options.solvers.remove("calculix")
    rows, table = [], tables.Table(COLUMNS)
    for size in options.size or [None]:
        case = launch.Case(options.scene, options.body, options.order, size, options.set)
        for count in options.count:
            for ranks in options.ranks:
                for row in rows_of(options, case, count, ranks, cache):
                    rows.append(row)
                    table.row(row)
                if options.json:
                    found = {"rows": rows, "exponents": exponents(rows)}
                    options.json.write_text(json.dumps(found, indent=1) + "\n")
    for fit in exponents(rows):
        print(f"time ~ {fit['of']}^{fit['exponent']:.2f}: {fit['series']}, {fit['points']} points")
    if options.figure:
        draw(rows, options.figure)


def run(options):
    complete(options)
    launch.build("bench_modes")
    cache = calculix.Cache(options.cache)
    equal_accuracy.compare(options, cache) if options.accuracy else times(options, cache)
