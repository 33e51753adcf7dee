# SPDX-License-Identifier: BSD-2-Clause
"""A steel ball of 10 mm radius falls at 0.3 m/s on steel plates of three thicknesses. The plates are so wide that no wave returns from the
edge before the ball has left, so the ball loses the energy that the bending waves carry away. Zener's plate yields at the speed F/Z
under the ball, Z = 8√(Dρh), and the contact obeys Hertz's law: m ẍ = −F, F = k(x − w)^(3/2), ẇ = F/Z. The restitution depends only on
the inelasticity λ = m/(Z T₀), T₀ = (m/(k√v))^(2/5).

Zener neglects the shear of the plate, the waves across its thickness, many of which pass during the contact, and the part of the
flexibility that is neither that of a half-space nor that of a thin plate."""
import numpy as np

import hertz_theory as hertz
from case import BLUE, GREEN, GREY, ORANGE, RED
from ricochet.programs import ROOT

TITLE = "Zener's inelastic collision: a ball on a thick plate"
SOURCE = "Zener 1941, *The intrinsic inelasticity of large plates*, Phys. Rev. 59, 669; his equation integrated in the case."
RESTS_ON = "theory"
LONG = True
SPEED, THICKNESSES = 0.3, (12e-3, 8e-3, 5e-3)

GEO = """// A quarter of a plate or beam, x ≥ 0 and y ≥ 0, below z = 0; contact about the origin.
DefineConstant[length = 0.14, width = 0.14, thickness = 8e-3, reach = 4.5e-4, size = 1e-4, largest = 9e-3];
SetFactory("OpenCASCADE");
Box(1) = {0, 0, -thickness, length, width, thickness};
Point(101) = {0, 0, 0}; Point(102) = {reach, 0, 0}; Point(103) = {0, reach, 0};
Line(101) = {101, 102}; Circle(102) = {102, 101, 103}; Line(103) = {103, 101};
Curve Loop(101) = {101:103}; Plane Surface(101) = {101};
BooleanFragments{ Volume{1}; Delete; }{ Surface{101}; Delete; }
d = 1e-6;
Physical Volume("plate") = {1};
Physical Surface("cap") = Surface In BoundingBox{-d, -d, -d, reach + d, reach + d, d};
Physical Surface("x plane") = Surface In BoundingBox{-d, -d, -thickness - d, d, width + d, d};
Physical Surface("y plane") = Surface In BoundingBox{-d, -d, -thickness - d, length + d, d, d};
Physical Surface("end") = Surface In BoundingBox{length - d, -d, -thickness - d, length + d, width + d, d};
pole[] = Point In BoundingBox{-d, -d, -d, d, d, d};
Field[1] = Distance;
Field[1].PointsList = {pole[0]};
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
SCENE = f"""[bodies.ball]
mesh = "{ROOT}/meshes/hertz/ball.geo"
geometry = {{ size = 1e-4, reach = 4.5e-4 }}
order = 2
translate = [0, 0, 0.01]
material = {{ density = {hertz.DENSITY}, young = {hertz.YOUNG}, poisson = {hertz.POISSON} }}
velocity = [0, 0, {-SPEED}]
contact = "cap"
support = {{ "x plane" = "x", "y plane" = "y" }}
[bodies.plate]
mesh = "plate.geo"
order = 2
material = {{ density = {hertz.DENSITY}, young = {hertz.YOUNG}, poisson = {hertz.POISSON} }}
contact = "cap"
support = {{ "x plane" = "x", "y plane" = "y" }}
[modes]
up_to_hz = 120e3
[contact]
between = ["ball", "plate"]
direction = [0, 0, -1]
[time]
rate_hz = 4e6
duration = 1.5e-4
"""
MASS = hertz.DENSITY * 4 / 3 * np.pi * hertz.RADIUS**3
STIFFNESS = 4 / 3 * hertz.MODULUS / 2 * np.sqrt(hertz.RADIUS)
UNIT = (MASS / (STIFFNESS * np.sqrt(SPEED))) ** 0.4  # T₀


def inelasticity(thickness):
    bending = hertz.YOUNG * thickness**3 / (12 * (1 - hertz.POISSON**2))
    return MASS / (8 * np.sqrt(bending * hertz.DENSITY * thickness) * UNIT)


def zener(inelastic, steps=4000):
    """Time divided by T₀ and force divided by mv/T₀ during contact, and the restitution, by Heun's method."""
    step, indent, speed = 4.0 / steps, 0.0, 1.0
    time, force = [0.0], [0.0]

    def rates(indent, speed):
        push = max(indent, 0) ** 1.5
        return speed - inelastic * push, -push

    while len(time) < 3 * steps:
        a = rates(indent, speed)
        b = rates(indent + step * a[0], speed + step * a[1])
        indent, speed = indent + step * (a[0] + b[0]) / 2, speed + step * (a[1] + b[1]) / 2
        if indent <= 0:
            break
        time.append(time[-1] + step)
        force.append(indent**1.5)
    return np.array(time), np.array(force), -speed


def run(bench):
    bench.write("plate.geo", GEO)
    scene = bench.write("plate.toml", SCENE)
    figure, (left, right) = bench.figure(2)
    found = []
    for thickness, colour in zip(THICKNESSES, (GREEN, BLUE, ORANGE)):
        result = bench.impact(scene, f"bodies.plate.geometry={{thickness={thickness}}}", ranks=2)
        inelastic, name = inelasticity(thickness), f"{1e3 * thickness:g} mm"
        ideal_time, ideal_force, ideal = zener(inelastic)
        restitution = result.summary["exit_velocity"]["ball"][2] / SPEED
        time, force = result.time, result.total_force
        force *= hertz.QUARTERS
        bench.compare(
            f"{name}: restitution (λ = {inelastic:.3f})",
            restitution,
            ideal,
            0.05,
            "Zener's plate neglects shear and waves across the thickness",
        )
        bench.compare(
            f"{name}: peak force (N)",
            force.max(),
            ideal_force.max() * MASS * SPEED / UNIT,
            0.05,
            "as for the restitution; patches of 0.1 mm",
        )
        bench.compare(
            f"{name}: duration of contact (µs)",
            1e6 * (result.summary["contact_end_s"] - result.summary["contact_start_s"]),
            1e6 * ideal_time[-1] * UNIT,
            0.05,
            "as for the restitution",
        )
        bench.below(
            f"{name}: drift of the energy ledger",
            result.summary["energy_drift"],
            1e-9,
            "round-off of the steps",
            rests_on="construction",
        )
        found.append((inelastic, restitution))
        left.plot(time * 1e6, force, color=colour, label=name)
        left.plot(
            ideal_time * UNIT * 1e6,
            ideal_force * MASS * SPEED / UNIT,
            color=GREY,
            linestyle="--",
            linewidth=0.9,
        )
    left.set(xlabel="time (µs)", ylabel="force (N)", title="Force; dashed: Zener")
    left.legend()
    grid = np.linspace(0, 1, 41)
    right.plot(grid, [zener(x)[2] for x in grid], color=GREY, linestyle="--", linewidth=0.9, label="Zener")
    right.plot(*zip(*found), "o", color=RED, label="ours")
    right.set(xlabel="inelasticity λ", ylabel="restitution", title="Restitution", ylim=(0, 1.02))
    right.legend()
    bench.save(figure, "A ball on plates of 12, 8 and 5 mm")
