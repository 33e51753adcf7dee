# SPDX-License-Identifier: BSD-2-Clause
"""A rod (L = 10, E = ρ = A = 1, so that the wave speed and the impedance Z are 1) touches a rigid wall with its right end. Its left end
is a support that moves at v = 0.01 from t = 0. The wave reaches the wall at t = 10 and presses it with 2Zv. The support, whose motion
is prescribed, sends the wave back, and each return at t = 30, 50, … adds 2Zv. The force on the support is Zv at first, and 2Zv more
after each return to it, at t = 20, 40, …

If the support moves by d and stays, and damping brings the rod to rest, the force is EAd/L. Five modes suffice, because the static parts
of the others, at the wall and under the motion of the support, make rest exact."""
import numpy as np

import scenes
from case import BLUE, GREY

TITLE = "A rod between a moving support and a wall"
SOURCE = "d'Alembert's solution, in closed form."
RESTS_ON = "theory"
LONG = False
LENGTH, SPEED, DURATION = 10.0, 0.01, 48.0
HELD = 40.0  # time at which the support stops in the second run (s)

SCENE = scenes.scene(
    {
        "rod": f"""
mesh = "rod.geo"
order = 3
translate = [{-LENGTH}, 0, 0]
material = {{ density = 1.0, young = 1.0, area = 1.0 }}
contact = "right"
support = {{ left = "x" }}
"""
    },
    modes="count = 100",
    contact="direction = [1, 0, 0]",
    time=f"rate_hz = 50\nduration = {DURATION}",
    obstacles={"wall": "normal = [-1, 0, 0]"},
    more=f"""
[[loads.motion]]
body = "rod"
group = "left"
vector = [{SPEED}, 0, 0]
history = "ramp.csv"
""",
)


def run(bench):
    bench.write("rod.geo", scenes.rod(LENGTH, 100))
    bench.write("ramp.csv", f"t, factor\n0, 0\n{2 * DURATION}, {2 * DURATION}\n")
    scene = bench.write("rod.toml", SCENE)
    result = bench.impact(scene)
    time, force = result.time, result.total_force
    ripple = "the ripple of truncation averages out"
    for start, end, level in ((12, 28, 2), (32, 48, 4)):
        bench.compare(
            f"mean force on the wall, t = {start} … {end} (N)",
            force[(time >= start) & (time <= end)].mean(),
            level * SPEED,
            5e-3,
            ripple,
        )
    for level, expected in ((1, 10.0), (3, 30.0)):
        passed = time[np.argmax(force > level * SPEED)]  # 0 if it never does
        bench.compare(
            f"the force passes {level} Zv at (s)",
            passed,
            expected,
            0.1,
            "half a period of the highest mode: a truncated wave front is that steep",
            absolute=True,
        )
    bench.compare(
        "impulse on the wall (N s)",
        result.summary["impulse_ns"],
        SPEED * (2 * 20 + 4 * 18),
        5e-3,
        "the same, and the rounded front",
    )
    support = result.bodies["rod"].reaction[:, 0]
    for start, end, level in ((2, 18, 1), (22, 38, 3)):
        bench.compare(
            f"mean force on the support, t = {start} … {end} (N)",
            support[(time >= start) & (time <= end)].mean(),
            level * SPEED,
            0.01,
            ripple,
        )
    bench.write("held.csv", f"t, factor\n0, 0\n{HELD}, {HELD}\n{20 * HELD}, {HELD}\n")
    few = ("modes.count=5", "bodies.rod.damping={ratio=0.3}", "loads.motion[0].history=held.csv")
    at_rest = bench.impact(scene, *few, "time.duration=200")
    exact = "five modes with the static parts of the others are exact at rest; what is left has decayed"
    bench.compare(
        "force on the wall at rest, 5 modes (N)", at_rest.total_force[-1], SPEED * HELD / LENGTH, 1e-5, exact
    )
    bench.below(
        "drift of the energy ledger",
        result.summary["energy_drift"],
        1e-9,
        "round-off of the steps",
        rests_on="construction",
    )

    figure, ax = bench.figure()
    ax.plot(time, force, color=BLUE, label="wall")
    ax.plot(
        time,
        SPEED * 2 * np.floor((time + LENGTH) / (2 * LENGTH)),
        color=GREY,
        linestyle="--",
        label="d'Alembert",
    )
    ax.set(xlabel="time (s)", ylabel="force (N)", title="A rod pushed against a wall by its support")
    ax.legend()
    bench.save(figure, "Force on the wall and d'Alembert's solution")
