# SPDX-License-Identifier: BSD-2-Clause
"""Cases of scripts/verify --extremes that run the programs: materials, schemes, modes and elements. There is a function for each
kind of extreme, which takes a Bench and yields Row(setting, oracle, bound, found). If `found` exceeds `bound` or is not a
number, the case fails."""

import h5py
import numpy as np
from extreme_bench import SAME, Row, balance, departure, relative, velocity


def scaled(young, density, length):
    """Settings of the block in other units, and the factors of a time, a force and an impulse."""
    time, mass = length * np.sqrt(density / young), density * length**3
    speed = length / time
    sets = [
        f"bodies.block.material.young={young!r}",
        f"bodies.block.material.density={density!r}",
        velocity(0.01 * speed),
        f"time.rate_hz={100 / time!r}",
        f"time.duration={10 * time!r}",
    ]
    return sets, {
        "contact_end_s": time,
        "peak_force_n": mass * speed / time,
        "impulse_ns": mass * speed,
        "restitution": 1,
    }


def materials(bench):
    """E, ρ and size only change the units. Kernels are computed, not derived from each other."""
    out = bench.fresh()
    reference = bench.impact("block.toml", out=out)
    for young, density in ((1.0, 1e5), (1e12, 1e-3)):
        sets, units = scaled(young, density, 1.0)
        yield Row(
            f"E = {young:g}, ρ = {density:g}",
            "impact of E = ρ = 1 in other units",
            1e-9,
            departure(bench.impact("block.toml", *sets), reference, units),
        )
    yield Row(
        "turned by 1e17°",
        "turned by −80°, what is left of it",
        1e-12,
        departure(
            bench.impact("block.toml", "bodies.block.rotate_deg=[0,0,1e17]", out=out),
            bench.impact("block.toml", "bodies.block.rotate_deg=[0,0,-80]", out=out),
            SAME,
        ),
    )
    for length, how in ((1e-3, "a mesh in millimetres, scale = 1e-3"), (1e-6, "a body of a micrometre")):
        sets, units = scaled(1.0, 1.0, length)
        drawn = 1000.0 if length == 1e-3 else 1.0
        sets += [
            f"bodies.block.scale={length / drawn!r}",
            f"bodies.block.geometry={{a={drawn},b={drawn},c={drawn}}}",
        ]
        yield Row(
            how,
            "impact of a cube of 1 m in other units",
            1e-9,
            departure(bench.impact("block.toml", *sets), reference, units),
        )
    far = "bodies.block.geometry={x=1e6,y=1e6,z=1e6}"
    # Coordinates are rounded to 1e-10 of a metre, in elements of 0.5 m. This
    # affects the energy of an impact most.
    yield Row(
        "a mesh 1e6 m from the origin",
        "impact at the origin",
        1e-7,
        departure(bench.impact("block.toml", far, "contact.gap=0.0"), reference, SAME),
    )
    turned, floor = "bodies.block.rotate_deg=[0,0,30]", "obstacles.floor.point=[0,0,1e6]"
    yield Row(
        "the same, turned by 30° and placed on a floor at 1e6 m",
        "impact at the origin",
        1e-7,
        departure(bench.impact("block.toml", far, turned, floor), reference, SAME),
    )
    yield Row(
        "the same, turned about all axes and moved to a gap of 0",
        "impact of the turned block at the origin",
        1e-6,
        departure(
            bench.impact("block.toml", far, "bodies.block.rotate_deg=[30,20,10]", "contact.gap=0.0"),
            bench.impact("block.toml", "bodies.block.rotate_deg=[30,20,10]", "contact.gap=0.0"),
            SAME,
        ),
    )


def poisson(bench):
    """Lamé's modes of a free cube, u = (cos πx sin πy, −sin πx cos πy, 0) and its permutations, preserve volume and
    leave the faces free of stress: ω = π √(2G/ρ)/L for any ν. Locking elements would raise ω."""
    for ratio in (0.0, 0.4999):
        path = bench.body(
            "block.toml",
            "bodies.block.order=3",
            f"bodies.block.material.poisson={ratio}",
            "modes={count=30,residual_flexibility=false}",
        )
        with h5py.File(path) as file:
            omega = file["modes/angular_frequency"][:]
        exact = np.pi / np.sqrt(1 + ratio)
        yield Row(
            f"ν = {ratio:g}", "three Lamé modes at π √(2G/ρ)/L", 2e-3, np.sort(np.abs(omega / exact - 1))[2]
        )
    # All orders have the same nine contact points, so that only the elements differ. The peak force of order
    # 3 has an error of 1e-4; that of order 1 is too large by a factor of 18.
    same = ["bodies.block.material.poisson=0.4999", "contact.spacing=0.5", "modes={count=14}"]
    found = {order: bench.impact("block.toml", f"bodies.block.order={order}", *same) for order in (1, 2, 4)}
    yield Row("ν = 0.4999, order 2", "impact of order 4", 1e-2, departure(found[2], found[4], SAME))
    for order in (1, 2):
        warned = any("lock at poisson" in warning for warning in found[order]["warnings"])
        yield Row(
            f"ν = 0.4999, order {order}",
            f"{'a' if order == 1 else 'no'} warning of locking",
            0,
            warned != (order == 1),
        )


def laws(bench):
    """The remaining extremes of [contact] and [time.precision]."""
    out = bench.fresh()
    reference = bench.impact("block.toml", out=out)
    # Round-off of single precision over all steps in contact.
    yield Row(
        "single precision",
        "impact in double precision",
        1e-5,
        departure(bench.impact("block.toml", 'time.precision="single"', out=out), reference, SAME),
    )
    impulse = ['contact.scheme="impulse"', 'contact.admittance="difference"']
    line = bench.refusal("block.toml", *impulse, "time.rate_hz=0.5", out=out)
    yield Row('"difference" beyond ω_max Δ = π', "refused", 0, "is not below pi" not in line)
    one = bench.impact("block.toml", "contact.spacing=1e6")
    yield Row(
        "patches 1e6 times as wide as the block",
        "one point; ledger and momentum: impulse = m (v + v′)",
        1e-12,
        balance(one) if one["candidates"] == 1 else np.nan,
    )


def mode_counts(bench):
    """One rigid mode and a spring R: a half sine of length π √(m R), where R = L/(3EA) for a rod pressed at its
    end. More points than modes: a rigid block rebounds within one step. All modes: R vanishes."""
    # c = 1; two masses of 10 have the reduced mass 5, and R = 20/3.
    period = np.sqrt(5 * 20 / 3)
    summary = bench.impact("rods.toml", "modes={count=1}", "time.rate_hz=1000")
    # The force acts at the end of its step, which gives an error of first order in Δ/√(mR) = 2e-4.
    yield Row(
        "rods with one rigid mode",
        "half sine of π √(mR), peak v √(m/R)",
        1e-3,
        max(
            relative(summary["peak_force_n"], 0.01 * 5 / period),
            relative(summary["contact_end_s"], np.pi * period),
            abs(summary["exit_velocity"]["moving"][0]) / 0.01,
        ),
    )
    summary = bench.impact("rods.toml", "modes={count=101}")
    # The wave front is a few elements wide: 1 % of the rod.
    yield Row(
        "rods with all 101 modes",
        "velocities exchanged after 2L/c",
        0.02,
        max(relative(summary["exit_velocity"]["resting"][0], 0.01), relative(summary["contact_end_s"], 20)),
    )
    out = bench.fresh()
    six = bench.impact("block.toml", "modes={count=6}", out=out)
    # This kernel is derived from the one with R.
    summary = bench.impact("block.toml", "modes={count=6,residual_flexibility=false}", out=out)
    yield Row(
        "25 points, 6 modes, no R",
        "rigid block turned round in one step",
        1e-12,
        max(abs(summary["restitution"] - 1), summary["contact_steps"] - 1),
    )
    yield Row("25 points, 6 modes", "ledger and momentum: impulse = m (v + v′)", 1e-12, balance(six))
    summary = bench.impact("block.toml", "modes={count=375}")
    yield Row(
        "all 375 modes of 375 unknowns", "ledger and momentum: impulse = m (v + v′)", 1e-12, balance(summary)
    )
    line = bench.refusal("block.toml", "modes={count=376}")
    yield Row("376 modes of 375 unknowns", "refused: 375 free displacements", 0, "375 free" not in line)


def mass_ratios(bench):
    """Rods of different sections: both leave without strain after 2L/c, like rigid bodies of the same masses."""
    out = bench.fresh()
    for ratio in (1e-6, 1e-3, 1e3, 1e6):
        summary = bench.impact("rods.toml", f"bodies.resting.material.area={ratio!r}", out=out)
        moving, resting = (summary["exit_velocity"][name][0] / 0.01 for name in ("moving", "resting"))
        # The wave front is a few of 100 elements wide. Momentum has
        # round-off, and modes are accurate to 1e-8.
        error = max(abs(moving - (1 - ratio) / (1 + ratio)), abs(resting * (1 + ratio) / 2 - 1))
        yield Row(f"masses as 1 to {ratio:g}", "v (m₁ − m₂)/(m₁ + m₂) and 2v m₁/(m₁ + m₂)", 0.02, error)
        yield Row(f"masses as 1 to {ratio:g}", "momentum", 1e-9, abs(moving + ratio * resting - 1))


def thin_elements(bench):
    """Bending of a slender bar by Bernoulli, ω = 22.3733 √(EI/ρA)/L², and in-plane modes of a thin plate with ν = 0,
    ω = πc/L."""
    path = bench.body(
        "block.toml",
        "bodies.block.order=4",
        "modes={count=14}",
        "bodies.block.material.poisson=0.0",
        "bodies.block.geometry={a=8,b=8e-3,c=8e-3,nx=8,ny=1,nz=1}",
    )
    with h5py.File(path) as file:
        omega = file["modes/angular_frequency"][:]
    exact = 22.373285448 / np.sqrt(12) * 8e-3 / 64
    # The mode is at 1e-13 of the highest eigenvalue of the mesh: three digits remain in double precision.
    yield Row(
        "bar of elements 125 times as long as wide, 1000 widths long",
        "first bending pair by Bernoulli",
        2e-3,
        np.abs(omega[6:8] / exact - 1).max(),
    )
    path = bench.body(
        "block.toml",
        "bodies.block.material.poisson=0.0",
        "bodies.block.order=4",
        "modes={up_to_hz=0.6}",
        "bodies.block.geometry={a=1,b=1,c=1e-3,nx=1,ny=1,nz=1}",
    )
    with h5py.File(path) as file:
        omega = file["modes/angular_frequency"][:]
    yield Row(
        "plate of one element 1000 times as wide as thick",
        "two in-plane modes at πc/L",
        1e-3,
        np.sort(np.abs(omega / np.pi - 1))[1],
    )


ALL = [materials, poisson, laws, mode_counts, mass_ratios, thin_elements]
