# SPDX-License-Identifier: BSD-2-Clause
"""A rigid body of mass m falls from the height h on a rigid floor (a rod with only its rigid mode). The variational problem (7) has a
solution for each energy loss in the impact. Appendix A.1 of the paper names two: (a) the impulse 2 m v₀ at t_c = √(2h/g) without loss,
and (b) the impulse m v₀, followed by the weight. They correspond to `restitution` 1 and 0 of the scheme `impulse`, with event location.

`compliant` is made for bodies that can store energy. This body cannot, so its result lies between (a) and (b) by chance: if the
share s of the step passes before the touch, a rigid body leaves at |1 − 2s| v₀. With adaptive steps, the fall takes one step from
sample to sample, ten times as long as a contact step, and the same must follow."""
import numpy as np

from case import BLUE, GREY, ORANGE

TITLE = "The paper's Figure 9: two answers for a falling mass"
SOURCE = "Bensoam, Appendix A.1 and Figure 9, in closed form."
RESTS_ON = "theory"
LONG = False
MASS, HEIGHT, GRAVITY, RATE = 2.0, 1.0, 9.81, 1000.0

GEO = """Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Line(1) = {1, 2}; Transfinite Curve{1} = 2;
Physical Curve("mass") = {1}; Physical Point("foot") = {1};
"""
SCENE = f"""[bodies.mass]
mesh = "mass.geo"
order = 1
translate = [{HEIGHT}, 0, 0]
material = {{ density = {MASS}, young = 1e3, area = 1.0 }}
contact = "foot"
[obstacles.floor]
normal = [1, 0, 0]
[modes]
count = 1
residual_flexibility = false
[contact]
between = ["mass", "floor"]
direction = [-1, 0, 0]
scheme = "impulse"
instant = "exact"
[time]
rate_hz = {RATE}
duration = 4.0
[loads]
gravity = [{-GRAVITY}, 0, 0]
"""


def height(result):
    """Height of the body above the floor, from its velocity, which is linear within each step except for impulses."""
    time, velocity = result.time, result.bodies["mass"].velocity[:, 0]
    force = result.total_force
    # The impulse of a step acts at its own instant. Before it the body moves with the old velocity.
    step = time[1] - time[0]
    rise, out = HEIGHT, [HEIGHT]
    for k in range(1, len(time)):
        before, after = velocity[k - 1], velocity[k]
        fall = rise + before * step - GRAVITY * step**2 / 2
        if force[k] > 0 and before < 0:
            met = (before + np.sqrt(before**2 + 2 * GRAVITY * max(rise, 0))) / GRAVITY
            rest = step - met
            rise = max((after + GRAVITY * rest) * rest - GRAVITY * rest**2 / 2, 0)
        else:
            rise = fall if force[k] == 0 else 0.0
        out.append(rise)
    return np.array(out)


def missed(episode, instant):
    """Steps between an instant and the step in which the touch begins; 0 if this step contains it."""
    start = episode["start_s"]
    return max(start - instant, instant - start - 1 / RATE, 0) * RATE


def run(bench):
    bench.write("mass.geo", GEO)
    scene = bench.write("mass.toml", SCENE)
    bench.kernel(scene)
    fall, speed = np.sqrt(2 * HEIGHT / GRAVITY), np.sqrt(2 * GRAVITY * HEIGHT)
    elastic = bench.contact(scene, "contact.restitution=1")
    plastic = bench.contact(scene, "contact.restitution=0")
    compliant = bench.contact(
        scene, 'contact={between=["mass","floor"],direction=[-1,0,0],scheme="compliant"}'
    )
    adaptive = bench.contact(
        scene,
        'contact={between=["mass","floor"],direction=[-1,0,0],scheme="compliant"}',
        f"time={{rate_hz={RATE / 10},contact_rate_hz={RATE},duration=4}}",
    )

    instant = "the step of the touch contains the instant"
    bounces = elastic.summary["episodes"]
    times = fall * (1 + 2 * np.arange(len(bounces)))
    bench.compare("(a): bounces within 4 s", len(bounces), np.floor((4.0 / fall + 1) / 2), 0, "a count")
    bench.below(
        "(a): largest deviation of a bounce from t_c (2n + 1), in steps",
        max(map(missed, bounces, times)),
        1e-6,
        instant,
    )
    bench.compare(
        "(a): impulse of the first bounce (N s)",
        bounces[0]["impulse_ns"],
        2 * MASS * speed,
        1e-9,
        "round-off: the instant is exact",
    )
    bench.compare(
        "(a): impulse of the last bounce (N s)",
        bounces[-1]["impulse_ns"],
        2 * MASS * speed,
        1e-8,
        "round-off of all bounces",
    )
    bench.below(
        "(a): share of the energy lost in contact",
        elastic.summary["energy_lost_contact"],
        1e-8,
        "round-off of all bounces",
    )

    time, force = plastic.time, plastic.total_force
    bench.below(
        "(b): deviation of the start of contact from t_c, in steps",
        missed(plastic.summary["episodes"][0], fall),
        1e-6,
        instant,
    )
    row = np.flatnonzero(force)[0]
    bench.compare(
        "(b): impulse of the touch and the rest of its step (N s)",
        force[row] / RATE,
        MASS * speed + MASS * GRAVITY * (time[row] - fall),
        1e-6,
        "round-off; the weight acts from the touch to the end of the step",
    )
    bench.compare(
        "(b): mean force after the touch (N)",
        force[row + 1 :].mean(),
        MASS * GRAVITY,
        1e-4,
        "the weight, as one impulse per step",
    )
    bench.below(
        "(b): speed after the touch (m/s)",
        np.abs(plastic.bodies["mass"].velocity[row + 1 :]).max(),
        1.01 * GRAVITY / RATE,
        "the speed that gravity adds between two impulses",
    )
    bench.compare(
        "(b): share of the energy lost at the touch",
        plastic.energy["contact"][row] / (MASS * GRAVITY * HEIGHT),
        1.0,
        1e-5,
        "all of it, and the work of the weight in the rest of that step",
    )
    share = fall * RATE % 1
    bench.below(
        "compliant, adaptive steps: deviation of the start of contact from t_c, in contact steps",
        missed(adaptive.summary["episodes"][0], fall),
        1e-6,
        instant,
    )
    for name, result in (("compliant", compliant), ("compliant, adaptive steps", adaptive)):
        bench.compare(
            f"{name}: speed after the first touch, over v₀",
            result.summary["episodes"][0]["impulse_ns"] / (MASS * speed) - 1,
            abs(1 - 2 * share),
            2 * GRAVITY / (RATE * speed),
            "the speed that gravity adds in two contact steps",
            absolute=True,
        )
    bench.below(
        "compliant: penetration (m)",
        compliant.summary["max_penetration_m"],
        1e-12,
        "round-off: equality in (2)",
        rests_on="construction",
    )

    figure, axes = bench.figure(2)
    for ax, label, index in zip(axes, ("height (m)", "velocity (m/s)"), (0, 1)):
        for result, colour, name in (
            (elastic, BLUE, "(a) restitution 1"),
            (plastic, ORANGE, "(b) restitution 0"),
        ):
            values = height(result) if index == 0 else result.bodies["mass"].velocity[:, 0]
            ax.plot(result.time, values, color=colour, label=name)
        for touch in times:
            ax.axvline(touch, color=GREY, linestyle=":", linewidth=0.8)
        ax.set(xlabel="time (s)", ylabel=label, title=label.split(" (")[0].capitalize())
    axes[0].set_ylim(0, 1.35)
    axes[0].legend(loc="upper left", ncols=2)
    bench.save(
        figure, "Figure 9: (a) energy is conserved, (b) it is lost at the first contact; dotted: t_c (2n + 1)"
    )
