# SPDX-License-Identifier: BSD-2-Clause
"""An elastic bar (L = 10, E = 900, ρ = A = 1, g = 10) falls from h₀ = 5 on a rigid floor. With these numbers the motion is periodic with
period 16/3, in closed form. With c = 30, v₀ = √(2 g h₀) = 10 and the static shortening u_s(x) = −(g/c²)(L x − x²/2), the bar

- falls for 1 s, touches for 2L/c = 2/3 s under the force v₀E/c + ρgc t' = 300 … 500, and leaves with reversed speed, shortened by 2u_s;
- flies for 2v₀/g = 2 s, exactly three periods of its free vibration, and so arrives as it left, shortened by 2u_s;
- touches for 2/3 s under 500 … 300, flies for 2 s without any vibration, and so on.

After each flight the elastic wave must return in phase. Losses and delays of a scheme grow from touch to touch because the motion of the
bar is itself unstable; `bouncing_bar_fine` measures this."""
import numpy as np

import scenes
from case import BLUE, GREY, ORANGE, RED, slopes

TITLE = "The bouncing bar of Doyen, Ern and Piperno"
SOURCE = (
    "Doyen, Ern & Piperno 2011, *Time-integration schemes for the finite element dynamic Signorini problem*, SIAM J. Sci. "
    "Comput. 33, 223; the periodic solution follows from d'Alembert's and is evaluated in the case."
)
RESTS_ON = "theory"
LONG = False
LENGTH, YOUNG, GRAVITY, HEIGHT = 10.0, 900.0, 10.0, 5.0
SPEED, ARRIVAL = np.sqrt(YOUNG), np.sqrt(2 * GRAVITY * HEIGHT)
TOUCH, FLIGHT, FALL = 2 * LENGTH / SPEED, 2 * ARRIVAL / GRAVITY, ARRIVAL / GRAVITY
PERIOD = 2 * (TOUCH + FLIGHT)

GEO = scenes.rod(10, 100, "bar", ("foot", "top"))
SCENE = scenes.scene(
    {
        "bar": f"""
mesh = "bar.geo"
order = 3
translate = [{HEIGHT}, 0, 0]
material = {{ density = 1.0, young = {YOUNG}, area = 1.0 }}
contact = "foot"
"""
    },
    modes="count = 100",
    contact="direction = [-1, 0, 0]",
    time="rate_hz = 3e3\nduration = 27.0",
    obstacles={"floor": "normal = [1, 0, 0]"},
    more=f"""
[loads]
gravity = [{-GRAVITY}, 0, 0]
[[output.receiver]]
name = "foot"
body = "bar"
at = [{HEIGHT}, 0, 0]
""",
)


def exact(time):
    """Height of the foot and the force on it."""
    foot, force = np.zeros_like(time), np.zeros_like(time)
    for i, t in enumerate(time):
        if t < FALL:
            foot[i] = HEIGHT - GRAVITY * t**2 / 2
            continue
        phase = (t - FALL) % PERIOD
        if phase < TOUCH:
            force[i] = ARRIVAL * YOUNG / SPEED + SPEED * GRAVITY * phase
        elif phase < TOUCH + FLIGHT:
            s = phase - TOUCH
            # The bar is released with a shortening of 2u_s. Its foot moves uniformly and with the free
            # vibration of the even image of its shape.
            x = LENGTH - abs((SPEED * s) % (2 * LENGTH) - LENGTH)
            foot[i] = (
                2 * GRAVITY / SPEED**2 * (x**2 / 2 - LENGTH * x) + ARRIVAL * s - GRAVITY * s**2 / 2
            )
        elif phase < 2 * TOUCH + FLIGHT:
            force[i] = ARRIVAL * YOUNG / SPEED + SPEED * GRAVITY * (TOUCH - (phase - TOUCH - FLIGHT))
        else:
            s = phase - 2 * TOUCH - FLIGHT
            foot[i] = ARRIVAL * s - GRAVITY * s**2 / 2
    return foot, force


def run(bench, counts=(25, 50, 100), duration=27.0, bound=0.15):
    bench.write("bar.geo", GEO)
    scene = bench.write("bar.toml", SCENE)
    rows, feet, errors, losses = [], {}, [], []
    for count in counts:
        result = bench.impact(
            scene,
            f"modes={{count={count}}}",
            f"bodies.bar.geometry={{elements={max(counts)}}}",
            f"time.rate_hz={30 * count}",
            f"time.duration={duration}",
        )
        time = result.receiver_time
        foot = HEIGHT + result.receivers["foot"].displacement[:, 0]
        ideal, _ = exact(time)
        lost = result.energy["contact"][-1] / (LENGTH * GRAVITY * HEIGHT)
        errors.append(np.sqrt(((foot - ideal) ** 2).mean()) / HEIGHT)
        losses.append(lost)
        feet[count] = result, time, foot
        episodes = [e for e in result.summary["episodes"] if e["impulse_ns"] > 1]
        rows.append(
            [
                count,
                f"{errors[-1]:.2e}",
                f"{lost:.2e}",
                len(episodes),
                f"{result.summary['max_penetration_m']:.0e}",
            ]
        )
    bench.table(
        [
            "modes",
            "rms error of the foot over h₀, all touches",
            "energy lost over m g h₀",
            "touches",
            "penetration (m)",
        ],
        rows,
    )

    finest, time, foot = feet[counts[-1]]
    ideal, _ = exact(time)
    starts = FALL + np.arange(int(duration)) * (TOUCH + FLIGHT)
    starts = starts[starts < time[-1]]
    touching, force = finest.time, finest.total_force
    bench.compare(
        "impulse of all touches (N s)",
        finest.summary["impulse_ns"],
        len(starts) * LENGTH * (2 * ARRIVAL + GRAVITY * TOUCH),
        2e-2,
        "2 m v₀ and the weight during each touch; some speed is lost",
    )
    for number, start in enumerate(starts[:4]):
        inside = (touching > start + 0.1 * TOUCH) & (touching < start + 0.9 * TOUCH)
        bench.compare(
            f"touch {number + 1}: mean force (N)",
            force[inside].mean(),
            exact(touching[inside])[1].mean(),
            2e-2,
            "modal truncation spreads the front that returns after each flight",
        )
    bench.below(
        "rms error of the foot over h₀",
        errors[-1],
        bound,
        "deviations grow over the ten touches, from about 1/N at the first",
    )
    bench.below(
        "largest penetration (m)",
        finest.summary["max_penetration_m"],
        1e-10,
        "round-off: equality in (2)",
        rests_on="construction",
    )
    bench.below(
        "drift of the energy ledger",
        finest.summary["energy_drift"],
        1e-10,
        "round-off of the steps",
        rests_on="construction",
    )
    bench.order(
        "energy lost over the modes",
        counts,
        losses,
        -1.0,
        0.4,
        "each front costs the kinetic energy of the truncated modes, about 1/N; growing deviations blur the order",
    )

    figure, (left, right) = bench.figure(2)
    for count, colour in ((counts[0], ORANGE), (counts[-1], BLUE)):
        left.plot(feet[count][1], feet[count][2], color=colour, label=f"{count} modes")
    left.plot(time, ideal, color=GREY, linestyle="--", linewidth=0.9, label="closed form")
    left.set(
        xlabel="time (s)", ylabel="height of the foot (m)", title=f"{len(starts)} touches of an elastic bar"
    )
    left.set_ylim(0, 7)
    left.legend(loc="upper left", ncols=3)
    near = (touching > FALL - 0.2) & (touching < FALL + 2 * TOUCH + FLIGHT + 0.2)
    right.plot(touching[near], force[near], color=RED, linewidth=0.7, label=f"{counts[-1]} modes")
    right.plot(
        touching[near],
        exact(touching[near])[1],
        color=GREY,
        linestyle="--",
        linewidth=0.9,
        label="closed form",
    )
    right.set(xlabel="time (s)", ylabel="force (N)", title="Force of the first two touches", ylim=(0, 700))
    right.legend()
    bench.save(figure, "Foot and force of the bouncing bar")
    figure, ax = bench.figure()
    slopes(ax, counts, errors, "foot", BLUE)
    slopes(ax, counts, losses, "energy", RED)
    ax.set(xlabel="modes", ylabel="relative error", title="Error after all bounces")
    ax.legend()
    bench.save(figure, "Bouncing bar: error against the modes kept, Δ = 1/(30 N)", "order")
