# SPDX-License-Identifier: BSD-2-Clause
"""A beam turns about a hinge at one end at 3.8 rad/s and its free end hits an elastic stop (SDNL32 of the French validation
guide VPCS, also a test of Code_Aster). The beam is 783 mm long with a square section of 14 mm, of 67 GPa, 2400 kg/m³ and
ν = 0, and all its bending modes are damped by 1 %. The stop is a spring of 18 or 45 kN/m without mass that can only push.
The published reference is the deflection of the tip for each millisecond, which is a sum of many bending waves.

Ours is a solid beam of twice the length, whose middle is the hinge: it turns about its centre and hits a stop at each end,
on opposite sides, so that the middle neither moves nor has a bending moment. A stop is a soft block with ν = 0, 0.2 mm
wide and 10 mm high, with the stiffness of the spring and 10⁻⁷ of the mass of the beam. Elements are small near the tip,
because the force is spread over the patches that it presses: with patches of 13 mm the tip was wrong by 3 %."""
import numpy as np

from case import BLUE, GREY, ORANGE, rms

TITLE = "A beam on an elastic stop"
SOURCE = (
    "VPCS, the commission of the Société française des mécaniciens that validates programs for structures: SDNL32; its values as in "
    "`astest/sdnl32a.comm` and in the manual V5.02.032 of Code_Aster."
)
RESTS_ON = "published"
LONG = False
LENGTH, SIDE, YOUNG, DENSITY, TURNING, DAMPING = 0.783, 0.014, 67e9, 2400.0, 3.8, 0.01
WIDTH, HEIGHT = 2e-4, 10e-3

# Deflection of the tip [mm] at 1, 2, … 12 ms, by stiffness of the stop [N/m]
TIP = {
    18e3: (-2.66, -4.33, -4.92, -4.78, -3.82, -2.87, -2.71, -3.09, -3.41, -3.36, -2.64, -0.742),
    45e3: (-2.25, -2.66, -1.96, -1.15, -0.124, -0.364, -2.01, -2.74, -1.89, -0.352, 1.70, 4.99),
}

GEO = """// A box with the lower corner (x, y, −side/2).
DefineConstant[x = 0, y = 0, length = 1, height = 1, side = 1, along = 1, bump = 1];
Point(1) = {x, y, -side / 2}; Point(2) = {x + length, y, -side / 2};
Point(3) = {x + length, y + height, -side / 2}; Point(4) = {x, y + height, -side / 2};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = along + 1 Using Bump bump; Transfinite Curve{2, 4} = 2; Transfinite Surface{1}; Recombine Surface{1};
box[] = Extrude {0, 0, side} { Surface{1}; Layers{1}; Recombine; };
Physical Volume("box") = {box[1]};
Physical Surface("bottom") = {box[2]};
Physical Surface("top") = {box[4]};
"""


def stop(name, x, y, stiffness, inner):
    """A block at (x, y) that is held on the surface away from the beam."""
    return f"""[bodies.{name}]
mesh = "box.geo"
geometry = {{ x = {x}, y = {y}, length = {WIDTH}, height = {HEIGHT}, side = {SIDE} }}
order = 1
material = {{ density = 1, young = {stiffness * HEIGHT / (WIDTH * SIDE)}, poisson = 0.0 }}
contact = "{inner}"
support = {{ {"bottom" if inner == "top" else "top"} = "xyz" }}
"""


def scene(stiffness):
    return (
        f"""[bodies.beam]
mesh = "box.geo"
geometry = {{ x = {-LENGTH}, y = {-SIDE / 2}, length = {2 * LENGTH}, height = {SIDE}, side = {SIDE}, along = 60, bump = 0.02 }}
order = 3
material = {{ density = {DENSITY}, young = {YOUNG}, poisson = 0.0 }}
damping = {{ ratio = {DAMPING} }}
angular_velocity = [0, 0, {-TURNING}]
contact = ["bottom", "top"]
"""
        + stop("right", LENGTH - WIDTH, -SIDE / 2 - HEIGHT, stiffness, "top")
        + stop("left", -LENGTH, SIDE / 2, stiffness, "bottom")
        + f"""[modes]
up_to_hz = 10e3
[[contact.pair]]
between = ["right", "beam"]
direction = [0, 1, 0]
[[contact.pair]]
between = ["left", "beam"]
direction = [0, -1, 0]
[motion]
rotation = "linear"
[time]
rate_hz = 1e5
duration = 12e-3
[[output.receiver]]
name = "tip"
body = "beam"
at = [{LENGTH}, 0, 0]
"""
    )


def run(bench):
    bench.write("box.geo", GEO)
    figure, ax = bench.figure()
    rows = []
    for (stiffness, published), colour in zip(TIP.items(), (BLUE, ORANGE)):
        name = f"{1e-3 * stiffness:g} kN/m"
        result = bench.impact(bench.write(f"stop-{stiffness:.0f}.toml", scene(stiffness)))
        time, tip = 1e3 * result.time, 1e3 * result.receivers["tip"].displacement[:, 1]
        ours = np.interp(range(1, 13), time, tip)
        bench.below(
            f"{name}: tip, largest difference at 1, 2, … 12 ms (mm)",
            np.abs(ours - published).max(),
            0.05,
            "1 % of the largest deflection. The reference has three digits; the published computation differs from it by 0.033 mm",
        )
        bench.below(
            f"{name}: the same, root mean square (mm)",
            rms(ours - published),
            0.02,
            "twice that of the published computation, 0.01 mm",
        )
        rows += [
            [name, str(k), f"{one:g}", f"{two:.3f}"] for k, (one, two) in enumerate(zip(published, ours), 1)
        ]
        ax.plot(time, tip, color=colour, label=name)
        ax.plot(range(1, 13), published, "o", color=colour, markersize=4)
    bench.table(["stop", "time (ms)", "published (mm)", "ours (mm)"], rows)
    ax.axhline(0, color=GREY, linewidth=0.6)
    ax.set(
        xlabel="time (ms)",
        ylabel="deflection of the tip (mm)",
        title="A beam turns into a stop; dots: published",
    )
    ax.legend()
    bench.save(figure, "Tip of a hinged beam that hits an elastic stop")
