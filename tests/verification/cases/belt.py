# SPDX-License-Identifier: BSD-2-Clause
"""A stiff box (m = 0.7 kg) slides on a rigid plane with friction. Its flexibility is far below the distances, so the closed forms of a
rigid body hold: on a belt of speed V it accelerates at μg for V/(μg) and then moves with the belt, which has done the work mV², half of
it as heat; on a plane at rest it stops from V after V²/(2μg). If the coefficient falls with the speed,
μ(v) = μ_d + (μ_s − μ_d) exp(−(v/v_s)²), the distance is ∫ v dv/(μ(v) g). At rest, a push below the limit is held by friction.

Strong damping lays the box on its foot within milliseconds. Meanwhile the force differs from the weight, but its mean does not."""
import numpy as np

import scenes
from boxes import Box
from case import BLUE, GREY, ORANGE

TITLE = "Coulomb's law: a box on a belt, stopping and at rest"
SOURCE = (
    "Newton's and Coulomb's laws, in closed form; the distance with the falling coefficient by quadrature."
)
RESTS_ON = "theory"
LONG = False
GRAVITY, FRICTION, SPEED = 9.81, 0.3, 1.0
SLOW, STRIBECK = 0.15, 0.4  # the coefficient of fast sliding, and the speed of the transition (m/s)
STOP = SPEED / (FRICTION * GRAVITY)

SCENE = scenes.scene(
    {
        "box": """
mesh = "box.msh"
material = { density = 2.0, young = 3e4, poisson = 0.3 }
damping = { ratio = 0.3 }
contact = "foot"
"""
    },
    modes="count = 30",
    contact=f"gap = 1e-6\nfriction = {FRICTION}",
    time="rate_hz = 8000\nduration = 0.5",
    obstacles={"floor": "normal = [0, 0, 1]"},
    more=f"[loads]\ngravity = [0, 0, {-GRAVITY}]\n",
)
PUSH = '[[loads.point]]\nbody = "box"\nat = [0.5, 0.35, 0]\nvector = [{push}, 0, 0]\nhistory = "push.csv"\n'


def falling_distance():
    """∫ v dv/(μ(v) g) from 0 to V."""
    v = np.linspace(0, SPEED, 20001)
    return np.trapz(v / ((SLOW + (FRICTION - SLOW) * np.exp(-((v / STRIBECK) ** 2))) * GRAVITY), v)


def run(bench):
    bench.write("box.msh", Box().gmsh())
    scene = bench.write("box.toml", SCENE)
    sags = "the static deflection and the shear of the box, both far below the distance"
    carried = bench.impact(scene, f"obstacles.floor.velocity=[{SPEED},0,0]")
    stopping = bench.contact(scene, f"bodies.box.velocity=[{SPEED},0,0]")
    law = f"{{static={FRICTION},dynamic={SLOW},stribeck_velocity={STRIBECK}}}"
    falling = bench.contact(
        scene, f"bodies.box.velocity=[{SPEED},0,0]", f"contact.friction={law}", "time.duration=0.8"
    )
    mass = carried.bodies["box"].mass

    time, velocity = carried.time, carried.bodies["box"].velocity[:, 0]
    for share in (0.25, 0.5, 0.75):
        bench.compare(
            f"belt: speed after {share:g} V/(μg) (m/s)",
            np.interp(share * STOP, time, velocity),
            share * SPEED,
            0.005,
            sags,
            absolute=True,
        )
    bench.compare("belt: speed at the end (m/s)", velocity[-1], SPEED, 0.005, sags)
    bench.compare(
        "belt: impulse of friction (N s)", carried.summary["friction_impulse_ns"], mass * SPEED, 0.005, sags
    )
    bench.compare("belt: heat (J)", carried.energy["friction"][-1], mass * SPEED**2 / 2, 0.005, sags)
    bench.compare("belt: its work (J)", carried.energy["loads"][-1], mass * SPEED**2, 0.005, sags)
    bench.below(
        "belt: drift of the energy ledger",
        carried.summary["energy_drift"],
        1e-9,
        "round-off of the steps",
        rests_on="construction",
    )

    for name, result, distance in (
        ("stopping", stopping, SPEED**2 / (2 * FRICTION * GRAVITY)),
        ("falling coefficient", falling, falling_distance()),
    ):
        moved = np.trapz(result.bodies["box"].velocity[:, 0], result.time)
        bench.compare(f"{name}: distance (m)", moved, distance, 0.005, sags)
        bench.compare(f"{name}: heat (J)", result.energy["friction"][-1], mass * SPEED**2 / 2, 0.005, sags)

    weight, push = mass * GRAVITY, 0.9 * FRICTION * mass * GRAVITY
    bench.write("push.csv", "t, factor\n0, 0\n1, 1\n")
    pushed = bench.write(
        "pushed.toml",
        SCENE.replace("gap = 1e-6", 'scheme = "static"\ngap = 1e-6') + PUSH.format(push=push),
    )
    bench.kernel(pushed)
    (pair,) = bench.contact(pushed).summary["pairs"]
    why = "round-off, and the tolerance of equilibria with friction"
    bench.compare("at rest: normal force (N)", pair["force_n"], weight, 1e-6, why)
    bench.compare("at rest: friction (N)", pair["friction_n"], push, 1e-6, why)

    figure, ax = bench.figure()
    ax.plot(time, velocity, color=BLUE, label="on the belt")
    ax.plot(time, np.minimum(FRICTION * GRAVITY * time, SPEED), color="black", linestyle="--", linewidth=1)
    ax.plot(stopping.time, stopping.bodies["box"].velocity[:, 0], color=ORANGE, label="stopping")
    ax.plot(
        time, np.maximum(SPEED - FRICTION * GRAVITY * time, 0), color="black", linestyle="--", linewidth=1
    )
    ax.plot(
        falling.time, falling.bodies["box"].velocity[:, 0], color=GREY, label="stopping, coefficient falls"
    )
    ax.set(xlabel="time (s)", ylabel="velocity (m/s)", title="A box on a plane with friction")
    ax.legend()
    bench.save(figure, "Velocity of the box; dashed: rigid box with a constant coefficient")
