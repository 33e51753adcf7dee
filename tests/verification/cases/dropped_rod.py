# SPDX-License-Identifier: BSD-2-Clause
"""A steel rod, 12.7 mm square and 200 mm long, arrives at a rigid floor with a corner first, without spin, gravity, friction or
vibration: of its modes it keeps the six rigid ones, and the flexibility of its elements is the only spring. As it becomes
stiffer, it leaves like a rigid body without loss. With the arm r of the corner from the centre and the impulse P along the
normal n,

    v⁺ = v + P n/m,   ω⁺ = J⁻¹ (r × n) P,   P = −2 v·n/(1/m + (r × n)·J⁻¹ (r × n))

A contact lasts as long as the root of the flexibility, and the rod turns by ω⁺ T/2 meanwhile. The error is therefore of the order
−1/2 in the stiffness."""
import numpy as np

from case import BLUE, GREEN, ORANGE, slopes

TITLE = "A rod dropped on a corner, as its stiffness grows"
SOURCE = "Impact of rigid bodies, in closed form."
RESTS_ON = "theory"
LONG = False
LENGTH, SIDE, DENSITY, STEEL = 0.2, 12.7e-3, 7800.0, 2e11
ROLL = 20.0  # degrees about its axis, so that a corner is lowest
ANGLES = (20, 45, 70)  # degrees from the floor
STIFFNESS = (1e-2, 1e-1, 1.0)  # times that of steel
GAP = 1e-6  # m

GEO = f"""SetFactory("OpenCASCADE");
Box(1) = {{0, {-SIDE / 2}, {-SIDE / 2}, {LENGTH}, {SIDE}, {SIDE}}};
Transfinite Curve{{:}} = 2;
Transfinite Curve{{9, 10, 11, 12}} = 9;
Transfinite Surface{{:}};
Recombine Surface{{:}};
Transfinite Volume{{:}};
Physical Volume("rod") = {{1}};
"""
SCENE = """[bodies.rod]
mesh = "rod.geo"
order = 1
contact = "all"
material = {{ density = {density}, young = {young}, poisson = 0.3 }}
rotate_deg = [{roll}, {tilt}, 0]
translate = [0, 0, {height!r}]
velocity = [0, 0, -1]
[obstacles.floor]
normal = [0, 0, 1]
[contact]
between = ["rod", "floor"]
[modes]
count = 6
[motion]
rotation = "finite"
[time]
contact_rate_hz = {rate!r}
duration = {duration!r}
"""


def turn(roll, angle):
    """Rotation by the roll about x, then about y so that the end away from the floor rises by the angle [degrees]."""
    (c, s), (d, t) = ((np.cos(x), np.sin(x)) for x in np.radians([roll, angle]))
    return np.array([[d, 0, -t], [0, 1, 0], [t, 0, d]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def rigid(placed):
    """The height [m] of the lowest corner from the origin, and velocity (3) [m/s] and spin (3) [rad/s] after the impact."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (-1, 1) for z in (-1, 1)]) * [
        LENGTH,
        SIDE / 2,
        SIDE / 2,
    ]
    low = min(corners @ placed.T, key=lambda at: at[2])
    mass = DENSITY * SIDE**2 * LENGTH
    across = mass / 12 * (SIDE**2 + LENGTH**2)
    inertia = placed @ np.diag([mass / 6 * SIDE**2, across, across]) @ placed.T
    lever = np.cross(low - placed @ [LENGTH / 2, 0, 0], [0, 0, 1])
    spin = np.linalg.solve(inertia, lever)
    impulse = 2 / (1 / mass + lever @ spin)
    return low[2], np.array([0, 0, impulse / mass - 1]), impulse * spin


def run(bench):
    bench.write("rod.geo", GEO)
    figure, ax = bench.figure()
    rows = []
    for angle, colour in zip(ANGLES, (BLUE, ORANGE, GREEN)):
        low, velocity, spin = rigid(turn(ROLL, angle))
        apart = []  # by stiffness: velocity and spin · L/2 less those of the rigid rod [m/s]
        for stiffness in STIFFNESS:
            contact = 2e-4 / np.sqrt(stiffness)  # s, longer than the touch
            text = SCENE.format(
                density=DENSITY,
                young=stiffness * STEEL,
                tilt=-angle,
                roll=ROLL,
                height=GAP - low,
                rate=400 / contact,
                duration=GAP + contact,
            )
            result = bench.impact(bench.write("rod.toml", text))
            (touch,) = result.summary["touches"]
            rod = result.bodies["rod"]
            apart.append(np.append(rod.velocity[-1] - velocity, (rod.spin[-1] - spin) * LENGTH / 2))
            duration = 1e6 * (touch["end_s"] - touch["start_s"])
            rows.append([angle, f"{stiffness:g}", f"{duration:.3g}", f"{np.linalg.norm(apart[-1]):.1e}"])
        errors = np.linalg.norm(apart, axis=1)
        bench.order(
            f"{angle}°, error over stiffness", STIFFNESS, errors, -0.5, 0.05, "duration of the contact"
        )
        limit = apart[-1] + (apart[-1] - apart[-2]) / (np.sqrt(STIFFNESS[-1] / STIFFNESS[-2]) - 1)
        bench.below(
            f"{angle}°, limit of the last two: error (m/s)",
            np.linalg.norm(limit),
            1e-3,
            "the square of the turn in a contact, about 0.02",
        )
        slopes(ax, STIFFNESS, errors, f"{angle}°", colour)
    bench.table(
        ["inclination (°)", "stiffness / steel", "contact (µs)", "error of velocity and spin · L/2 (m/s)"],
        rows,
    )
    ax.set(xlabel="stiffness / steel", ylabel="error (m/s)", title="A rod that becomes rigid")
    ax.legend()
    bench.save(figure, "Error of velocity and spin after the impact of a rod against its stiffness")
