# SPDX-License-Identifier: BSD-2-Clause
"""Times the search for modes against other solvers on one body of a scene, and prints medians and ratios.

    scripts/bench modes                                  # two-disks, order 2, 87 273 unknowns, 500 modes
    scripts/bench modes --count 100 200 500 1000 --size 3.3e-3 2.3e-3 1.7e-3 --figure modes.png
    scripts/bench modes meshes/two-disks/two-disks.toml lower --solvers ricochet calculix
    scripts/bench modes --ranks 1 2 --solvers ricochet   # gain from the second rank
    scripts/bench modes --accuracy --reference 4 4e-3 --cache calculix.json --figure accuracy.png

Times run from assembled matrices to shapes in memory; those of CalculiX from reading its input to its end.
Residuals are computed afterwards. All solvers use the same BLAS kernels and one thread a rank. CalculiX has
threads instead of ranks; it runs with one thread and with as many as there are ranks, because its second
thread often costs more than it gains.

With three points or more, fitted exponents are printed: time ~ modes^a, time ~ unknowns^b.

With --accuracy, time is compared at equal error instead: the error of the lowest 140 elastic frequencies
against a fine reference. The body is the disk of benchmarks/, whose elements become smaller in all
directions.
"""
import json
import sys
from pathlib import Path

import numpy as np

from benchmarks import calculix, equal_accuracy, launch, tables, timing
from ricochet import programs

SOLVERS = ["ricochet", "krylov-schur", "slicing", "calculix"]
HEAD = [
    "modes",
    "unknowns",
    "ranks",
    "solver",
    "time (s)",
    "runs (s)",
    "ricochet is faster by",
    "assembly (s)",
    "peak memory a rank (MiB)",
    "elastic modes found",
    "worst residual",
]


def case_runs(options, case, count, ranks, cache):
    """Runs of each (solver, ranks or threads), in turn. CalculiX is compared with the largest number of
    ranks."""
    modes = (
        "{"
        + f"count={count}"
        + (f",relative_residual={options.tolerance}" if options.tolerance else "")
        + "}"
    )
    upto_hz, rounds = None, 0

    def one(solver, n):
        nonlocal upto_hz, rounds
        if solver == "calculix":
            rounds += n == options.threads[0]
            run = calculix.run(case, count, n, rounds, cache)[-1]
        else:
            # Slicing needs the upper end that our own run found.
            run = launch.search(solver, case, modes, n, upto_hz if solver == "slicing" else None)
        if solver == "ricochet":
            upto_hz = run["upto_hz"]
        print(
            f"{count} modes, {run['unknowns']} unknowns, {solver} on {n}: {run['seconds']:.2f} s",
            file=sys.stderr,
        )
        return run

    threads = options.threads if ranks == max(options.ranks) else []
    chosen = [
        (solver, n) for solver in options.solvers for n in (threads if solver == "calculix" else [ranks])
    ]
    return timing.alternate(options.rounds, {key: lambda key=key: one(*key) for key in chosen})


def rows_of(options, case, count, ranks, cache):
    runs = case_runs(options, case, count, ranks, cache)
    for (solver, n), list_ in runs.items():
        yield {
            "scene": str(case.scene),
            "body": case.body,
            "order": case.order,
            "size": case.size,
            "modes": count,
            "unknowns": list_[0]["unknowns"],
            "ranks": n,
            "solver": solver,
            "seconds": timing.median(list_),
            "runs": [run["seconds"] for run in list_],
            "faster_by": timing.speedup(runs["ricochet", ranks], list_)
            if ("ricochet", ranks) in runs and solver != "ricochet"
            else None,
            "assembly_seconds": list_[0].get("assembly_seconds"),
            "peak_mib": max(run["peak_mib"] for run in list_),
            "elastic": list_[-1]["elastic"],
            "worst_residual": max(
                (run["worst_residual"] for run in list_ if "worst_residual" in run), default=None
            ),
            "command": list_[0]["command"],
        }


def cells_of(row):
    def show(key, form):
        return "" if row[key] is None else f"{row[key]:{form}}"

    return [
        row["modes"],
        row["unknowns"],
        row["ranks"],
        row["solver"],
        show("seconds", ".2f"),
        " ".join(f"{run:.2f}" for run in row["runs"]),
        show("faster_by", ".2f"),
        show("assembly_seconds", ".2f"),
        show("peak_mib", ".0f"),
        row["elastic"],
        show("worst_residual", ".1e"),
    ]


# ---- Growth with modes and unknowns ----


def series(rows, x, fixed):
    """(solver and ranks, label of the value of `fixed`, [x], [time]) where rows share these and have several
    x."""
    groups = {}
    for row in rows:
        groups.setdefault((f"{row['solver']} on {row['ranks']}", f"{row[fixed]} {fixed}"), {})[row[x]] = row[
            "seconds"
        ]
    for (solver, value), times in groups.items():
        if len(times) > 1:
            at = sorted(times)
            yield solver, value, at, [times[k] for k in at]


def exponents(rows):
    fits = []
    for x, fixed in (("modes", "unknowns"), ("unknowns", "modes")):
        for solver, value, at, times in series(rows, x, fixed):
            if len(at) > 2:
                slope = float(np.polyfit(np.log(at), np.log(times), 1)[0])
                fits.append({"of": x, "series": f"{solver}, {value}", "exponent": slope, "points": len(at)})
    return fits


def draw(rows, path):
    plt = tables.pyplot()
    panels = [
        (x, list(series(rows, x, fixed))) for x, fixed in (("modes", "unknowns"), ("unknowns", "modes"))
    ]
    panels = [(x, lines) for x, lines in panels if lines]
    if not panels:
        print("bench modes: nothing to draw: give several --count or --size", file=sys.stderr)
        return
    figure, axes = plt.subplots(
        1, len(panels), figsize=(6 * len(panels), 5), layout="constrained", squeeze=False
    )
    for ax, (x, lines) in zip(axes[0], panels):
        solvers, values = (list(dict.fromkeys(line[k] for line in lines)) for k in (0, 1))
        for solver, value, at, times in lines:
            ax.loglog(
                at,
                times,
                color=f"C{solvers.index(solver)}",
                marker="os^Dv<>"[values.index(value) % 7],
                label=f"{solver}, {value}",
            )
        measured = sorted({k for line in lines for k in line[2]})
        ax.set_xticks(measured, [str(k) for k in measured])
        ax.set_xticks([], minor=True)
        ax.set(xlabel=x, ylabel="time (s)")
        ax.grid(True, which="both", color="#e4e4e4")
        ax.legend(frameon=False, fontsize=8, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.15))
    figure.savefig(path, dpi=150)
    print(path)


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
    """Fills in defaults that depend on each other, and refuses what does not go together."""
    if options.scene and not options.body:
        options.parser.error(f"name a body of {options.scene}")
    if not options.scene and options.accuracy:
        options.scene, options.body = programs.ROOT / "benchmarks" / "disk.toml", "disk"
    elif not options.scene:
        options.scene, options.body = programs.ROOT / "meshes" / "two-disks" / "two-disks.toml", "upper"
        options.size = options.size or ["2.3e-3"]
        options.order = options.order or "2"
    options.threads = options.threads or sorted({1, *options.ranks})
    # In this order: slicing needs the upper end that ricochet finds.
    options.solvers = [solver for solver in SOLVERS if solver in options.solvers]
    if "slicing" in options.solvers and "ricochet" not in options.solvers:
        options.parser.error("slicing needs ricochet among --solvers, which finds its upper end")


def times(options, cache):
    if "calculix" in options.solvers and not calculix.installed():
        options.solvers.remove("calculix")
    rows = []
    tables.head(HEAD)
    for size in options.size or [None]:
        case = launch.Case(options.scene, options.body, options.order, size, options.set)
        for count in options.count:
            for ranks in options.ranks:
                for row in rows_of(options, case, count, ranks, cache):
                    rows.append(row)
                    tables.row(cells_of(row))
                if options.json:
                    options.json.write_text(
                        json.dumps({"rows": rows, "exponents": exponents(rows)}, indent=1) + "\n"
                    )
    for fit in exponents(rows):
        print(f"time ~ {fit['of']}^{fit['exponent']:.2f}: {fit['series']}, {fit['points']} points")
    if options.figure:
        draw(rows, options.figure)


def run(options):
    complete(options)
    launch.build("bench_modes")
    cache = calculix.Cache(options.cache)
    equal_accuracy.compare(options, cache) if options.accuracy else times(options, cache)
