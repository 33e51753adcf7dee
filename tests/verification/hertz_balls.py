# SPDX-License-Identifier: BSD-2-Clause
"""Balls on a floor and on each other with default settings, compared with Hertz's impact.

    scripts/verify --balls [--quick | --all] [--out DIR] [--ranks N]

Steel, glass and rubber balls of 2 to 50 mm hit a rigid floor or an equal ball at 0.01 to 5 m/s. A scene gives only
bodies, material, motion and contact. Hertz's quasi-static theory holds where the speed is below a thousandth of that of
a wave in a bar and the contact is small; there, peak force, duration and rebound are within 3 % of his, or a warning
states the figure. The status is 1 otherwise. The equations have no length of their own, so that the diameter changes
nothing but round-off and the mesh: without --all, balls of 10 mm are compared at all speeds, others at one. Results are
kept in DIR (default out/balls) and are not computed again. Prints Markdown.
"""
import itertools
import json
import math
import random
import time
from pathlib import Path

import hertz_theory as hertz
from random_solids import geometry
from ricochet import programs
from ricochet.errors import RicochetError
from ricochet.programs import ROOT

MATERIALS = {  # density [kg/m³], Young's modulus [Pa], Poisson's ratio
    "steel": (7850.0, 210e9, 0.3),
    "glass": (2500.0, 70e9, 0.22),
    "rubber": (1100.0, 5e6, 0.45),
}
DIAMETERS = (2e-3, 10e-3, 50e-3)
SPEEDS = (0.01, 0.1, 0.5, 1.0, 5.0)
AT_ALL_SPEEDS, AT_ALL_DIAMETERS = 10e-3, 0.5
CLOSE = 0.03
QUASI_STATIC = 1e-3  # largest ratio of the speed to that of waves
SMALL = 0.1  # largest ratio of the contact radius to that of the ball

BODY = """
[bodies.{name}]
mesh = "ball.geo"
material = {{ density = {density}, young = {young}, poisson = {poisson} }}
translate = [0, 0, {height}]
velocity = [0, 0, {velocity}]
contact = "skin"
"""


class Impact:
    """One ball against a floor, or two equal balls, with Hertz's values."""

    def __init__(self, material, diameter, speed, pair):
        self.density, self.young, self.poisson = MATERIALS[material]
        self.diameter, self.speed, self.pair = diameter, speed, pair
        self.name = f"{material}-{diameter * 1e3:g}-mm-{speed:g}-{'pair' if pair else 'floor'}".replace(
            ".", "p"
        )
        mass = self.density * math.pi * diameter**3 / 6
        modulus, curvature = self.young / (1 - self.poisson**2), diameter / 2
        if pair:
            mass, modulus, curvature = mass / 2, modulus / 2, curvature / 2
        self.duration, self.peak = hertz.impact(mass, speed, modulus, curvature)
        self.holds = (
            speed <= QUASI_STATIC * math.sqrt(self.young / self.density)
            and hertz.radius(self.peak, modulus, curvature) <= SMALL * curvature
        )

    def write(self, folder):
        d, away = self.diameter, 0.02 * self.speed * self.duration
        (folder / "ball.geo").write_text(geometry("ball", x=d, y=d, z=d, size=d / 8))
        text = f'title = "{self.name}"\n'
        values = {"density": self.density, "young": self.young, "poisson": self.poisson}
        text += BODY.format(name="ball", height=away, velocity=-self.speed, **values)
        if self.pair:
            text += BODY.format(name="anvil", height=-d, velocity=0, **values)
        else:
            text += "\n[obstacles.anvil]\nnormal = [0, 0, 1]\n"
        text += f'\n[contact]\nbetween = ["ball", "anvil"]\n\n[time]\nduration = {2.5 * self.duration:.4g}\n'
        text += f"rate_hz = {500 / self.duration:.4g}\n"
        path = folder / f"{self.name}.toml"
        path.write_text(text)
        return path

    def errors(self, summary):
        """Relative errors of peak force and duration, and the error of the coefficient of restitution."""
        start, end = summary["contact_start_s"], summary["contact_end_s"]
        return (
            summary["peak_force_n"] / self.peak - 1,
            (end - start) / self.duration - 1 if end is not None else math.inf,
            (summary["restitution"] if summary["restitution"] is not None else math.inf) - 1,
        )


def judged(impact, given):
    folder = given.out / impact.name
    result = folder / "judged.json"
    if not result.exists():
        folder.mkdir(parents=True, exist_ok=True)
        scene, out, start = impact.write(folder), folder / "out", time.monotonic()
        programs.kernel(scene, ["--quiet", "--out", out], given.ranks)
        programs.contact(scene, ["--quiet", "--out", out])
        summary = json.loads((out / f"{programs.slug(impact.name)}.summary.json").read_text())
        result.write_text(json.dumps([time.monotonic() - start, summary]))
    return json.loads(result.read_text())


def add_arguments(parser):
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--quick", action="store_true", help="steel balls of 20 mm alone, at three speeds")
    group.add_argument("--all", action="store_true", help="each diameter at each speed")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "balls", help="(default: out/balls)")
    parser.add_argument("--ranks", type=int, default=2, help="ranks of ricochet-kernel (default: 2)")


def run(given):
    print("| impact | seconds | peak | duration | rebound | estimate | points | warnings | verdict |")
    print("|---|---|---|---|---|---|---|---|---|")
    verdicts = {"within 3 %": 0, "warned": 0, "beyond the theory": 0, "SILENT": 0, "refused": 0}
    sizes, speeds = ((20e-3,), (0.1, 0.5, 1.0)) if given.quick else (DIAMETERS, SPEEDS)
    materials = ["steel"] if given.quick else MATERIALS
    settings = [
        setting
        for setting in itertools.product(materials, sizes, speeds, (False, True))
        if given.quick or given.all or setting[1] == AT_ALL_SPEEDS or setting[2] == AT_ALL_DIAMETERS
    ]
    random.Random(1).shuffle(settings)  # so that the first of them are typical of all
    for setting in settings:
        impact = Impact(*setting)
        try:
            seconds, summary = judged(impact, given)
        except RicochetError as failure:
            verdicts["refused"] += 1
            print(f"| {impact.name} | – | – | – | – | – | – | – | {failure} |", flush=True)
            continue
        errors, warnings = impact.errors(summary), summary["warnings"]
        if max(map(abs, errors)) <= CLOSE:
            verdict = "within 3 %"
        elif warnings:
            verdict = "warned"
        else:
            verdict = "SILENT" if impact.holds else "beyond the theory"
        verdicts[verdict] += 1
        estimate = (summary["error_estimate"] or {}).get("total", math.nan)
        cells = [f"{seconds:.1f}", *(f"{100 * error:+.1f} %" for error in errors), f"{estimate:.1e}"]
        cells += [f"{summary['max_active']}", f"{len(warnings)}", verdict]
        print(f"| {impact.name} | " + " | ".join(cells) + " |", flush=True)
    print("\n" + ", ".join(f"{count} {verdict}" for verdict, count in verdicts.items()) + ".")
    return verdicts["SILENT"] > 0 or verdicts["refused"] > 0
