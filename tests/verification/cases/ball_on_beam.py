# SPDX-License-Identifier: BSD-2-Clause
"""Timoshenko's problem: a steel ball hits the middle of a simply supported steel beam at 10 mm/s. The beam has a square
section of 10 mm and is 153.5 or 307 mm long, and the ball has a radius of 10 or 20 mm. The small ball leaves at once. The
large one, 1.1 times as heavy as the long beam, is met by it twice more as it swings back, so that each part of the force
depends on the bending waves of those before. This is a comparison with theory, not with an experiment: no measured record
of such an impact was at hand as numbers.

The reference is his integral equation: what the ball has moved, less the deflection of the beam, is Hertz's approach
(F/k)^(2/3). The deflection is a sum over modes; here they are those of a beam with shear and rotary inertia (Cowper's
coefficient), to which the ball is coupled step by step, with exact modes between the steps. Ours are solids, a quarter of the
ball and of the beam. Its end faces are held across, like a beam on knife edges at mid-height in theory. The theory neglects
that the beam is not a half-space under the ball, and waves across it."""
from typing import NamedTuple

import numpy as np

import modal_hertz
from case import BLUE, rms
from cases.plate import GEO
from ricochet.programs import ROOT

TITLE = "Timoshenko's ball on a beam"
SOURCE = (
    "Timoshenko 1913, Z. Math. Phys. 62, 198, and Goldsmith 1960, *Impact*, chapter 4: the problem, with the dimensions that are usually "
    "quoted for it. Neither was at hand, so their curves are not compared; the equation is integrated in the case. Cowper 1966, J. Appl. "
    "Mech. 33, 335: the coefficient of shear."
)
RESTS_ON = "theory"
LONG = False
YOUNG, POISSON, DENSITY = 215.8e9, 0.289, 7960.0
SIDE, SPEED = 0.01, 0.01
QUARTERS = 4
LOCAL = (
    "ball and beam are stiffer under the contact than Hertz's half-spaces, by about the radius of the contact over that of the ball, 0.007; "
    "elements of 0.6 times the size change the result by 0.003"
)


class Example(NamedTuple):
    """Radius of the ball, length of the beam, size of the elements of the contact and the radius of their zone [m]; time [s]."""

    radius: float
    length: float
    size: float
    reach: float
    duration: float


EXAMPLES = {
    "small ball": Example(0.01, 0.1535, 2.5e-5, 1.2e-4, 1.5e-3),
    "large ball": Example(0.02, 0.307, 3.5e-5, 1.7e-4, 3.6e-3),
}


def scene(example):
    cap = f"size = {example.size}, reach = {example.reach}"
    material = f"{{ density = {DENSITY}, young = {YOUNG}, poisson = {POISSON} }}"
    return f"""[bodies.ball]
mesh = "{ROOT}/meshes/hertz/ball.geo"
geometry = {{ radius = {example.radius}, {cap} }}
order = 2
translate = [0, 0, {example.radius}]
material = {material}
velocity = [0, 0, {-SPEED}]
contact = "cap"
support = {{ "x plane" = "x", "y plane" = "y" }}
[bodies.beam]
mesh = "plate.geo"
geometry = {{ length = {example.length / 2}, width = {SIDE / 2}, thickness = {SIDE}, largest = 4e-3, {cap} }}
order = 2
material = {material}
contact = "cap"
support = {{ "x plane" = "x", "y plane" = "y", end = "z" }}
[modes]
up_to_hz = 100e3
[[output.gauge]]
name = "foil"
body = "beam"
at_body = [{example.length / 4}, 0, {-SIDE}]
direction = [1, 0, 0]
[contact]
between = ["ball", "beam"]
direction = [0, 0, -1]
[time]
rate_hz = 2e6
duration = {example.duration}
"""


def beam_modes(length, half_waves):
    """Angular frequencies [rad/s] and mass-normalised deflections [kg^-1/2] at mid-span of a simply supported beam, and its strains on the lower face at a quarter of the
    span [kg^-1/2 m^-1]: two modes, of bending and of shear, for each odd number of half waves."""
    area, inertia = SIDE**2, SIDE**4 / 12
    shear = 10 * (1 + POISSON) / (12 + 11 * POISSON) * YOUNG / (2 * (1 + POISSON)) * area
    omega, shape, strain = [], [], []
    for k in np.pi / length * np.arange(1, half_waves + 1, 2):
        stiffness = (
            length
            / 2
            * np.array([[shear * k**2, -shear * k], [-shear * k, YOUNG * inertia * k**2 + shear]])
        )
        root = np.sqrt(length / 2 * DENSITY * np.array([area, inertia]))
        squared, vectors = np.linalg.eigh(stiffness / np.outer(root, root))
        omega += list(np.sqrt(squared))
        shape += list(vectors[0] / root[0])
        # The fibre at half the height has the strain h/2 k ψ sin kx of the rotation ψ cos kx; sin(kl/2) is the sign at mid-span.
        strain += list(SIDE / 2 * k * vectors[1] / root[1] * np.sin(k * length / 4) * np.sin(k * length / 2))
    return np.array(omega), np.array(shape), np.array(strain)


def theory(example, half_waves=61):
    """Times [s], force [N], the final velocity of the ball [m/s], and the strain on the lower face at a quarter of the span."""
    omega, shape, strain = beam_modes(example.length, half_waves)
    mass = DENSITY * 4 / 3 * np.pi * example.radius**3
    stiffness = 2 / 3 * YOUNG / (1 - POISSON**2) * np.sqrt(example.radius)
    rate = np.zeros(1 + len(omega))
    rate[0] = SPEED * np.sqrt(mass)
    time, force, rate, strain = modal_hertz.impact(
        np.append(0, omega),
        np.append(1 / np.sqrt(mass), -shape),
        rate,
        stiffness,
        1e-7,
        example.duration,
        np.append(0, strain),
    )
    return time, force, rate[0] / np.sqrt(mass), strain


def run(bench):
    bench.write("plate.geo", GEO)
    scene_file = bench.folder / "beam.toml"
    figure, axes = bench.figure(2, 2)
    for (name, example), ax, strain_ax in zip(EXAMPLES.items(), *axes):
        scene_file.write_text(scene(example))
        result = bench.impact(scene_file)
        ideal_time, ideal_force, ideal_speed, ideal_strain = theory(example)
        expected = modal_hertz.episodes(ideal_time, ideal_force)
        found = result.summary["episodes"]
        bench.compare(f"{name}: times of contact", len(found), len(expected), 0, "a count")
        for k, (ours, (start, end, peak)) in enumerate(zip(found, expected), 1):
            if k > 1:
                bench.compare(
                    f"{name}: start of contact {k} (µs)",
                    1e6 * ours["start_s"],
                    1e6 * start,
                    0.005,
                    "follows from bending waves: 1 % of Young's modulus changes it by 0.5 %",
                )
            bench.compare(
                f"{name}: duration of contact {k} (µs)",
                1e6 * (ours["end_s"] - ours["start_s"]),
                1e6 * (end - start),
                0.02,
                LOCAL,
            )
            bench.compare(f"{name}: peak force {k} (N)", QUARTERS * ours["peak_force_n"], peak, 0.03, LOCAL)
        bench.compare(
            f"{name}: the ball leaves at (mm/s)",
            1e3 * result.summary["exit_velocity"]["ball"][2],
            -1e3 * ideal_speed,
            0.005,
            "depends on the beam much more than on the contact",
        )
        strain = result.gauges["foil"].strain
        difference = strain - np.interp(result.gauge_time, ideal_time, ideal_strain)
        bench.below(
            f"{name}: strain at a quarter of the span, root mean square of the difference over the largest",
            rms(difference) / np.abs(ideal_strain).max(),
            0.03,
            LOCAL,
        )
        time, force = result.time, result.total_force
        ax.plot(1e6 * time, QUARTERS * force, color=BLUE, linewidth=2, label="ours")
        ax.plot(1e6 * ideal_time, ideal_force, color="black", linewidth=0.9, linestyle="--", label="theory")
        ax.set(
            xlabel="time (µs)",
            ylabel="force (N)",
            xlim=(0, 1.3e6 * expected[-1][1]),
            ylim=(0, None),
            title=f"Ball of {1e3 * example.radius:g} mm, beam of {1e3 * example.length:g} mm",
        )
        ax.legend()
        strain_ax.plot(1e6 * result.gauge_time, 1e6 * strain, color=BLUE, linewidth=2)
        strain_ax.plot(1e6 * ideal_time, 1e6 * ideal_strain, color="black", linewidth=0.9, linestyle="--")
        strain_ax.set(xlabel="time (µs)", ylabel="strain at a quarter of the span (µm/m)")
    bench.save(
        figure,
        "Force between a ball and a beam, strain on the lower face of the beam, and the integral equation",
    )
