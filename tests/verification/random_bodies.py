# SPDX-License-Identifier: BSD-2-Clause
"""Computes the modes of bodies drawn at random, and counts them again.

    scripts/verify --bodies [--count N] [--seed S] [--only K …] [--limit SECONDS] [--out DIR]

Bodies are rods, boxes, cylinders, balls and angle brackets with elements of order 1 to 4, in materials over twelve
decades of Young's modulus, free or held, for a number of modes or a band, on one to three ranks. A body passes if
`ricochet modes` certifies its modes within the limit (default 300 s) and `ricochet modes --verify` finds the same counts
with matrices assembled anew. Requests beyond what the mesh has, which are refused, are drawn again.

Verdicts are kept in DIR (default out/bodies), and bodies that have one are not computed again: after an interruption, the
same command goes on. Remove DIR after a change of the programs. Prints Markdown: the failures, then a table by shape. The
status is 1 if a body fails.
"""
import collections
import math
import os
import signal
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from random_solids import SHAPES, geometry
from ricochet import programs
from ricochet.programs import ROOT
from ricochet.progress import Progress
from ricochet.studies.records import Store

ROD = """Point(1) = {{0, 0, 0}};
Point(2) = {{{length}, 0, 0}};
Line(1) = {{1, 2}};
Transfinite Curve{{1}} = {elements} + 1;
Physical Curve("body") = {{1}};
Physical Point("foot") = {{1}};
"""
SCENE = """[bodies.body]
mesh = "body.geo"
order = {order}
material = {{ density = {density:.4g}, young = {young:.4g}, poisson = {poisson:.3f}{area} }}
contact = "foot"
{support}
[modes]
{request}
"""
REFUSED = ("free displacements", "hold every node", "the mesh has no modes", "is too near 0")


def write_body(folder, random):
    """Writes a scene with one body. Returns its shape, and its order with the request."""
    kind = str(random.choice(["rod", *SHAPES]))
    order = int(random.integers(1, 5))
    young, density = 10 ** random.uniform(0, 12), 10 ** random.uniform(-1, 4.5)
    length = 10 ** random.uniform(-3, 1)
    area, poisson = "", random.uniform(0, 0.47)
    if kind == "rod":
        text = ROD.format(length=length, elements=int(10 ** random.uniform(0.5, 2.8)))
        area, poisson = f", area = {1e-4 * length**2:.4g}", 0
    else:
        x, y, z = length, length * 10 ** random.uniform(-1.7, 0), length * 10 ** random.uniform(-0.7, 0.5)
        size = math.cbrt(x * y * z) / random.uniform(1, 5 if order < 3 else 2.5)
        text = geometry(kind, x, y, z, size, size / 3)
    (folder / "body.geo").write_text(text)
    support = f'support = {{ foot = "{"x" if kind == "rod" else "xyz"}" }}' if random.random() < 0.2 else ""
    if random.random() < 0.6:
        request = f"count = {int(10 ** random.uniform(0.3, 2.9))}"
    else:
        request = f"up_to_hz = {math.sqrt(young / density) / length * 10 ** random.uniform(-0.3, 1.2):.5g}"
    (folder / "body.toml").write_text(
        SCENE.format(
            order=order,
            density=density,
            young=young,
            poisson=poisson,
            area=area,
            support=support,
            request=request,
        )
    )
    return kind, f"order {order}, {request}"


def ended(command, limit, **more):
    """(status, errors) of a command that may take `limit` seconds; no status if it takes longer."""
    process = subprocess.Popen(
        command,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,
        **more,
    )
    try:
        said = process.communicate(timeout=limit)[1].strip()
        return process.returncode, said
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGTERM)  # mpirun then ends its ranks
        process.communicate()
        return None, f"takes longer than {limit} s"


def answer(scene, ranks, limit, *words):
    """(status, last line of errors) of `ricochet modes`"""
    command = [programs.BIN / "ricochet", "modes", scene, "-n", str(ranks), *words]
    status, said = ended(command, limit)
    return status, (said.splitlines() or [""])[-1]


def judged(number, given):
    """What was drawn, with its verdict"""
    random = np.random.default_rng([given.seed, number])
    ranks = int(random.integers(1, 4))
    while True:
        with tempfile.TemporaryDirectory() as name:
            kind, drawn = write_body(Path(name), random)
            scene = Path(name) / "body.toml"
            start = time.monotonic()
            status, said = answer(scene, ranks, given.limit)
            if status == 2 and any(reason in said for reason in REFUSED):
                continue
            if status == 0:
                status, said = answer(scene, ranks, given.limit, "--verify")
            return {
                "key": f"{given.seed} {number}",
                "kind": kind,
                "drawn": f"{drawn}, ranks {ranks}",
                "seconds": time.monotonic() - start,
                "complaint": "" if status == 0 else said or f"status {status}",
            }


def add_arguments(parser):
    parser.add_argument("--count", type=int, default=500, help="number of bodies (default: 500)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the generator (default: 1)")
    parser.add_argument("--only", nargs="+", type=int, metavar="K", help="these bodies alone, by number")
    parser.add_argument("--limit", type=float, default=300, help="time for one body [s] (default: 300)")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "bodies", help="(default: out/bodies)")


def run(given):
    store = Store(given.out / "bodies.jsonl")
    numbers = given.only or range(given.count)
    progress = Progress(len(numbers))
    kinds = collections.defaultdict(list)
    for number in numbers:
        row = store.rows.get(f"{given.seed} {number}")
        already = row is not None
        row = row or store.add(judged(number, given))
        kinds[row["kind"]].append((number, row))
        progress.advance(f"{row['kind']}, {row['drawn']}", already=already)
    failures = [body for bodies in kinds.values() for body in bodies if body[1]["complaint"]]
    print("| body | drawn | seconds | complaint |\n|---|---|---|---|")
    for number, row in sorted(failures, key=lambda body: body[0]):
        print(f"| {number} | {row['kind']}, {row['drawn']} | {row['seconds']:.1f} | {row['complaint']} |")
    print("\n| shape | bodies | failed | slowest [s] |\n|---|---|---|---|")
    for kind, bodies in sorted(kinds.items()):
        failed = sum(bool(row["complaint"]) for _, row in bodies)
        print(f"| {kind} | {len(bodies)} | {failed} | {max(row['seconds'] for _, row in bodies):.1f} |")
    print(f"\nFailed: {len(failures)} of {len(numbers)}.")
    return bool(failures)
