# SPDX-License-Identifier: BSD-2-Clause
"""Stoianovici and Hurmuzlu dropped steel bars of six lengths on a massive surface, filmed how they left it, and counted their
contacts by an electric circuit. They report that the restitution of the end varies with the inclination, because of internal
vibration and of several contacts in one drop, and they propose a factor of slenderness for the bars whose restitution does not
vary. This is stated in their abstract. Their figures were not available, so no measured number is compared.

Here, bars of 12.7 mm in diameter arrive at a rigid plane at 1 m/s without spin, at inclinations from 5° (almost flat) to 88°
(almost upright), with μ = 0.2 and a damping ratio of 0.001. The restitution is that of the contact point in the rigid motion,
which a film shows: −v_n after the last contact over v_n before. Contacts are counted until 12 ms or until the other end would
arrive. Only vibration, its damping and friction take energy; local plastic flow is missing.

One drop is several contacts while the bar is inclined, because its vibration presses the end down again, and one contact once it is
steep. The restitution dips at the inclination at which the second contact vanishes, and this inclination grows with the length."""
import numpy as np

from case import BLUE, GREEN, ORANGE

TITLE = "Bars dropped on an end: restitution and contacts against inclination"
SOURCE = "Stoianovici and Hurmuzlu, J. Appl. Mech. 63 (1996) 307, the abstract."
RESTS_ON = "published"
LONG = False
RADIUS, SPEED, GAP = 6.35e-3, 1.0, 2e-6  # m, m/s, m
LENGTHS = (0.1, 0.2, 0.6)  # m
ANGLES = (5, 10, 15, 20, 30, 40, 45, 50, 60, 70, 80, 88)  # degrees
FINER = (5, 45, 70, 88)

GEO = """DefineConstant[ LENGTH = 0.2, RADIUS = 6.35e-3 ];
SetFactory("OpenCASCADE");
Disk(1) = {0, 0, 0, RADIUS};
Rotate {{0, 1, 0}, {0, 0, 0}, Pi/2} { Surface{1}; }
Transfinite Curve{:} = 9;
Extrude {LENGTH, 0, 0} { Surface{1}; Layers{LENGTH / 0.01}; Recombine; }
Physical Volume("bar") = {1};
Physical Surface("end") = {1};
"""
SCENE = """[bodies.bar]
mesh = "bar.geo"
geometry = {{ LENGTH = {length}, RADIUS = {radius} }}
order = 2
contact = "end"
material = {{ density = 7800, young = 2e11, poisson = 0.3 }}
damping = {{ ratio = 1e-3 }}
rotate_deg = [0, {tilt}, 0]
translate = [0, 0, {height!r}]
velocity = [0, 0, {velocity}]
[obstacles.floor]
normal = [0, 0, 1]
[contact]
between = ["bar", "floor"]
friction = 0.2
[modes]
up_to_hz = 6e4
[motion]
rotation = "finite"
[time]
contact_rate_hz = 1e6
duration = {duration!r}
"""


def drop(bench, length, angle, *settings):
    """Restitution, number of contacts, end of the last one [s], and the share of the energy that the rigid motion keeps."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    text = SCENE.format(
        length=length,
        radius=RADIUS,
        tilt=-angle,
        height=RADIUS * c + GAP,
        velocity=-SPEED,
        # The other end arrives at no more than 3 m/s.
        duration=min(0.012, length * s / 3),
    )
    result = bench.impact(bench.write("bar.toml", text), *settings)
    bar, mass = result.bodies["bar"], np.pi * RADIUS**2 * length * 7800
    arm = np.array([-length / 2 * c + RADIUS * s, 0, -length / 2 * s - RADIUS * c])
    touches = result.summary["touches"]
    left = bar.velocity[-1] + np.cross(bar.spin[-1], arm)
    across = mass * (RADIUS**2 / 4 + length**2 / 12)
    kept = mass / 2 * bar.velocity[-1] @ bar.velocity[-1] + across / 2 * bar.spin[-1] @ bar.spin[-1]
    return left[2] / SPEED, len(touches), touches[-1]["end_s"], kept / (mass / 2 * SPEED**2)


def run(bench):
    bench.write("bar.geo", GEO)
    figure, (left, right) = bench.figure(2)
    rows, found = [], {}
    for length, colour in zip(LENGTHS, (GREEN, BLUE, ORANGE)):
        drops = [drop(bench, length, angle) for angle in ANGLES]
        restitution, contacts, _, _ = zip(*drops)
        found[length] = np.array(restitution), np.array(contacts)
        left.plot(ANGLES, restitution, "o-", markersize=4, color=colour, label=f"{1e3 * length:g} mm")
        right.semilogy(ANGLES, contacts, "o-", markersize=4, color=colour, label=f"{1e3 * length:g} mm")
        for angle, (e, count, end, kept) in zip(ANGLES, drops):
            rows.append([f"{1e3 * length:g}", angle, f"{e:.3f}", count, f"{1e3 * end:.2f}", f"{kept:.3f}"])
    for length in LENGTHS:
        restitution, contacts = found[length]
        bench.at_least(f"{1e3 * length:g} mm at 5°: contacts", contacts[0], 2, "several contacts in one drop")
        bench.compare(
            f"{1e3 * length:g} mm at 88°: contacts",
            contacts[-1],
            1,
            0,
            "Saint-Venant: the wave that returns lifts it",
            rests_on="theory",
        )
    longest = np.ptp(found[LENGTHS[-1]][0])
    bench.at_least(
        "600 mm: range of the restitution over the inclinations",
        longest,
        0.2,
        "it depends on the inclination",
    )
    bench.at_least(
        "contacts at 5°: 600 mm less 100 mm",
        found[LENGTHS[-1]][1][0] - found[LENGTHS[0]][1][0],
        1,
        "the period of bending grows with the square of the length",
        rests_on="theory",
    )
    for length in LENGTHS[1:]:
        change = 0.0
        for angle in FINER:
            e, *_ = drop(bench, length, angle, "modes.up_to_hz=12e4", "time.contact_rate_hz=2e6")
            change = max(change, abs(e - found[length][0][ANGLES.index(angle)]))
        bench.below(
            f"{1e3 * length:g} mm: change of the restitution with twice the band and half the step",
            change,
            0.06,
            "a chain of contacts amplifies the change of each",
            rests_on="ourselves",
        )
    bench.table(
        [
            "length (mm)",
            "inclination (°)",
            "restitution",
            "contacts",
            "end of the last (ms)",
            "energy of the rigid motion kept",
        ],
        rows,
    )
    left.set(xlabel="inclination (°)", ylabel="restitution of the end", title="Restitution", ylim=(0, 1))
    right.set(xlabel="inclination (°)", ylabel="contacts", title="Contacts in one drop")
    left.legend()
    right.legend()
    bench.save(
        figure, "Restitution of the end and number of contacts of dropped bars against their inclination"
    )
