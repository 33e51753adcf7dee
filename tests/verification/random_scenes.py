# SPDX-License-Identifier: BSD-2-Clause
"""Accuracy of impacts of bodies drawn at random, of which only shape, material, motion and contact are given.

    scripts/verify --random [--count N] [--seed S] [--only K …] [--limit SECONDS] [--out DIR] [--ranks N]

Each scene has one or two boxes, cylinders, balls or angle brackets that hit a floor or each other; their materials cover
six decades of Young's modulus. The requested accuracy is drawn, and Ricochet chooses the other settings. To be cheap, three
of four bodies are tilted, the band of modes is drawn narrow, and edges and faces, which would have hundreds of candidates,
have the `spacing` of a few of them.

The reference has elements of two orders more, all of whose nodes are candidates; where accuracy chooses their distance, it is
at most half of that of the points. It has twice the band, a wider zone, four times the rate and, where a contact-adapted
basis was chosen, a flexibility error of 1e-2. With a given `spacing`, a scene takes about 2 s of processor time and its
reference 10 s.

Scenes and results are kept in DIR (default out/random) and are not computed again. The status is 1 unless the true error is
at most 3 estimates in 95 % of the scenes, at most the accuracy in 95 % of those that report it, and at least a tenth of the
estimate in 80 %, or if an error above the accuracy and 3 estimates has no warning. Scenes with a program that takes more
processor time than the limit are listed and counted apart, as are those that are refused, or whose contact does not end.
The status is also 1 if no scene is judged. Prints Markdown.
"""
import contextlib
import json
import math
import resource
import signal
import time
import tomllib
from pathlib import Path

import h5py
import numpy as np

from random_solids import SHAPES, geometry
from ricochet import programs
from ricochet.errors import RicochetError
from ricochet.programs import ROOT
from true_errors import knows_shares, true_error

BODY = """
[bodies.{name}]
mesh = "{name}.geo"
material = {{ density = {density:.4g}, young = {young:.4g}, poisson = {poisson:.2f} }}
rotate_deg = [{tilt:.3f}, 0, 0]
translate = [0, 0, {height:.6g}]
velocity = [0, 0, {velocity:.6g}]
contact = "skin"
"""


# Part of the bodies that are tilted. A face that lies flat has many candidates.
TILTED = 0.75

# Candidates across a contact that is not concentrated at a point. Accuracy would choose several times more.
ACROSS = 6


def draw_body(random):
    """Shape with its sizes [m] and material of a body."""
    scale = 10 ** random.uniform(-3, 0)
    body = {
        "kind": str(random.choice(list(SHAPES))),
        "x": scale,
        "y": scale * random.uniform(0.3, 1),
        "z": scale * random.uniform(0.3, 2),
        "density": 10 ** random.uniform(2.7, 4.3),
        "young": 10 ** random.uniform(6, 12),
        "poisson": random.uniform(0, 0.45),
        "tilt": float(random.uniform(1, 15)) if random.random() < TILTED else 0.0,
    }
    if body["kind"] in ("cylinder", "ball"):
        body["y"] = body["x"]
    if body["kind"] == "ball":
        body["z"] = body["x"]
    return body


def size_of(body):
    return math.hypot(body["x"], body["y"], body["z"])


def wave_speed(body):
    return math.sqrt(body["young"] / body["density"])


def is_concentrated(bodies):
    """Whether they touch at a point, and not along an edge or a face."""
    return any(b["kind"] == "ball" or (b["kind"] == "cylinder" and b["tilt"] > 0) for b in bodies)


def write_scene(folder, number, random):
    """Writes a scene with its geometries. Returns its path and the accuracy to request."""
    bodies = [draw_body(random)]
    pair = random.random() < 0.4
    if pair:
        # A partner of similar size and material, so that one contact is not infinitely longer than the other.
        other = draw_body(random) | {"tilt": 0.0}
        ratio = bodies[0]["x"] / other["x"] * random.uniform(0.5, 2)
        for axis in "xyz":
            other[axis] *= ratio
        other["young"] = bodies[0]["young"] * 10 ** random.uniform(-1, 1)
        other["density"] = bodies[0]["density"] * 10 ** random.uniform(-0.5, 0.5)
        bodies.append(other)
    slowest = min(map(wave_speed, bodies))
    speed = slowest * 10 ** random.uniform(-5, -2.5)
    crossing = max(size_of(b) / wave_speed(b) for b in bodies)
    # Hertz's law for a body of this size; along edges and faces, contact lasts as long as the waves within it.
    contact = 3 * crossing * (slowest / speed) ** 0.2 if is_concentrated(bodies) else 5 * crossing
    text = f'title = "Random {number}"\n'
    for k, body in enumerate(bodies):
        name = "ab"[k]
        sizes = {axis: f"{body[axis]:.6g}" for axis in "xyz"}
        size = f"{size_of(body) / 6:.4g}"
        (folder / f"{name}.geo").write_text(geometry(body["kind"], **sizes, size=size))
        height = 2 * size_of(bodies[0]) if k == 0 else -body["z"]
        text += BODY.format(name=name, height=height, velocity=-speed if k == 0 else 0, **body)
    if not pair:
        text += "\n[obstacles.b]\nnormal = [0, 0, 1]\n"
    text += f'\n[contact]\nbetween = ["a", "b"]\ndirection = [0, 0, -1]\ngap = {1e-3 * speed * contact:.4g}\n'
    if not is_concentrated(bodies):
        text += f"spacing = {min(math.sqrt(b['x'] * b['y']) for b in bodies) / ACROSS:.3g}\n"
    text += f"\n[time]\nduration = {2 * contact:.4g}\nrate_hz = {100 / contact:.4g}\n"
    band = min(wave_speed(body) / size_of(body) for body in bodies) * random.uniform(1, 1.7)
    text += f"\n[modes]\nup_to_hz = {band:.3g}\n"
    accuracy = float(f"{10 ** random.uniform(-1.5, -0.5):.1g}")
    path = folder / f"random-{number}.toml"
    path.write_text(text)
    return path, accuracy


def held_candidates(folder):
    """Largest number of candidates that a kernel holds."""
    counts = [0]
    for path in folder.glob("*.kernel.h5"):
        with h5py.File(path) as kernel:
            counts.append(len(kernel["surface/node"]))
    return max(counts)


def reference_sets(settings, spacing, used, candidates):
    """Settings that are finer in every respect than those that were found.

    Accuracy may use fewer points than the elements have candidates. The elements near contact are only smaller where
    the reference, which uses all of them, would not have half the distance of the points otherwise.
    """
    found = settings["found"]
    denser = math.sqrt(max(1, candidates / used))  # than the points that were used
    sets = ["accuracy=off", "title=reference", f"time.rate_hz={4 * settings['rate_hz']}"]
    for name, mesh in found.get("bodies", {}).items():
        order = mesh["order"]
        sets += [
            f"bodies.{name}.order={order + 2}",
            f"bodies.{name}.size_factor={mesh['size_factor']}",
        ]
        if "refine" in mesh:
            factor = (order + 2) / order * min(1, denser / 2)
            balls = ", ".join(
                f"{{ at = {ball['at']}, radius = {ball['radius']}, size = {ball['size'] * factor} }}"
                for ball in mesh["refine"]
            )
            sets.append(f"bodies.{name}.refine=[{balls}]")
    sets += [f"modes.basis={found['basis']}"]
    sets += ["modes.flexibility_error=1e-2"] if found["basis"] == "contact" else []
    sets += [f"modes.up_to_hz={2 * found['up_to_hz']}"]
    sets += [f"contact.spacing={1e-3 * spacing}"] if spacing else []  # every node
    if "zone" in found:
        sets.append(f"contact.zone={1.25 * found['zone']}")
    return sets


def run_programs(scene, sets, out, ranks):
    """Returns the processor time [s]."""
    arguments = ["--out", out, "--quiet"] + [word for setting in sets for word in ("--set", setting)]
    start = processor_time()
    programs.kernel(scene, arguments, ranks)
    programs.contact(scene, arguments)
    return processor_time() - start


def processor_time():
    """Of all programs that have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@contextlib.contextmanager
def limited(seconds):
    """Ends each program that takes more processor time than this, so that the scenes that are counted do not depend on the
    load of the machine."""
    soft, hard = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(time.process_time() + seconds), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_CPU, (soft, hard))


def judged(number, given):
    """A scene's processor times, true error, estimate, accuracy, whether all shares are known, and warnings; no value
    if nothing touches or contact does not end."""
    folder = given.out / str(number)
    folder.mkdir(parents=True, exist_ok=True)
    scene, accuracy = write_scene(folder, number, np.random.default_rng([given.seed, number]))
    result = folder / "judged.json"
    if not result.exists():
        out = folder / "out"
        seconds = run_programs(scene, [f"accuracy={accuracy}"], out, given.ranks)
        found = json.loads((out / f"random-{number}.summary.json").read_text())
        if not found["exit_velocity"] or not found["error_estimate"]:
            result.write_text("null")
            return None
        (settings,) = out.glob("*.settings.toml")
        sets = reference_sets(
            tomllib.loads(settings.read_text()),
            tomllib.loads(scene.read_text())["contact"].get("spacing"),
            found["candidates"],
            held_candidates(out),
        )
        of_reference = run_programs(scene, sets, out, given.ranks)
        truth = json.loads((out / "reference.summary.json").read_text())
        if not truth["exit_velocity"]:
            result.write_text("null")
            return None
        estimate = found["error_estimate"]
        row = {
            "seconds": [seconds, of_reference],
            "error": true_error(found, truth),
            "estimate": estimate["total"],
            "accuracy": accuracy,
            "known": knows_shares(estimate),
            "warnings": found["warnings"],
        }
        result.write_text(json.dumps(row, indent=1))
    return json.loads(result.read_text())


def add_arguments(parser):
    parser.add_argument("--count", type=int, default=40, help="number of scenes (default: 40)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the generator (default: 1)")
    parser.add_argument("--only", nargs="+", type=int, metavar="K", help="these scenes alone, by number")
    parser.add_argument(
        "--limit", type=float, default=60, help="processor time of one program [s] (default: 60)"
    )
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "random", help="(default: out/random)")
    parser.add_argument("--ranks", type=int, default=1, help="ranks of ricochet-kernel (default: 1)")


def run(given):
    print(
        "| scene | seconds | of the reference | accuracy | true error | estimate | true / estimate | warnings |"
    )
    print("|---|---|---|---|---|---|---|---|")
    rows = []
    left_out = {"beyond the limit": 0, "refused": 0, "contact does not end": 0}

    def leave_out(number, cause, text):
        left_out[cause] += 1
        print(f"| {number} " + "| – " * 6 + f"| {text} |", flush=True)

    for number in given.only or range(given.count):
        try:
            with limited(given.limit):
                row = judged(number, given)
        except RicochetError as failure:
            beyond = failure.status == 128 + signal.SIGXCPU
            leave_out(
                number,
                "beyond the limit" if beyond else "refused",
                f"takes longer than {given.limit:g} s" if beyond else failure,
            )
            continue
        if row is None:
            leave_out(number, "contact does not end", "contact does not end")
            continue
        rows.append(row)
        cells = [f"{seconds:.1f}" for seconds in row["seconds"]]
        cells += [f"{row['accuracy']:g}", f"{row['error']:.1e}"]
        cells += [f"{row['estimate']:.1e}" if row["known"] else f"{row['estimate']:.1e}, a share is unknown"]
        cells += [f"{row['error'] / row['estimate']:.2f}", str(len(row["warnings"]))]
        print(f"| {number} | " + " | ".join(cells) + " |", flush=True)
    print(f"\n{len(rows)} scenes judged; " + ", ".join(f"{n} {cause}" for cause, n in left_out.items()) + ".")
    known = [row for row in rows if row["known"]]
    claimed = [row for row in known if row["estimate"] <= row["accuracy"]]
    bounded = sum(row["error"] <= 3 * row["estimate"] for row in known)
    close = sum(row["estimate"] <= 10 * row["error"] for row in known)
    met = sum(row["error"] <= row["accuracy"] for row in claimed)
    wrong = [row for row in rows if row["error"] > max(3 * row["estimate"], row["accuracy"])]
    silent = sum(not row["warnings"] for row in wrong)
    print(
        f"\nTrue error at most 3 estimates: {bounded} of {len(known)}; estimate at most 10 true errors: ",
        end="",
    )
    print(
        f"{close} of {len(known)}; accuracy reported and met: {met} of {len(claimed)}; silently wrong: {silent}."
    )
    enough = (
        known and bounded >= 0.95 * len(known) and met >= 0.95 * len(claimed) and close >= 0.8 * len(known)
    )
    return not (enough and not silent)
