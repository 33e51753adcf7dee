# SPDX-License-Identifier: BSD-2-Clause
"""Housner's block, 0.2 m wide and 0.8 m high, is released on one of its lower edges at 0.6 of the angle α at which it would fall
over. Friction keeps it from sliding. It rocks upright and lands on its other edge. If it stays there, the momentum about this
edge is conserved, and its rate changes by the factor

    r = 1 − (3/2) sin² α = 0.9118

A block whose modes are damped bounces on the new edge until it stays. The impulses of all bounces pass through this edge, so the
ratio is r but for the way of the bounces and the width of the deformed edge: r is the limit of a damped and stiff block.

A block without damping bounces two hundred times in a tenth of a second and keeps less of its rocking: what it stores as vibration
feeds the next bounces, and the contact steps take from each. This has no closed form and depends on the step; the table states
the shares.

Housner's block in the figure follows (I + m R²) φ̈ = −m g R sin(α − |φ|) sign φ by small steps, with the factor r at φ = 0.
`tests/contact/floating.cpp` compares the quarter period."""
import numpy as np

from case import BLUE, GREY, ORANGE

TITLE = "Housner's block: damped, and elastic"
SOURCE = "Housner, Bulletin of the Seismological Society of America 53 (1963) 403, in closed form."
RESTS_ON = "theory"
LONG = False
WIDTH, DEPTH, HEIGHT, DENSITY, GRAVITY = 0.2, 0.1, 0.8, 1000.0, 9.81
ALPHA, RADIUS = np.arctan2(WIDTH, HEIGHT), np.hypot(WIDTH, HEIGHT) / 2
START = 0.6 * ALPHA
MASS = DENSITY * WIDTH * DEPTH * HEIGHT
INERTIA = MASS / 3 * RADIUS**2  # about the centre
RATIO = 1 - 1.5 * np.sin(ALPHA) ** 2
ENERGY = MASS * GRAVITY * RADIUS * (np.cos(ALPHA - START) - np.cos(ALPHA))  # J, of the start above upright
DURATION, SETTLED = 1.0, 0.24  # s; the second after the impact
YOUNG = (1e7, 1e8, 1e9)  # Pa
RATE = 44100.0

GEO = f"""SetFactory("OpenCASCADE");
Box(1) = {{{-WIDTH / 2}, {-DEPTH / 2}, 0, {WIDTH}, {DEPTH}, {HEIGHT}}};
Transfinite Curve{{:}} = 2;
Transfinite Curve{{1, 3, 5, 7}} = 3;
Transfinite Surface{{:}};
Recombine Surface{{:}};
Transfinite Volume{{:}};
Physical Volume("block") = {{1}};
"""
# 30 of the 36 modes of its mesh
SCENE = f"""[bodies.block]
mesh = "block.geo"
order = 1
contact = "all"
material = {{ density = {DENSITY}, young = 1e9, poisson = 0.3 }}
damping = {{ ratio = 3 }}
rotate_deg = [0, {np.degrees(START)!r}, 0]
translate = [0, 0, {WIDTH / 2 * np.sin(START) + 1e-7!r}]
[obstacles.floor]
normal = [0, 0, 1]
[contact]
between = ["block", "floor"]
friction = 2
[modes]
count = 30
[motion]
rotation = "finite"
[loads]
gravity = [0, 0, {-GRAVITY}]
[time]
rate_hz = {RATE}
duration = {DURATION}
"""


def tilt(block):
    """Angle (K) [rad] about y, positive at the start."""
    w, x, y, z = block.attitude.T
    return np.arcsin(2 * (w * y - x * z))


def rocking(block):
    """Energy (K) [J] of the rigid motion above that of the upright block at rest."""
    kinetic = MASS / 2 * np.sum(block.velocity**2, axis=1) + INERTIA / 2 * block.spin[:, 1] ** 2
    return kinetic + MASS * GRAVITY * (block.position[:, 2] - HEIGHT / 2)


def housner(time):
    """Tilt [rad] of the block that stays on its edges, at times in equal steps."""
    step, parts = time[1] - time[0], 20
    phi, rate, out = START, 0.0, []
    for _ in time:
        out.append(phi)
        for _ in range(parts):
            rate -= (
                step
                / parts
                * MASS
                * GRAVITY
                * RADIUS
                * np.sin(ALPHA - abs(phi))
                * np.sign(phi)
                / (4 * INERTIA)
            )
            moved = phi + step / parts * rate
            rate *= RATIO if moved * phi < 0 else 1
            phi = moved
    return np.array(out)


def settled(result):
    """The frame at which the damped block has settled on its new edge."""
    return np.argmax(tilt(result.bodies["block"]) < 0) + round(SETTLED * RATE)


def row(result, young, damping):
    """Of the table."""
    block, energy, after = result.bodies["block"], result.energy, settled(result)
    swing = rocking(block)[after]
    rigid = MASS / 2 * np.sum(block.velocity[after] ** 2) + INERTIA / 2 * block.spin[after, 1] ** 2
    vibration = energy["kinetic"][after] - rigid + energy["strain"][after] + energy["residual"][after]
    touches = sum(touch["start_s"] < result.time[after] for touch in result.summary["touches"])
    taken = energy["contact"][after] + energy["friction"][after]
    shares = [f"{share / ENERGY:.3f}" for share in (swing, vibration, taken)]
    return [f"{young:.0e}", damping, f"{np.sqrt(swing / ENERGY):.5f}", touches, *shares]


def run(bench):
    bench.write("block.geo", GEO)
    scene = bench.write("block.toml", SCENE)
    figure, (left, right) = bench.figure(2)
    rows, ratios = [], []
    for young in YOUNG:
        result = bench.impact(scene, f"bodies.block.material.young={young!r}")
        rows.append(row(result, young, 3))
        ratios.append(np.sqrt(rocking(result.bodies["block"])[settled(result)] / ENERGY))
    damped = result
    bench.compare(
        "rate after the impact over that before, damped, 1e9 Pa",
        ratios[-1],
        RATIO,
        5e-4,
        "the deformed edge has a width of R²/E; the bounces take some way",
    )
    bench.below(
        "change of this ratio from 1e8 to 1e9 Pa",
        ratios[-1] - ratios[-2],
        2e-3,
        "the last change bounds the next one",
        rests_on="ourselves",
    )
    elastic = bench.impact(scene, "bodies.block.damping.ratio=0")
    rows.append(row(elastic, YOUNG[-1], 0))
    bench.table(
        [
            "Young's modulus (Pa)",
            "damping ratio",
            "rate after / before",
            "touches until then",
            "energy / start: rocking",
            "vibration",
            "taken by the contact steps and friction",
        ],
        rows,
    )

    time = damped.time
    for result, colour, label in ((elastic, ORANGE, "elastic"), (damped, BLUE, "damped")):
        left.plot(time, np.degrees(tilt(result.bodies["block"])), color=colour, label=label)
        right.plot(time, rocking(result.bodies["block"]) / ENERGY, color=colour, label=label)
    left.plot(time, np.degrees(housner(time)), "--", color=GREY, linewidth=0.9, label="Housner")
    right.axhline(RATIO**2, linestyle="--", color=GREY, linewidth=0.9, label="r²")
    left.set(xlabel="time (s)", ylabel="tilt (°)", title="A rocking block")
    right.set(
        xlabel="time (s)", ylabel="share of the start", title="Energy of the rigid motion", ylim=(0.6, 1.05)
    )
    left.legend()
    right.legend()
    bench.save(figure, "Tilt and rocking energy of Housner's block, damped and elastic")
