# SPDX-License-Identifier: BSD-2-Clause
"""A steel bar, free at both ends or clamped at the right end: its frequencies n c/2L or (2n − 1) c/4L, and the wave that a sudden force on
its left end sends through it. By d'Alembert, the displacement is a sum of ramps that start each time the wave passes. A sum over N
modes with the static part of the others rounds off their kinks by about 1/N."""
import numpy as np

from case import BLUE, GREY, ORANGE, kernel_of

TITLE = "Free and clamped bars: frequencies and waves"
SOURCE = (
    "Closed forms: Graff 1975, *Wave Motion in Elastic Solids*, section 2.3; images of d'Alembert's solution."
)
RESTS_ON = "theory"
LONG = False
DENSITY, YOUNG, AREA, LENGTH, FORCE = 7850.0, 210e9, 1e-4, 1.0, 1000.0
SPEED = np.sqrt(YOUNG / DENSITY)
MODES = 100

GEO = """DefineConstant[elements = 120];
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Line(1) = {1, 2}; Transfinite Curve{1} = elements + 1;
Physical Curve("bar") = {1}; Physical Point("left") = {1}; Physical Point("right") = {2};
"""
SCENE = f"""[bodies.bar]
mesh = "bar.geo"
order = 5
material = {{ density = {DENSITY}, young = {YOUNG}, area = {AREA} }}
contact = "left"
support = {{}}
[obstacles.wall]
point = [-1, 0, 0]
normal = [1, 0, 0]
[modes]
count = {MODES}
[contact]
between = ["bar", "wall"]
direction = [-1, 0, 0]
[time]
rate_hz = 1e6
duration = 1.6e-3
[[loads.traction]]
body = "bar"
group = "left"
vector = [{FORCE / AREA}, 0, 0]
history = "step.csv"
[[output.receiver]]
name = "middle"
body = "bar"
at = [0.4, 0, 0]
[[output.receiver]]
name = "end"
body = "bar"
at = [0, 0, 0]
"""
SUPPORTS = {"free": "{}", "clamped": '{right="x"}'}


def waves(x, time, clamped):
    """Displacement at x after a force from t = 0 on at x = 0: ramps F/Z (t − τ) at the arrivals τ of the wave and its images."""
    total = np.maximum(time - x / SPEED, 0)
    for turn in range(1, 40):
        sign = (-1) ** turn if clamped else 1
        for path in (2 * turn * LENGTH - x, 2 * turn * LENGTH + x):
            total = total + sign * np.maximum(time - path / SPEED, 0)
    return FORCE / (DENSITY * SPEED * AREA) * total


def run(bench):
    bench.write("bar.geo", GEO)
    bench.write("step.csv", "0, 1\n")  # without a history, the force would have acted before
    scene = bench.write("bar.toml", SCENE)
    figure, axes = bench.figure(2)
    for ax, (name, support) in zip(axes, SUPPORTS.items()):
        clamped = name == "clamped"
        result = bench.impact(scene, f"bodies.bar.support={support}")
        with kernel_of(result, "bar") as kernel:
            frequency = kernel["modes/angular_frequency"][:] / (2 * np.pi)
        number = np.arange(MODES)
        exact = (2 * number + 1) * SPEED / (4 * LENGTH) if clamped else number * SPEED / (2 * LENGTH)
        bench.compare(
            f"{name}: rigid modes",
            np.count_nonzero(frequency == 0),
            0 if clamped else 1,
            0,
            "a count",
            absolute=True,
        )
        bench.compare(
            f"{name}: first elastic frequency (Hz)",
            frequency[exact > 0][0],
            exact[exact > 0][0],
            1e-9,
            "round-off of the eigensolver: the square of its residual of 1e-8",
        )
        worst = np.abs(frequency / np.where(exact > 0, exact, 1) - 1)[exact > 0].max()
        bench.below(
            f"{name}: largest relative error of {MODES} frequencies",
            worst,
            1e-6,
            "order 5, 12 nodes per wavelength at the highest mode: (kh)¹⁰",
        )
        time = result.receiver_time
        for receiver, x, colour in (("end", 0.0, BLUE), ("middle", 0.4, ORANGE)):
            ours = result.receivers[receiver].displacement[:, 0]
            theirs = waves(x, time, clamped)
            scale = waves(0.0, np.array([2 * LENGTH / SPEED]), False)[0]
            bench.below(
                f"{name}: largest error at x = {x:g} m, over F/Z · 2L/c",
                np.abs(ours - theirs).max() / scale,
                2 / (np.pi**2 * MODES),
                "tail of Σ 1/n² over the truncated modes, all in phase at a kink: 2/(π²N)",
            )
            ax.plot(time * 1e3, ours * 1e6, color=colour, label=f"x = {x:g} m")
            ax.plot(
                time * 1e3,
                theirs * 1e6,
                color=GREY,
                linestyle="--",
                linewidth=0.9,
                label="d'Alembert" if x else None,
            )
        ax.set(
            xlabel="time (ms)", ylabel="displacement (µm)", title=f"{name}: a force of 1 kN on the left end"
        )
        ax.set_ylim(0, 1.35 * ax.get_ylim()[1])
        ax.legend(loc="upper left", ncols=3)
    bench.save(figure, "Waves in a bar: 100 modes with static parts, and d'Alembert's images")
