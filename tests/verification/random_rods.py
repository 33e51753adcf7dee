# SPDX-License-Identifier: BSD-2-Clause
"""Accuracy of impacts of pairs of rods drawn at random, compared with d'Alembert's waves.

    scripts/verify --rods [--count N] [--seed S] [--accuracy X …] [--only K …] [--out DIR] [--check]

Lengths, areas and materials of both rods are drawn; the second one may be clamped. Each pair is computed on elements
whose number the geometry fixes (`Transfinite`) and on free ones, with each accuracy. Ricochet chooses all settings. The
reference follows the jumps of the waves along their characteristics, without a mesh. Scenes and results are kept in DIR
(default out/rods) and are not computed again. A run claims its accuracy if no share is unknown, the estimate is at most the
accuracy, and no warning contradicts. With --check the status is 1 if more than 2 % of the claims are wrong, or the median error does not fall with the
accuracy. Prints Markdown.
"""
import json
import statistics
import time
from pathlib import Path

import numpy as np

from ricochet import programs
from ricochet.errors import RicochetError
from ricochet.programs import ROOT
from true_errors import knows_shares, true_error

GEO = """Point(1) = {{0, 0, 0}};
Point(2) = {{{length}, 0, 0}};
Line(1) = {{1, 2}};
{size}
Physical Curve("rod") = {{1}};
Physical Point("left") = {{1}};
Physical Point("right") = {{2}};
"""
SIZES = {
    "transfinite": "Transfinite Curve{{1}} = {elements} + 1;",
    "free": "Mesh.MeshSizeMax = {length} / {elements};",
}
SCENE = """
accuracy = {accuracy}
[bodies.moving]
mesh = "{first}.geo"
translate = [{back}, 0, 0]
material = {{ density = {a.density}, young = {a.young}, area = {a.area} }}
velocity = [{speed}, 0, 0]
contact = "right"
[bodies.struck]
mesh = "{second}.geo"
material = {{ density = {b.density}, young = {b.young}, area = {b.area} }}
contact = "left"
{support}
[contact]
between = ["moving", "struck"]
direction = [1, 0, 0]
[time]
duration = {duration}
"""
ELEMENTS = 24


class Rod:
    def __init__(self, random, near=None):
        self.length = float(f"{10 ** random.uniform(-1.3, 0):.3g}")
        self.density = float(f"{10 ** random.uniform(3, 3.9):.3g}")
        self.young = float(f"{10 ** random.uniform(9, 11.3):.3g}")
        area = 1e-4 if near is None else near.impedance * 10 ** random.uniform(-0.7, 0.7)
        self.area = 1.0
        self.area = float(f"{area if near is None else area / self.impedance:.3g}")

    @property
    def impedance(self):
        return self.area * (self.density * self.young) ** 0.5

    @property
    def mass(self):
        return self.density * self.area * self.length

    @property
    def there_and_back(self):
        return 2 * self.length * (self.density / self.young) ** 0.5


class Signal:
    """A piecewise constant function of time."""

    def __init__(self, value):
        self.times, self.values = [-np.inf], [value]

    def set(self, time, value):
        if value != self.values[-1]:
            self.times.append(time)
            self.values.append(value)

    def at(self, time):
        return self.values[int(np.searchsorted(self.times, time, side="right")) - 1]

    def next_after(self, time):
        k = int(np.searchsorted(self.times, time, side="right"))
        return self.times[k] if k < len(self.times) else np.inf


def waves(a, b, clamped, speed, duration):
    """Rows (time, force, impulse so far), from each instant at which the force changes on. A wave that leaves the contact in a
    rod returns after `there_and_back`, turned round at a free end and unchanged at a clamped one:

        p + Z_a v = A (arrives in a),  p − Z_b v = B (arrives in b),  p ≥ 0 while closed, p = 0 while open
    """
    left, right = Signal(-a.impedance * speed), Signal(0.0)  # p − Z_a v and p + Z_b v at the contact
    time, gap, impulse, rows = 0.0, 0.0, 0.0, []
    tiny = 1e-9 * min(a.there_and_back, b.there_and_back)
    while time < duration:
        arrives_a = -left.at(time - a.there_and_back + tiny / 2)
        arrives_b = (1 if clamped else -1) * right.at(time - b.there_and_back + tiny / 2)
        force = (b.impedance * arrives_a + a.impedance * arrives_b) / (a.impedance + b.impedance)
        closed = gap <= 0 and force > 1e-12 * a.impedance * speed
        if not closed:
            force = 0.0
        va, vb = (arrives_a - force) / a.impedance, (force - arrives_b) / b.impedance
        rows.append((time, force, impulse))
        left.set(time, force - a.impedance * va)
        right.set(time, force + b.impedance * vb)
        upto = min(
            left.next_after(time - a.there_and_back + tiny / 2) + a.there_and_back,
            right.next_after(time - b.there_and_back + tiny / 2) + b.there_and_back,
            duration,
        )
        opening = 0.0 if closed else vb - va
        if opening < 0 and gap > 0:
            upto = min(upto, time + gap / -opening)
        upto = max(upto, time + tiny)
        impulse += force * (upto - time)
        gap = max(0.0, gap + opening * (upto - time))
        gap = 0.0 if gap < 1e-9 * speed * tiny else gap
        time = upto
    return rows


def touches(rows, end):
    """Start, end and impulse at the end of each touch; those that a jump of no duration parts are one."""
    out = []
    for (since, force, _), (after, _, impulse) in zip(rows, rows[1:] + [(end, 0, None)]):
        if force == 0:
            continue
        if out and out[-1][1] == since:
            out[-1] = (out[-1][0], after, impulse)
        else:
            out.append((since, after, impulse))
    return out


def draw(random):
    """A pair, and a duration that ends well after a touch and before the next one."""
    while True:
        a = Rod(random)
        b = Rod(random, a)
        clamped, speed = bool(random.random() < 0.5), float(f"{random.uniform(0.1, 2):.3g}")
        longest = 8 * max(a.there_and_back, b.there_and_back)
        found = touches(waves(a, b, clamped, speed, longest), longest)
        for (_, end, impulse), after in zip(found, found[1:] + [(longest, None, None)]):
            rest = after[0] - end
            if impulse is not None and rest > 0.3 * a.there_and_back and end < 0.8 * longest:
                duration = float(f"{end + min(rest, a.there_and_back) / 2:.6g}")
                return a, b, clamped, speed, duration, impulse
    # Pairs that touch in too short intervals are drawn again.


def run_one(folder, name, kind, drawn, accuracy):
    a, b, clamped, speed, duration, impulse = drawn
    out = folder / f"{name}-{kind}-{accuracy:g}"
    result = out / "result.json"
    if not result.exists():
        out.mkdir(parents=True, exist_ok=True)
        for mesh, rod in (("moving", a), ("struck", b)):
            size = SIZES[kind].format(length=rod.length, elements=ELEMENTS)
            (out / f"{mesh}.geo").write_text(GEO.format(length=rod.length, size=size))
        support = 'support = { right = "xyz" }' if clamped else ""
        scene = out / "rods.toml"
        scene.write_text(
            SCENE.format(
                accuracy=accuracy,
                a=a,
                b=b,
                back=-a.length,
                speed=speed,
                duration=duration,
                first="moving",
                second="struck",
                support=support,
            )
        )
        started = time.monotonic()
        programs.kernel(scene, ["--out", out, "--quiet"], 1)
        programs.contact(scene, ["--out", out, "--quiet"])
        summary = json.loads((out / "rods.summary.json").read_text())
        summary["seconds"] = time.monotonic() - started
        result.write_text(json.dumps(summary))
        for kernel in out.glob("*.h5"):
            kernel.unlink()
    found = json.loads(result.read_text())
    if not found["exit_velocity"]:
        raise RicochetError("the rods still touch at the end")
    velocity = {"moving": {0: speed - impulse / a.mass}}
    if not clamped:
        velocity["struck"] = {0: impulse / b.mass}
    return true_error(found, {"impulse": impulse, "speed": speed, "velocity": velocity}), found


def add_arguments(parser):
    parser.add_argument("--count", type=int, default=40, help="pairs (default: 40)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--accuracy", type=float, nargs="+", default=[1e-1, 1e-2, 3e-3, 1e-3])
    parser.add_argument("--kind", nargs="+", choices=list(SIZES), default=list(SIZES))
    parser.add_argument("--only", type=int, nargs="+", metavar="K", help="numbers of pairs")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "rods", help="(default: out/rods)")
    parser.add_argument("--check", action="store_true", help="fail if claims are wrong")


def run(given):
    random = np.random.default_rng(given.seed)
    pairs = [draw(random) for _ in range(given.count)]
    print(
        "| elements | accuracy | median error | largest | median estimate | claims | wrong | above 3 estimates | s |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    bad = False
    for kind in given.kind:
        medians = []
        for accuracy in sorted(given.accuracy, reverse=True):
            errors, estimates, claims, wrong, above, seconds, failed = [], [], 0, [], 0, 0.0, []
            for number, drawn in enumerate(pairs):
                if given.only and number not in given.only:
                    continue
                try:
                    error, found = run_one(given.out, f"{given.seed}-{number}", kind, drawn, accuracy)
                except RicochetError as failure:
                    failed.append(f"{number} ({failure})")
                    continue
                estimate = found["error_estimate"]
                errors.append(error)
                estimates.append(estimate["total"])
                seconds += found["seconds"]
                warned = any("above accuracy =" in text for text in found["warnings"])
                claimed = estimate["total"] <= accuracy and knows_shares(estimate) and not warned
                claims += claimed
                if claimed and error > accuracy:
                    wrong.append(f"{number}: {error:.1e}")
                above += error > 3 * estimate["total"]
            if not errors:
                continue
            medians.append(statistics.median(errors))
            print(
                f"| {kind} | {accuracy:g} | {medians[-1]:.1e} | {max(errors):.1e} | {statistics.median(estimates):.1e} |"
                f" {claims} of {len(errors)} | {', '.join(wrong) or 0} | {above} | {seconds:.0f} |",
                flush=True,
            )
            for text in failed:
                print(f"failed: {text}", flush=True)
            bad = bad or len(wrong) > 0.02 * max(claims, 1) or bool(failed)
        bad = bad or medians != sorted(medians, reverse=True)
    return given.check and bad
