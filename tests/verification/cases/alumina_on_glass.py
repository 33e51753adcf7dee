# SPDX-License-Identifier: BSD-2-Clause
"""Kharaz, Gorham and Salman shot alumina balls of 5 mm at 3.85 m/s on a thick anvil of soda-lime glass, at angles θ of 2° to 85°
from the normal, and measured the velocity and the spin of the rebound.

Bodies as built: half of the ball, and half of a block of glass 76 × 76 × 38 mm, free, from whose faces no wave returns during the
contact of 13 µs; the size of the anvil was not at hand. Alumina has E = 380 GPa, ν = 0.23 and 4000 kg/m³, glass 70 GPa, 0.25 and
2500 kg/m³. Friction is the 0.092 that the authors measured where the ball slides throughout. Above θ = 28° the ball slides, so that
the lines there test this friction only; below, they follow from elasticity. Nothing is adjusted.

Neither the paper nor a table of it was at hand, so two digitisations of its figures are used: the tables of MFiX, and those of
Kratos, from the figures of Chung & Ooi. References are from MFiX, above 61° from Kratos. The two differ by at most 0.003 in
restitution, 5.6 rad/s in spin and 0.3° in angle. The scatter of the measurements follows from themselves: a homogeneous ball has
Rω = 5/2 (1 − e_t) v_t, but the measured spin differs from that of the measured restitution e_t.

Displacements and rotations are small in this model; the ball turns by 0.2° during the contact, which shifts the pressure by up to 5 %
of the radius of the contact. A real ball also loses energy in the contact itself, not only to waves."""
import numpy as np

import oblique_impact
from case import BLUE, GREEN, GREY, ORANGE
from rebound import spin
from ricochet.programs import ROOT

TITLE = "Measured: alumina balls on glass, oblique"
SOURCE = (
    "Kharaz, Gorham & Salman 2001, Powder Technol. 120, 281, as digitised in MFiX (`tests/dem/DEM05`) and in Kratos "
    "(`DEMApplication`, `benchmark4_graph*.dat`, from Chung & Ooi 2011, Granular Matter 13, 643)."
)
RESTS_ON = "experiment"
LONG = True
RADIUS, SPEED, FRICTION, NORMAL_RESTITUTION = 2.5e-3, 3.85, 0.092, 0.98

# Angles of the runs [°]: those of the measurements, fewer where the results vary slowly; linear between them.
ANGLES = (
    2.0275,
    3.9282,
    6.0025,
    9.6304,
    10.984,
    20.0845,
    21.1931,
    25.5,
    30.2218,
    39.3031,
    49.5459,
    59.8416,
    79.2277,
    85.1683,
)

# Angle from the normal [°] with the tangential restitution of the centre, v_t'/v_t, or the spin after the impact [rad/s].
RESTITUTION = np.array(
    [
        (2.0275, 0.7938),
        (3.9282, 0.7450),
        (9.6304, 0.6728),
        (20.0845, 0.5964),
        (30.2218, 0.6883),
        (39.3031, 0.7719),
        (49.5459, 0.8469),
        (59.8416, 0.9019),
    ]
)
RESTITUTION_AGAIN = np.array(
    [
        (2.2376, 0.7965),
        (4.2178, 0.7463),
        (9.8416, 0.6755),
        (20.2178, 0.5988),
        (30.3564, 0.6903),
        (39.5446, 0.7743),
        (49.6040, 0.8476),
        (71.0693, 0.9366),
        (79.2277, 0.9695),
        (85.1683, 0.9794),
    ]
)
SPIN = np.array(
    [
        (6.0025, 135.57),
        (10.9840, 264.55),
        (21.1931, 577.01),
        (31.0947, 612.65),
        (39.0283, 595.48),
        (50.2214, 452.94),
        (60.2460, 381.32),
    ]
)
SPIN_AGAIN = np.array(
    [
        (5.8974, 134.86),
        (10.8679, 261.16),
        (21.1243, 573.70),
        (31.1440, 612.23),
        (38.9546, 595.11),
        (50.2367, 449.54),
        (60.0986, 375.69),
        (69.9606, 242.97),
        (78.5602, 142.35),
        (84.3195, 70.64),
    ]
)

# A ball with the elasticity of the anvil: the contact of like bodies has no coupling.
LIKE = "bodies.ball.material={density=4000.0,young=70e9,poisson=0.25}"
COUPLING = (
    "below 10° the contact sticks, and ours loses too much tangential velocity, by the coupling of normal and tangential motion of "
    "unlike bodies: a ball with the elasticity of glass has none of it and rebounds closer to the measurements. Whether the real "
    "contact is coupled as strongly is open: the measured spin at 6° and 11° implies more loss than the measured velocities do. The "
    "mesh is not the reason: elements of 24 µm instead of 36 µm give 0.648 at 2°"
)

GEO = """// Half of a block, y ≥ 0, below z = 0; contact about the origin.
DefineConstant[width = 0.038, reach = 3e-4, size = 3.6e-5, largest = 6e-3];
SetFactory("OpenCASCADE");
Box(1) = {-width, 0, -width, 2 * width, width, width};
Point(101) = {0, 0, 0}; Point(102) = {reach, 0, 0}; Point(103) = {0, reach, 0}; Point(104) = {-reach, 0, 0};
Circle(101) = {102, 101, 103}; Circle(102) = {103, 101, 104}; Line(103) = {104, 101}; Line(104) = {101, 102};
Curve Loop(101) = {101:104}; Plane Surface(101) = {101};
BooleanFragments{ Volume{1}; Delete; }{ Surface{101}; Delete; }
d = 1e-6;
Physical Volume("anvil") = {1};
Physical Surface("cap") = Surface In BoundingBox{-reach - d, -d, -d, reach + d, reach + d, d};
Physical Surface("y plane") = Surface In BoundingBox{-width - d, -d, -width - d, width + d, d, d};
pole[] = Point In BoundingBox{-d, -d, -d, d, d, d};
Field[1] = Distance;
Field[1].PointsList = {pole[0]};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = size;
Field[2].SizeMax = largest;
Field[2].DistMin = reach;
Field[2].DistMax = reach + (largest - size) / 0.5;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
"""
SCENE = f"""[bodies.ball]
mesh = "{ROOT}/meshes/oblique/half-ball.geo"
geometry = {{ radius = {RADIUS}, reach = 3e-4, size = 3.6e-5, largest = 8e-4 }}
order = 2
translate = [0, 0, {RADIUS}]
material = {{ density = 4000, young = 380e9, poisson = 0.23 }}
velocity = [0, 0, -{SPEED}]
contact = "cap"
support = {{ "y plane" = "y" }}
[bodies.anvil]
mesh = "anvil.geo"
order = 2
material = {{ density = 2500, young = 70e9, poisson = 0.25 }}
contact = "cap"
support = {{ "y plane" = "y" }}
[modes]
up_to_hz = 200e3
[contact]
between = ["ball", "anvil"]
direction = [0, 0, -1]
friction = {FRICTION}
[time]
rate_hz = 5e6
duration = 2.2e-5
"""


def rebound(bench, scene, degrees, *sets):
    """Normal and tangential restitution and spin [rad/s] of the ball that arrives at this angle."""
    tangential, normal = SPEED * np.sin(np.radians(degrees)), SPEED * np.cos(np.radians(degrees))
    result = bench.contact(scene, f"bodies.ball.velocity=[{tangential!r},0,{-normal!r}]", *sets)
    velocity = result.bodies["ball"].velocity[-1]
    return velocity[2] / normal, velocity[0] / tangential, spin(result, "ball", RADIUS, RADIUS)


def spin_of_restitution(degrees, restitution):
    return 2.5 * (1 - restitution) * SPEED * np.sin(np.radians(degrees)) / RADIUS


def rigid(degrees):
    """Tangential restitution of a rigid ball: it slides throughout or rolls at last."""
    sliding = 1 - FRICTION * (1 + NORMAL_RESTITUTION) / np.tan(np.radians(degrees))
    return np.maximum(sliding, 5 / 7)


def run(bench):
    bench.write("anvil.geo", GEO)
    scene = bench.write("anvil.toml", SCENE)
    bench.kernel(scene, ranks=2)
    restitution = np.vstack([RESTITUTION, RESTITUTION_AGAIN[-3:]])
    spins = np.vstack([SPIN, SPIN_AGAIN[-3:]])
    normal, tangential, turning = np.transpose([rebound(bench, scene, angle) for angle in ANGLES])

    bench.kernel(scene, LIKE, ranks=2)
    like = rebound(bench, scene, ANGLES[0], LIKE)[1]
    theory = oblique_impact.impact(
        0.25, FRICTION, oblique_impact.psi(0.25, FRICTION, np.tan(np.radians(ANGLES[0])), 1)
    )

    from_speed = np.interp(spins[:, 0], *restitution.T)
    from_spin = 1 - spins[:, 1] / spin_of_restitution(spins[:, 0], 0)
    scatter = np.sqrt(np.mean((from_spin - from_speed) ** 2))
    spin_scatter = np.sqrt(np.mean((spins[:, 1] - spin_of_restitution(spins[:, 0], from_speed)) ** 2))
    ours = np.interp(restitution[:, 0], ANGLES, tangential)
    our_spin = np.interp(spins[:, 0], ANGLES, turning)

    bench.compare(
        "normal restitution at 2°",
        normal[0],
        NORMAL_RESTITUTION,
        0.03,
        "the authors' 0.98 at all angles includes losses in the contact; ours are only waves in the anvil",
    )
    bench.below(
        "tangential restitution: root mean square of ours − measured",
        np.sqrt(np.mean((ours - restitution[:, 1]) ** 2)),
        scatter,
        "scatter: root mean square difference of the restitution measured by speed and by spin",
        known=COUPLING,
    )
    bench.compare(
        "θ = 2.0°: the same of a ball with the elasticity of the anvil",
        like,
        1 - float(theory.slowing) / np.tan(np.radians(ANGLES[0])),
        0.03,
        "theory of Maw, Barber and Fawcett for like bodies; five elements across the radius of the contact",
        absolute=True,
        rests_on="theory",
    )
    for (angle, measured), value in zip(restitution, ours):
        bench.compare(
            f"θ = {angle:.1f}°: tangential restitution v_t′/v_t",
            value,
            measured,
            2 * scatter,
            "twice the scatter",
            absolute=True,
            known="as above" if angle < 10 else None,
        )
    bench.below(
        "spin: root mean square of ours − measured (rad/s)",
        np.sqrt(np.mean((our_spin - spins[:, 1]) ** 2)),
        spin_scatter,
        "scatter: root mean square difference of the measured spin and that of the measured restitution",
    )
    for (angle, measured), value in zip(spins, our_spin):
        bench.compare(
            f"θ = {angle:.1f}°: spin (rad/s)",
            value,
            measured,
            2 * spin_scatter,
            "twice the scatter",
            absolute=True,
        )

    figure, (left, right) = bench.figure(2)
    fine = np.linspace(1, 89, 300)
    left.plot(fine, rigid(fine), color=GREY, linestyle="--", linewidth=0.9, label="rigid ball")
    left.plot(ANGLES, tangential, color=BLUE, label="ours")
    left.errorbar(*RESTITUTION.T, yerr=scatter, fmt="o", color=ORANGE, markersize=4, label="measured, MFiX")
    left.plot(*RESTITUTION_AGAIN.T, "x", color=GREEN, markersize=5, label="measured, Kratos")
    right.plot(
        fine,
        spin_of_restitution(fine, rigid(fine)),
        color=GREY,
        linestyle="--",
        linewidth=0.9,
        label="rigid ball",
    )
    right.plot(ANGLES, turning, color=BLUE, label="ours")
    right.errorbar(*SPIN.T, yerr=spin_scatter, fmt="o", color=ORANGE, markersize=4, label="measured, MFiX")
    right.plot(*SPIN_AGAIN.T, "x", color=GREEN, markersize=5, label="measured, Kratos")
    left.set(
        xlabel="angle from the normal θ (°)", ylabel="v_t′/v_t", title="Tangential restitution of the centre"
    )
    right.set(xlabel="angle from the normal θ (°)", ylabel="spin (rad/s)", title="Spin after the impact")
    left.legend(loc="lower right")
    right.legend()
    bench.save(
        figure,
        "Alumina balls of 5 mm on glass at 3.85 m/s, with the scatter of the measurements: two digitisations of the same figures",
    )
