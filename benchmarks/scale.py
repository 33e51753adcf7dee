# SPDX-License-Identifier: BSD-2-Clause
"""Simulates the search for modes of large bodies on many ranks, from times recorded on one.

    scripts/bench scale                          # from the recorded times in benchmarks/pieces.csv
    scripts/bench scale --record                 # records them on this machine first, in about six minutes
    scripts/bench scale --memory 16 --figure scale.png

The slices are those that the search itself would plan. The times of one factorisation, one Lanczos vector and
one certified mode are power laws through those recorded for a plate and a ball of several sizes. A team of r
ranks is taken to be √r times as fast as one rank, as measured for two. Slices take 10 % more or less than
expected, at random. The number of teams is the largest that the memory of a rank permits, as in the search.
"""
import csv
import json
import math
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from benchmarks import launch, tables
from ricochet import programs

FOLDER = Path(__file__).parent
RECORD = FOLDER / "pieces.csv"
PER_SHIFT = 260
RECORDED_MODES = 500
# Bodies: scene, the power of λ in their number of modes (waves in a plate and in a solid), element sizes.
BODIES = {
    "plate": (
        FOLDER.parent / "meshes/two-disks/two-disks.toml",
        "lower",
        0.5,
        ["3.4e-3", "2.3e-3", "1.6e-3"],
    ),
    "solid": (FOLDER / "ball.toml", "ball", 1.5, ["7.5e-3", "6e-3", "4.7e-3"]),
}
PIECES = ["analysis", "factor", "vector", "certificate", "factor_mib"]
CASES = [("plate", 1e6, 1000), ("solid", 1e6, 1000), ("plate", 1e7, 10000), ("solid", 1e7, 10000)]
RANKS = [1, 2, 8, 32, 100, 320, 1000]
# Bytes a second between ranks, and floating-point operations a second of one rank in products of matrices.
NETWORK, FLOPS = 5e9, 35e9
# Bytes for each unknown on the first rank, which reads the mesh: recorded for the plate of 987 849 unknowns.
MESH = 2400
COLUMNS = [
    ("body", "body", ""),
    ("unknowns", "unknowns", ".0e"),
    ("modes", "modes", ""),
    ("ranks", "ranks", ""),
    ("teams", "teams", ""),
    ("time (s)", "seconds", ".0f"),
    ("efficiency", "efficiency", ".2f"),
    ("memory a rank (GiB)", "gib", ".1f"),
    ("on the first rank, for the mesh", "mesh_gib", ".1f"),
    ("slowest part", "slowest", ""),
    ("its share", "share", ".2f"),
]


def expected_vectors(power, modes, teams):
    """The vectors of each planned slice, for each number of teams."""
    command = [programs.BIN / "bench_plan", power, modes, PER_SHIFT, *teams]
    found = json.loads(programs.call([str(word) for word in command], capture=True))
    return {int(count): vectors for count, vectors in found.items()}


# ---- Recorded times ----


def record():
    rows = []
    for body, (scene, name, power, sizes) in BODIES.items():
        vectors = sum(expected_vectors(power, RECORDED_MODES, [1])[1])
        for size in sizes:
            case = launch.Case(scene, name, order=2, size=size)
            run = launch.search("ricochet", case, launch.modes_words(RECORDED_MODES), 1)
            begins = dict(run["phases"])
            slices = [begin for phase, begin in run["phases"] if phase.startswith("slice ")]
            factor = run["factor_seconds"]
            # The first slice uses factors of the plan, and the count at the end needs its own.
            compared = run["unknowns"] * RECORDED_MODES**2 / FLOPS
            iterations = begins["certificate"] - slices[0] - len(slices) * factor
            rows.append(
                {
                    "body": body,
                    "unknowns": run["unknowns"],
                    "analysis": begins["inertia counts"],
                    "factor": factor,
                    "vector": iterations / vectors,
                    "certificate": (run["seconds"] - begins["certificate"] - compared) / RECORDED_MODES,
                    "factor_mib": run["factor_mib"],
                    "seconds": run["seconds"],
                }
            )
    with RECORD.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow(
                {key: f"{value:.4g}" if isinstance(value, float) else value for key, value in row.items()}
            )


def laws():
    """For each body and piece, its value as a function of the number of unknowns."""
    with RECORD.open() as file:
        rows = list(csv.DictReader(file))
    found = {}
    for body in BODIES:
        own = [row for row in rows if row["body"] == body]
        unknowns = np.log([float(row["unknowns"]) for row in own])
        for piece in PIECES:
            slope, level = np.polyfit(unknowns, np.log([float(row[piece]) for row in own]), 1)
            found[body, piece] = lambda n, slope=slope, level=level: math.exp(level + slope * math.log(n))
    return found


# ---- Simulation ----


def memory_gib(law, body, unknowns, modes, teams, ranks):
    """Memory of one rank of a team: its part of the factors, the Lanczos basis and the shapes."""
    column = 8 * unknowns / 2**30
    shapes = modes / teams * column
    searched = law[body, "factor_mib"](unknowns) / 1024 + 3.2 * min(modes, PER_SHIFT) * column + shapes
    return teams / ranks * searched


def parts_of(law, body, unknowns, modes, teams, ranks, vectors):
    """Seconds of each part of a search."""
    gain = math.sqrt(ranks / teams)
    factor = law[body, "factor"](unknowns) / gain
    scatter = np.random.default_rng(1).normal(1, 0.1, len(vectors))
    lanczos = np.array(vectors) * scatter * law[body, "vector"](unknowns) / gain
    rounds = math.ceil(len(lanczos) / teams)
    iterations = sum(lanczos[k * teams : (k + 1) * teams].max() for k in range(rounds))
    # Each team multiplies its modes by K and M, receives the products of all others, and compares them.
    measured = law[body, "certificate"](unknowns) * modes / ranks
    compared = unknowns * modes**2 / FLOPS / ranks
    received = 8 * unknowns * modes * teams / ranks / NETWORK if teams > 1 else 0
    return {
        "analysis on one rank of each team": law[body, "analysis"](unknowns),
        "factorisations": (2 + rounds) * factor,
        "Lanczos iterations": iterations,
        "certificate": measured + compared + received,
    }


def simulate(law, body, unknowns, modes, memory):
    teams_of = {
        ranks: [t for t in range(1, ranks + 1) if ranks % t == 0 and t <= modes // 16] for ranks in RANKS
    }
    plans = expected_vectors(
        BODIES[body][2], modes, sorted({t for teams in teams_of.values() for t in teams})
    )
    # Efficiency is relative to one rank with enough memory.
    alone = sum(parts_of(law, body, unknowns, modes, 1, 1, plans[1]).values())
    for ranks, choices in teams_of.items():
        fitting = [t for t in choices if memory_gib(law, body, unknowns, modes, t, ranks) <= memory]
        teams = max(fitting, default=1)
        gib = memory_gib(law, body, unknowns, modes, teams, ranks)
        parts = parts_of(law, body, unknowns, modes, teams, ranks, plans[teams])
        seconds = sum(parts.values())
        slowest = max(parts, key=parts.get)
        yield {
            "body": body,
            "unknowns": unknowns,
            "modes": modes,
            "ranks": ranks,
            "teams": teams,
            "seconds": seconds,
            "efficiency": alone / seconds / ranks,
            "gib": gib,
            "mesh_gib": MESH * unknowns / 2**30,
            "fits": gib <= memory,
            "slowest": slowest if gib <= memory else "memory is too small",
            "share": parts[slowest] / seconds,
        }


def check(law):
    """The recorded runs on one rank, simulated from their own laws."""
    with RECORD.open() as file:
        for row in csv.DictReader(file):
            body, unknowns = row["body"], float(row["unknowns"])
            plan = expected_vectors(BODIES[body][2], RECORDED_MODES, [1])[1]
            simulated = sum(parts_of(law, body, unknowns, RECORDED_MODES, 1, 1, plan).values())
            yield f"{body}, {unknowns:.0f} unknowns: {simulated:.1f} s simulated, {float(row['seconds']):.1f} s measured"


def draw(rows):
    figure = Figure(figsize=(7, 4.2), layout="constrained")
    axes = figure.subplots()
    for body, unknowns, modes in CASES:
        own = [row for row in rows if (row["body"], row["unknowns"], row["modes"]) == (body, unknowns, modes)]
        own = [row for row in own if row["fits"]]
        label = f"{body}, {unknowns:.0e} unknowns, {modes} modes".replace("e+0", "e")
        if own:
            axes.loglog(
                [row["ranks"] for row in own], [row["seconds"] / 60 for row in own], "o-", label=label
            )
    axes.set(xlabel="ranks", ylabel="time of the search (minutes)")
    axes.grid(True, which="both", alpha=0.3)
    axes.legend()
    return figure


def add_arguments(parser):
    parser.add_argument("--record", action="store_true", help="record the times on this machine first")
    parser.add_argument("--memory", type=float, default=8, help="memory of a rank [GiB] (default: 8)")
    parser.add_argument("--figure", type=Path, help="draw time over ranks to this file")


def run(options):
    launch.build("bench_plan", "bench_modes")
    if options.record:
        record()
    law = laws()
    for line in check(law):
        print(line)
    table = tables.Table(COLUMNS)
    rows = []
    for case in CASES:
        for row in simulate(law, *case, options.memory):
            table.row(row)
            rows.append(row)
    if options.figure:
        tables.save(draw(rows), options.figure)
