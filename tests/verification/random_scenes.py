# SPDX-License-Identifier: BSD-2-Clause
"""Accuracy of impacts of bodies drawn at random, of which only shape, material, motion and contact are given.

    scripts/verify --random [--count N] [--seed S] [--only K …] [--limit SECONDS] [--out DIR] [--ranks N]

Each scene has one or two boxes, cylinders, balls or angle brackets that hit a floor or each other, flat or tilted;
their materials cover six decades of Young's modulus. The band of modes and the requested accuracy are drawn, such that a
scene and its reference take about a minute; Ricochet chooses the other settings. The reference has elements of the next order
with half the distance between candidates, twice the band, a wider zone, four times the rate and, where a contact-adapted basis
was chosen, a flexibility error of 1e-2. Scenes and results are kept in DIR (default out/random) and are
not computed again. The status is 1 unless the true error is at most 3 estimates in 95 % of the scenes, at most the
accuracy in 95 % of those that report it, and at least a tenth of the estimate in 80 %, or if an error above the accuracy
and 3 estimates has no warning. A scene that takes longer than the limit is listed and not counted. Prints Markdown.
"""
import contextlib
import json
import math
import signal
import time
import tomllib
from pathlib import Path

import numpy as np

from random_solids import SHAPES, geometry
from ricochet import programs
from ricochet.errors import RicochetError
from ricochet.programs import ROOT

BODY = """
[bodies.{name}]
mesh = "{name}.geo"
material = {{ density = {density:.4g}, young = {young:.4g}, poisson = {poisson:.2f} }}
rotate_deg = [{tilt:.3f}, 0, 0]
translate = [0, 0, {height:.6g}]
velocity = [0, 0, {velocity:.6g}]
contact = "skin"
"""


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
        "tilt": float(random.choice([0.0, random.uniform(1, 15)])),
    }
    if body["kind"] == "ball":
        body["y"] = body["z"] = body["x"]
    return body


def size_of(body):
    return math.hypot(body["x"], body["y"], body["z"])


def wave_speed(body):
    return math.sqrt(body["young"] / body["density"])


def write_scene(folder, number, random):
    """Writes a scene with its geometries. Returns its path, the speed of approach and the accuracy to request."""
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
    # Hertz's law for a body of this size, and the waves within it; the flat and the tilted last no longer.
    hertz = 3 * max(size_of(b) / wave_speed(b) for b in bodies) * (slowest / speed) ** 0.2
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
    text += f'\n[contact]\nbetween = ["a", "b"]\ndirection = [0, 0, -1]\ngap = {1e-3 * speed * hertz:.4g}\n'
    text += f"\n[time]\nduration = {3 * hertz:.4g}\nrate_hz = {300 / hertz:.4g}\n"
    band = min(wave_speed(body) / size_of(body) for body in bodies) * random.uniform(1, 2.5)
    text += f"\n[modes]\nup_to_hz = {band:.3g}\n"
    accuracy = float(f"{10 ** random.uniform(-1.5, -0.5):.1g}")
    path = folder / f"random-{number}.toml"
    path.write_text(text)
    return path, speed, accuracy


def reference_sets(settings):
    """Settings that are finer in every respect than those that were found."""
    found = settings["found"]
    sets = ["accuracy=off", "title=reference"]
    for name, mesh in found.get("bodies", {}).items():
        order = mesh["order"]
        sets += [
            f"bodies.{name}.order={order + 1}",
            f"bodies.{name}.size_factor={mesh['size_factor']}",
        ]
        if "refine" in mesh:
            balls = ", ".join(
                f"{{ at = {ball['at']}, radius = {ball['radius']}, size = {ball['size'] * (order + 1) / (2 * order)} }}"
                for ball in mesh["refine"]
            )
            sets.append(f"bodies.{name}.refine=[{balls}]")
    sets += [f"modes.basis={found['basis']}"]
    sets += ["modes.flexibility_error=1e-2"] if found["basis"] == "contact" else []
    sets += [f"modes.up_to_hz={2 * found['up_to_hz']}"]
    if "zone" in found:
        sets.append(f"contact.zone={1.25 * found['zone']}")
    return sets


def run_programs(scene, sets, out, ranks):
    arguments = ["--out", out, "--quiet"] + [word for setting in sets for word in ("--set", setting)]
    start = time.monotonic()
    programs.kernel(scene, arguments, ranks)
    programs.contact(scene, arguments)
    return time.monotonic() - start


def true_error(found, truth, speed):
    """Largest error of impulse and rebound, as docs/theory/accuracy.md defines them."""
    errors = [abs(found["impulse_ns"] / truth["impulse_ns"] - 1)]
    moved = [
        np.subtract(found["exit_velocity"][b], truth["exit_velocity"][b]) for b in truth["exit_velocity"]
    ]
    return max(*errors, float(np.linalg.norm(np.concatenate(moved))) / speed)


@contextlib.contextmanager
def limited(seconds):
    """Raises RicochetError after a time."""

    def end(*_):
        raise RicochetError(f"takes longer than {seconds:g} s")

    signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


def judged(number, given):
    """A scene's time, true error, estimate, accuracy, whether all shares are known, and warnings; no value if
    nothing touches or contact does not end."""
    folder = given.out / str(number)
    folder.mkdir(parents=True, exist_ok=True)
    scene, speed, accuracy = write_scene(folder, number, np.random.default_rng([given.seed, number]))
    result = folder / "judged.json"
    if not result.exists():
        out = folder / "out"
        seconds = run_programs(scene, [f"accuracy={accuracy}"], out, given.ranks)
        found = json.loads((out / f"random-{number}.summary.json").read_text())
        if not found["exit_velocity"] or not found["error_estimate"]:
            result.write_text("null")
            return None
        (settings,) = out.glob("*.settings.toml")
        chosen = tomllib.loads(settings.read_text())
        rate = f"time.rate_hz={4 * chosen['rate_hz']}"
        run_programs(scene, [*reference_sets(chosen), rate], out, given.ranks)
        truth = json.loads((out / "reference.summary.json").read_text())
        estimate = found["error_estimate"]
        row = {
            "seconds": seconds,
            "error": true_error(found, truth, speed),
            "estimate": estimate["total"],
            "accuracy": accuracy,
            "known": None not in estimate.values(),
            "warnings": found["warnings"],
        }
        result.write_text(json.dumps(row, indent=1))
    return json.loads(result.read_text())


def add_arguments(parser):
    parser.add_argument("--count", type=int, default=40, help="number of scenes (default: 40)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the generator (default: 1)")
    parser.add_argument("--only", nargs="+", type=int, metavar="K", help="these scenes alone, by number")
    parser.add_argument("--limit", type=float, default=150, help="time for one scene [s] (default: 150)")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "random", help="(default: out/random)")
    parser.add_argument("--ranks", type=int, default=2, help="ranks of ricochet-kernel (default: 2)")


def run(given):
    print("| scene | seconds | accuracy | true error | estimate | true / estimate | warnings |")
    print("|---|---|---|---|---|---|---|")
    rows = []
    for number in given.only or range(given.count):
        try:
            with limited(given.limit):
                row = judged(number, given)
        except RicochetError as failure:
            print(f"| {number} | – | – | – | – | – | {failure} |", flush=True)
            continue
        if row is None:
            print(f"| {number} | – | – | – | – | – | contact does not end |", flush=True)
            continue
        rows.append(row)
        cells = [f"{row['seconds']:.1f}", f"{row['accuracy']:g}", f"{row['error']:.1e}"]
        cells += [f"{row['estimate']:.1e}" if row["known"] else f"{row['estimate']:.1e}, a share is unknown"]
        cells += [f"{row['error'] / row['estimate']:.2f}", str(len(row["warnings"]))]
        print(f"| {number} | " + " | ".join(cells) + " |", flush=True)
    known = [row for row in rows if row["known"]]
    claimed = [row for row in known if row["estimate"] <= row["accuracy"]]
    held = sum(row["error"] <= 3 * row["estimate"] for row in known)
    close = sum(row["estimate"] <= 10 * row["error"] for row in known)
    met = sum(row["error"] <= row["accuracy"] for row in claimed)
    wrong = [row for row in rows if row["error"] > max(3 * row["estimate"], row["accuracy"])]
    silent = sum(not row["warnings"] for row in wrong)
    print(
        f"\nTrue error at most 3 estimates: {held} of {len(known)}; estimate at most 10 true errors: ", end=""
    )
    print(
        f"{close} of {len(known)}; accuracy reported and met: {met} of {len(claimed)}; silently wrong: {silent}."
    )
    enough = held >= 0.95 * len(known) and met >= 0.95 * len(claimed) and close >= 0.8 * len(known)
    return not (enough and not silent)
