# SPDX-License-Identifier: BSD-2-Clause
"""A short steel rod hits a long one of the same section end on. In Saint-Venant's theory the ends are flat and touch at once:
contact lasts until the echo of the short rod, 2L₁/c, which then rests; the long one moves on with L₁/L₂ of the speed v,
and 1 − L₁/L₂ of the energy remains in it as vibration. Theory and experiment disagree: Cross measured steel rods that lost
little, and wooden dowels that lost another fraction (Eur. J. Phys. 2021, doi 10.1088/1361-6404/ac25d2; only its abstract
was at hand, without numbers). Real ends are not flat, so that they touch at a point.

Both kinds of ends are computed here: rods with flat ends, and solid round rods of 12 mm with spherical ends of 40 mm
radius, at 0.1 m/s. The reference for the latter is Hertz's law between the two points, with the longitudinal modes of thin
rods. The contact then lasts three to four times as long as 2L₁/c, waves cross the rods meanwhile, and less energy remains
in vibrations, which is the direction of Cross's result; his rods are not modelled. The theory neglects that the end of a
round rod is stiffer than a half-space."""
import numpy as np

import modal_hertz
from case import BLUE, GREY, ORANGE

TITLE = "Rods of unequal length: flat and rounded ends"
SOURCE = "Saint-Venant's solution as in Goldsmith 1960, *Impact*, chapter 3, and Hertz's law with the modes of thin rods, integrated in the case."
RESTS_ON = "theory"
LONG = False
YOUNG, POISSON, DENSITY = 210e9, 0.3, 7850.0
RADIUS, CURVATURE, SPEED, SHORT = 6e-3, 0.04, 0.1, 0.1
RATIOS = (0.5, 0.25)
QUARTERS = 4
TRUNCATED = "the front passes in a step of 0.1 µs, and each rod has modes up to 2 MHz"
LOCAL = "the end of a rod is stiffer than a half-space by about a/r = 0.045, the radius of the contact over that of the rod"
AREA, WAVE = np.pi * RADIUS**2, np.sqrt(YOUNG / DENSITY)

LINE = """DefineConstant[length = 1, elements = 20];
Point(1) = {0, 0, 0}; Point(2) = {length, 0, 0}; Line(1) = {1, 2}; Transfinite Curve{1} = elements + 1;
Physical Curve("rod") = {1}; Physical Point("start") = {1}; Physical Point("end") = {2};
"""
GEO = f"""// A quarter of a round rod along z, x ≥ 0 and y ≥ 0, with a spherical end about the origin.
DefineConstant[length = 0.1, reach = 4e-4, size = 9e-5, largest = 3e-3];
SetFactory("OpenCASCADE");
radius = {RADIUS}; curvature = {CURVATURE};
rim = curvature - Sqrt(curvature^2 - radius^2); edge = curvature - Sqrt(curvature^2 - reach^2);
Point(1) = {{0, 0, 0}}; Point(2) = {{reach, 0, edge}}; Point(3) = {{radius, 0, rim}};
Point(4) = {{radius, 0, length}}; Point(5) = {{0, 0, length}}; Point(6) = {{0, 0, curvature}};
Circle(1) = {{1, 6, 2}}; Circle(2) = {{2, 6, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 5}}; Line(5) = {{5, 1}};
Curve Loop(1) = {{1:5}};
Plane Surface(1) = {{1}};
rod[] = Extrude {{{{0, 0, 1}}, {{0, 0, 0}}, Pi / 2}} {{ Surface{{1}}; }};
d = 1e-6;
Physical Volume("rod") = {{rod[1]}};
Physical Surface("y plane") = {{1}};
Physical Surface("x plane") = Surface In BoundingBox{{-d, -d, -d, d, 1, 1}};
Physical Surface("cap") = Surface In BoundingBox{{-d, -d, -d, reach + d, reach + d, edge + d}};
Field[1] = Distance;
Field[1].PointsList = {{1}};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = size;
Field[2].SizeMax = largest;
Field[2].DistMin = reach;
Field[2].DistMax = reach + (largest - size) / 0.4;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
"""
SUPPORT = 'support = { "x plane" = "x", "y plane" = "y" }'


def flat(long):
    """Rods along x, whose material has the wave speed of the solid ones."""
    material = f"{{ density = {DENSITY}, young = {YOUNG}, area = {AREA} }}"
    return f"""[bodies.short]
mesh = "line.geo"
geometry = {{ length = {SHORT}, elements = 40 }}
order = 5
translate = [{-SHORT}, 0, 0]
material = {material}
velocity = [{SPEED}, 0, 0]
contact = "end"
[bodies.long]
mesh = "line.geo"
geometry = {{ length = {long}, elements = {40 * long / SHORT:.0f} }}
order = 5
material = {material}
contact = "start"
[modes]
up_to_hz = 2e6
[contact]
between = ["short", "long"]
direction = [1, 0, 0]
[time]
rate_hz = 1e7
duration = {3 * SHORT / WAVE}
"""


def rounded(long):
    """Solid rods along z, the short one above."""
    material = f"{{ density = {DENSITY}, young = {YOUNG}, poisson = {POISSON} }}"
    return f"""[bodies.short]
mesh = "rod.geo"
geometry = {{ length = {SHORT} }}
order = 2
material = {material}
velocity = [0, 0, {-SPEED}]
contact = "cap"
{SUPPORT}
[bodies.long]
mesh = "rod.geo"
geometry = {{ length = {long} }}
order = 2
rotate_deg = [180, 0, 90]
material = {material}
contact = "cap"
{SUPPORT}
[modes]
up_to_hz = 150e3
[contact]
between = ["short", "long"]
direction = [0, 0, -1]
[time]
rate_hz = 4e6
duration = 3e-4
"""


def lost(short, long, ratio):
    """Fraction of the energy that is not in the mean motion, from the final speeds over that of the impact."""
    return 1 - short**2 - long**2 / ratio


def theory(long):
    """Times [s], force [N], and the final speeds of both rods over that of the impact."""
    omega, shape, rate, masses = [], [], [], []
    for sign, length in ((1, SHORT), (-1, long)):
        mass = DENSITY * AREA * length
        n = np.arange(1, 1 + int(60 * length / SHORT))
        omega += [0, *(np.pi * n * WAVE / length)]
        shape += [sign / np.sqrt(mass), *(sign * np.sqrt(2 / mass) * np.ones(len(n)))]
        rate += [SPEED * np.sqrt(mass) if sign > 0 else 0, *np.zeros(len(n))]
        masses.append(mass)
    stiffness = 2 / 3 * YOUNG / (1 - POISSON**2) * np.sqrt(CURVATURE / 2)
    omega = np.array(omega)
    time, force, rate, _ = modal_hertz.impact(omega, np.array(shape), np.array(rate), stiffness, 2e-8, 3e-4)
    return time, force, rate[omega == 0] / np.sqrt(masses) / SPEED


def speeds(result):
    """Final speeds of both rods along the motion, over that of the impact."""
    return [np.abs(result.summary["exit_velocity"][name]).max() / SPEED for name in ("short", "long")]


def run(bench):
    bench.write("line.geo", LINE)
    bench.write("rod.geo", GEO)
    figure, (left, right) = bench.figure(2)
    rows = []
    for ratio, colour in zip(RATIOS, (BLUE, ORANGE)):
        name, long, echo = f"L₁/L₂ = {ratio:g}", SHORT / ratio, 2 * SHORT / WAVE
        result = bench.impact(bench.write("flat.toml", flat(long)))
        end, (rest, moved) = result.summary["contact_end_s"], speeds(result)
        bench.compare(f"{name}, flat ends: duration of contact (µs)", 1e6 * end, 1e6 * echo, 0.01, TRUNCATED)
        bench.below(f"{name}, flat ends: speed of the short rod / v", rest, 2e-3, TRUNCATED)
        bench.compare(f"{name}, flat ends: speed of the long rod / v", moved, ratio, 2e-3, TRUNCATED)
        flat_loss = lost(rest, moved, ratio)
        bench.compare(f"{name}, flat ends: energy in vibrations", flat_loss, 1 - ratio, 4e-3, TRUNCATED)

        result = bench.impact(bench.write("rounded.toml", rounded(long)))
        ours = speeds(result)
        ideal_time, ideal_force, ideal = theory(long)
        ((start, end, peak),) = modal_hertz.episodes(ideal_time, ideal_force)
        bench.compare(f"{name}, rounded: times of contact", len(result.summary["episodes"]), 1, 0, "a count")
        bench.compare(
            f"{name}, rounded: duration of contact (µs)",
            1e6 * (result.summary["contact_end_s"] - result.summary["contact_start_s"]),
            1e6 * (end - start),
            0.03,
            LOCAL,
        )
        bench.compare(
            f"{name}, rounded: peak force (N)", QUARTERS * result.summary["peak_force_n"], peak, 0.03, LOCAL
        )
        for rod, one, other in zip(("short", "long"), ours, np.abs(ideal)):
            bench.compare(
                f"{name}, rounded: speed of the {rod} rod / v", one, other, 0.015, LOCAL, absolute=True
            )
        loss, ideal_loss = lost(*ours, ratio), lost(*ideal, ratio)
        bench.compare(f"{name}, rounded: energy in vibrations", loss, ideal_loss, 0.02, LOCAL, absolute=True)
        rows.append([f"{ratio:g}", *(f"{x:.4f}" for x in (1 - ratio, flat_loss, ideal_loss, loss))])
        time, force = result.time, result.total_force
        left.plot(1e6 * time, QUARTERS * force, color=colour, label=f"{name}, rounded")
        left.plot(1e6 * ideal_time, ideal_force, color="black", linestyle="--", linewidth=0.9)
        right.plot(ratio, flat_loss, "s", color=GREY)
        right.plot(ratio, loss, "o", color=colour)
    bench.table(
        ["L₁/L₂", "Saint-Venant", "flat ends, ours", "rounded ends, theory", "rounded ends, ours"], rows
    )
    grid = np.linspace(0.2, 1, 2)
    right.plot(grid, 1 - grid, color=GREY, linewidth=0.9, label="Saint-Venant; squares: flat ends, ours")
    left.axvspan(0, 1e6 * echo, color=GREY, alpha=0.2, linewidth=0, label="contact of flat ends")
    left.set(
        xlabel="time (µs)", ylabel="force (N)", xlim=(0, 200), ylim=(0, None), title="Force; dashed: theory"
    )
    right.set(
        xlabel="L₁/L₂", ylabel="fraction of the energy", ylim=(-0.03, 0.9), title="In vibrations afterwards"
    )
    left.legend()
    right.legend()
    bench.save(figure, "A short rod hits a long one: flat ends, and rounded ends (dots)")
