# SPDX-License-Identifier: BSD-2-Clause
"""Balances of scenes drawn at random, of 2 to 20 bodies that turn and meet.

    scripts/verify --meetings [--steps N] [--seed S] [--only K …] [--limit SECONDS]

Boxes and irregular clouds of 27 masses, with modes, arrive at each other, half of them over a floor with gravity. Drawn are their
number, sizes, frequencies, attitudes, speeds and spins, a residual flexibility over two decades or none, a coefficient of
friction up to 2 or none, and steps over six decades. The bodies fly to their first touch before the steps that are counted. A
scene of up to 5 bodies makes at most 5000 of them, and one of n bodies 25000/n. scripts/build must have run once.

The status is 1 if the energy rises above that of the start and the work of gravity by more than 1e-12, if momentum errs by more
than 1e-13 or angular momentum by more than 1e-12, if the balance of all energies, which adds up the round-off of every step, errs
by more than 1e-11, if a step fails or takes more processor time than the limit, or if a scene is refused for another reason than
an overlap at the start. Prints Markdown.
"""
import json
import signal

from benchmarks import launch, tables
from random_scenes import limited
from ricochet import programs
from ricochet.errors import RicochetError
from ricochet.progress import Progress

STEPS = 5000  # of a scene
# What is judged, by key: title and bound
BOUNDS = {
    "energy": ("energy above", 1e-12),
    "ledger": ("energy balance", 1e-11),
    "momentum": ("momentum", 1e-13),
    "angular": ("angular momentum", 1e-12),
}
GROUPS = ((2, 5), (6, 10), (11, 20))  # bodies


def add_arguments(parser):
    parser.add_argument("--steps", type=int, default=1000000, help="in all scenes (default: 1000000)")
    parser.add_argument("--seed", type=int, default=1, help="of the first scene (default: 1)")
    parser.add_argument("--only", nargs="+", type=int, metavar="K", help="the scenes of these seeds alone")
    parser.add_argument(
        "--limit", type=float, default=120, help="processor time of one scene [s] (default: 120)"
    )


def computed(seed, limit):
    """The figures of a scene, None if its bodies overlap at the start. What fails is in `complaint`."""
    try:
        with limited(limit):
            scene = json.loads(programs.call([programs.BIN / "random_meetings", seed, STEPS], capture=True))
    except RicochetError as failure:
        if "overlap" in str(failure):
            return None
        beyond = failure.status == 128 + signal.SIGXCPU
        return {"seed": seed, "complaint": f"takes longer than {limit:g} s" if beyond else str(failure)}
    wrong = [title for key, (title, bound) in BOUNDS.items() if not scene[key] <= bound]
    return scene | {"complaint": scene["complaint"] or ", ".join(wrong)}


def seeds(given):
    number = given.seed
    while True:
        yield number
        number += 1


def run(given):
    launch.build("random_meetings")
    progress = Progress(given.steps)
    found, failed, refused, made = [], [], 0, 0
    for seed in given.only or seeds(given):
        scene = computed(seed, given.limit)
        if scene is None:
            refused += 1
            continue
        if scene["complaint"]:
            failed.append(scene)
        if "steps" in scene:
            found.append(scene)
            made += scene["steps"]
            progress.advance(f"scene {seed}, {scene['bodies']} bodies", scene["steps"])
        if not given.only and made >= given.steps:
            break
    table = tables.Table(
        [
            ("bodies", "bodies", ""),
            ("scenes", "scenes", ""),
            ("steps", "steps", ""),
            ("with a touch", "touching", ""),
            ("most points", "points", ""),
            *((title, key, ".1e") for key, (title, _) in BOUNDS.items()),
        ]
    )
    for few, many in (*GROUPS, (2, 20)):
        some = [scene for scene in found if few <= scene["bodies"] <= many]
        if some:
            row = {"bodies": f"{few}–{many}", "scenes": len(some)}
            row |= {key: sum(scene[key] for scene in some) for key in ("steps", "touching")}
            table.row(row | {key: max(scene[key] for scene in some) for key in ("points", *BOUNDS)})
    print(
        f"\nFailed: {len(failed)} of {len(found)} scenes; {refused} that overlap at the start were left out."
    )
    for scene in failed:
        print(f"- seed {scene['seed']}: {scene['complaint']}")
    return bool(failed or not found)
