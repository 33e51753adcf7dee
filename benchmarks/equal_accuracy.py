# SPDX-License-Identifier: BSD-2-Clause
"""Comparison at equal accuracy: the time of scripts/bench modes against the error of the lowest elastic
frequencies, for Ricochet and for CalculiX."""
import json
import sys

import numpy as np
from matplotlib.figure import Figure

from benchmarks import calculix, launch, tables, timing
from ricochet import errors

ELASTIC = 140
COUNT = ELASTIC + 6  # including the rigid modes of a free body
COLUMNS = [
    ("solver", "solver", ""),
    ("order", "order", ""),
    ("size", "size", "g"),
    ("unknowns", "unknowns", ""),
    ("time (s)", "seconds", ".2f"),
    ("runs (s)", "runs", ".2f"),
    ("largest error", "error", ".2e"),
]

CALCULIX = "2:5e-3 2:3.4e-3 2:2.6e-3 2:2e-3"
OURS = f"{CALCULIX} 3:1e-2 3:7e-3 3:5e-3 3:4e-3 4:1.4e-2 4:1e-2 4:7e-3"
REFERENCE = ["4", "4e-3"]


def order_and_size(text):
    order, size = text.split(":")
    return int(order), float(size)


def add_arguments(parser):
    group = parser.add_argument_group(
        "equal accuracy",
        f"time against the largest relative error of the lowest {ELASTIC} elastic frequencies; times "
        "are those of assembly and search, of CalculiX those of the whole program",
    )
    group.add_argument("--accuracy", action="store_true", help="compare at equal accuracy")
    for option, many, default, text in (
        ("--ours", "+", OURS, "our runs"),
        ("--calculix", "*", CALCULIX, "CalculiX's, order 1 or 2"),
    ):
        group.add_argument(
            option,
            type=order_and_size,
            nargs=many,
            default=list(map(order_and_size, default.split())),
            metavar="ORDER:SIZE",
            help=f"{text} (default: {default})",
        )
    group.add_argument(
        "--reference",
        nargs=2,
        default=REFERENCE,
        metavar=("ORDER", "SIZE"),
        help=f"our run that stands for the truth (default: {' '.join(REFERENCE)})",
    )
    group.add_argument(
        "--target", type=float, default=1e-3, help="error at which times are compared (default: 1e-3)"
    )


def time_at(points, target):
    """Returns the time at which the error is `target`, and whether it is extrapolated. `points` are pairs
    (error, time); the time lies on the line in log-log through the two points next to the target."""
    points = sorted(points, reverse=True)
    if len(points) < 2:
        return None, True
    after = next((k for k in range(1, len(points)) if points[k][0] <= target), len(points) - 1)
    (e0, t0), (e1, t1) = np.log(points[after - 1]), np.log(points[after])
    inside = points[-1][0] <= target <= points[0][0]
    return float(np.exp(t0 + (t1 - t0) * (np.log(target) - e0) / (e1 - e0))), not inside


def note(text):
    print(f"bench modes: {text}", file=sys.stderr)


def row_of(solver, order, size, runs, seconds, truth):
    found = np.array(runs[0]["frequency_hz"][:ELASTIC])
    if len(found) < ELASTIC:
        note(f"{solver}, order {order}, size {size:g}: only {len(found)} elastic modes")
        return None
    return {
        "solver": solver,
        "order": order,
        "size": size,
        "unknowns": runs[0]["unknowns"],
        "seconds": float(np.median(seconds)),
        "runs": seconds,
        "error": float(np.abs(found / truth - 1).max()),
        "command": runs[0]["command"],
    }


def curves(rows):
    """Points (error, time) by solver and order. Of several sizes that give the same mesh, one is kept."""
    found = {}
    for row in rows:
        curve = found.setdefault(f"{row['solver']}, order {row['order']}", {})
        curve[row["unknowns"]] = row["error"], row["seconds"]
    return {name: list(points.values()) for name, points in found.items()}


def rows_of(options, case, ranks, truth, cache):
    modes = launch.modes_words(COUNT, options.tolerance)
    candidates = {
        (order, size): lambda order=order, size=size: launch.search(
            "ricochet", case(order, size), modes, ranks, frequencies=True
        )
        for order, size in options.ours
    }
    for (order, size), runs in timing.alternate(options.rounds, candidates).items():
        seconds = [run["assembly_seconds"] + run["seconds"] for run in runs]
        yield row_of("ricochet", order, size, runs, seconds, truth)
    if not options.calculix or not calculix.installed():
        return
    for order, size in options.calculix:
        # Only the faster number of threads is kept.
        try:
            trials = [
                calculix.run(case(order, size), COUNT, threads, options.rounds, cache)
                for threads in options.threads
            ]
        except errors.RicochetError as error:
            # CalculiX usually runs out of memory. The other runs are still reported.
            note(f"calculix, order {order}, size {size:g}: left out: {error}")
            continue
        runs = min(trials, key=timing.median)
        yield row_of("calculix", order, size, runs, [run["seconds"] for run in runs], truth)


def report(rows, target):
    """Prints the time for the target error, by solver and order, and the ratio of CalculiX's best time to
    ours."""
    needed = {}
    for name, points in curves(rows).items():
        seconds, beyond = time_at(points, target)
        if seconds is None:
            print(f"{name}: one mesh is not enough for its time at {target:.2g}")
            continue
        needed[name] = seconds, beyond
        print(
            f"{name}: {seconds:.3g} s for an error of {target:.2g}, "
            + ("extrapolated: no runs on both sides of it" if beyond else "interpolated")
        )
    # Interpolated times take precedence over extrapolated ones.
    best = {
        family: min(
            (beyond, seconds, name) for name, (seconds, beyond) in needed.items() if name.startswith(family)
        )
        for family in ("ricochet", "calculix")
        if any(name.startswith(family) for name in needed)
    }
    if len(best) == 2:
        (ours_beyond, ours, name), (peer_beyond, peer, peer_name) = best["ricochet"], best["calculix"]
        print(
            f"{name} is faster than {peer_name} by {peer / ours:.3g}"
            + (", extrapolated" if ours_beyond or peer_beyond else "")
        )


def draw(rows, target, path):
    figure = Figure(figsize=(6.5, 4.5), layout="constrained")
    ax = figure.subplots()
    for name, points in curves(rows).items():
        errors, seconds = zip(*sorted(points))
        ax.loglog(seconds, errors, marker="s" if name.startswith("calculix") else "o", label=name)
    ax.axhline(target, color="black", linestyle="--", linewidth=0.8)
    ax.set(xlabel="time (s)", ylabel=f"largest error of {ELASTIC} frequencies")
    ax.grid(True, which="both", color="#e4e4e4")
    ax.legend(frameon=False)
    tables.save(figure, path)


def compare(options, cache):
    def case(order, size):
        return launch.Case(options.scene, options.body, order, size, options.set)

    ranks = options.ranks[0]
    order, size = int(options.reference[0]), float(options.reference[1])
    run = launch.search("ricochet", case(order, size), launch.modes_words(COUNT), ranks, frequencies=True)
    truth = np.array(run["frequency_hz"][:ELASTIC])
    print(f"Reference: order {order}, size {size:g}, {run['unknowns']} unknowns, {run['seconds']:.2f} s\n")
    rows, table = [], tables.Table(COLUMNS)
    for row in filter(None, rows_of(options, case, ranks, truth, cache)):
        rows.append(row)
        table.row(row)
        if options.json:
            options.json.write_text(json.dumps({"reference": run, "rows": rows}, indent=1) + "\n")
    print()
    report(rows, options.target)
    if options.figure:
        draw(rows, options.target, options.figure)
