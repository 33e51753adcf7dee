# SPDX-License-Identifier: BSD-2-Clause
"""The cases of scripts/verify --extremes that run the programs: a function for each kind of extreme. It takes
a Bench and yields Row(what is set, what it must be, bound, found); `found` above `bound`, or not a number, is
a failure."""

import h5py
import numpy as np
from extreme_bench import Row


def relative(found, expected):
    return abs(found / expected - 1)


def velocity(value):
    return f"bodies.block.velocity=[0,0,{-value!r}]"


def scaled(young, density, length):
    """Settings of the block in other units, and what they make of a time, a force and an impulse."""
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


def departure(summary, reference, units):
    """The largest relative difference of an impact's figures from those of another one in other units."""
    return max(relative(summary[key] / unit, reference[key]) for key, unit in units.items())


SAME = {"contact_end_s": 1, "peak_force_n": 1, "impulse_ns": 1, "restitution": 1}


def materials(bench):
    """Nothing but units changes with E, ρ and size. Kernels are computed, not derived from each other."""
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
    # Coordinates are round to 1e-10 of a metre, in elements of 0.5 m; the energy of an impact feels it most.
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
    """Lamé's modes of a free cube, u = (cos πx sin πy, −sin πx cos πy, 0) and the like, keep its volume and
    leave its faces free of stress: ω = π √(2G/ρ)/L whatever ν. Elements that lock would raise them."""
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
    # The same nine points of contact, so that elements alone differ. The peak of order 3 is 1e-4 off, that of
    # order 1 18 times.
    same = ["bodies.block.material.poisson=0.4999", "contact.spacing=0.5", "modes={count=14}"]
    found = {order: bench.impact("block.toml", f"bodies.block.order={order}", *same) for order in (1, 2, 4)}
    yield Row("ν = 0.4999, order 2", "impact of order 4", 1e-2, departure(found[2], found[4], SAME))
    for order in (1, 2):
        warned = any("lock" in warning for warning in found[order]["warnings"])
        yield Row(
            f"ν = 0.4999, order {order}",
            f"{'a' if order == 1 else 'no'} warning of locking",
            0,
            warned != (order == 1),
        )


def mode_counts(bench):
    """One rigid mode and a spring R: a half sine of π √(m R), R = L/(3EA) of a rod that is pressed at its
    end. More points than modes: a rigid block turns round in one step. All modes: nothing is left to R."""
    # c = 1, m = 10 against 10: reduced 5, R = 20/3.
    period = np.sqrt(5 * 20 / 3)
    summary = bench.impact("rods.toml", "modes={count=1}", "time.rate_hz=1000")
    # The force acts at the end of its step: an error of the first order in Δ/√(mR) = 2e-4.
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
    # The front is as wide as a few elements: 1 % of the rod.
    yield Row(
        "rods with all 101 modes",
        "velocities exchanged after 2L/c",
        0.02,
        max(relative(summary["exit_velocity"]["resting"][0], 0.01), relative(summary["contact_end_s"], 20)),
    )
    out = bench.fresh()
    six = bench.impact("block.toml", "modes={count=6}", out=out)
    # Its kernel follows from the one with R.
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


def balance(summary, mass=1.0, speed=0.01):
    """What an impact on the floor misses of its ledger and of momentum."""
    away = summary["exit_velocity"]["block"][2]
    return max(relative(summary["impulse_ns"], mass * (speed + away)), summary["energy_drift"])


def mass_ratios(bench):
    """Rods of unlike section: both leave without strain after 2L/c, as rigid bodies of their masses would."""
    out = bench.fresh()
    for ratio in (1e-6, 1e-3, 1e3, 1e6):
        summary = bench.impact("rods.toml", f"bodies.resting.material.area={ratio!r}", out=out)
        moving, resting = (summary["exit_velocity"][name][0] / 0.01 for name in ("moving", "resting"))
        # The front is as wide as a few elements, of 100; momentum is a matter of round-off and modes at 1e-8.
        error = max(abs(moving - (1 - ratio) / (1 + ratio)), abs(resting * (1 + ratio) / 2 - 1))
        yield Row(f"masses as 1 to {ratio:g}", "v (m₁ − m₂)/(m₁ + m₂) and 2v m₁/(m₁ + m₂)", 0.02, error)
        yield Row(f"masses as 1 to {ratio:g}", "momentum", 1e-9, abs(moving + ratio * resting - 1))


def thin_elements(bench):
    """Bending of a slender bar by Bernoulli, ω = 22.3733 √(EI/ρA)/L²; the breathing of a thin plate of ν = 0,
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
    # 1e-13 of the highest eigenvalue of the mesh: in double precision the last three digits are left.
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


def placements(bench):
    """Overlap is refused with its depth; what touches or lies far away is not."""
    out = bench.fresh()
    for depth in (0.1, 1e-6, 1e-9):
        line = bench.refusal("block.toml", f"bodies.block.translate=[0,0,{-depth!r}]", out=out)
        found = float(line.split("overlap by ")[1].split(" m")[0]) if "overlap by" in line else np.nan
        yield Row(f"overlap of {depth:g} m", "refused with its depth", 1e-5, relative(found, depth))
    line = bench.refusal("rods.toml", "bodies.moving.translate=[-9.9,0,0]", "modes={count=5}")
    yield Row("rods that overlap by 0.1 m", "refused with its depth", 0, "overlap by 0.1 m" not in line)
    reference = bench.impact("block.toml", out=out)
    yield Row(
        "gap = 0",
        "touching as drawn",
        1e-12,
        departure(bench.impact("block.toml", "contact.gap=0.0", out=out), reference, SAME),
    )
    high, floor = "bodies.block.translate=[1e9,1e9,1e9]", "obstacles.floor.point=[0,0,1e9]"
    yield Row(
        "touching 1e9 m from the origin",
        "impact at the origin",
        1e-12,
        departure(bench.impact("block.toml", high, floor, out=out), reference, SAME),
    )
    summary = bench.impact("block.toml", "contact.gap=1e9", velocity(1e9), "time.rate_hz=1.0", out=out)
    # Contact is met within the step in which the bodies meet.
    yield Row("a gap of 1e9 m", "met when v t = gap, to a step", 1.0, abs(summary["contact_start_s"] - 1))


def speeds(bench):
    """Bodies that touch answer in proportion to their speed. Faster than 2 % of the wave there is a
    warning."""
    out = bench.fresh()
    reference = bench.impact("block.toml", out=out)
    for speed in (1e-12, 1e3):
        summary = bench.impact("block.toml", velocity(speed), out=out)
        units = SAME | {"peak_force_n": speed / 0.01, "impulse_ns": speed / 0.01}
        yield Row(f"{speed:g} m/s", "in proportion to 0.01 m/s", 1e-10, departure(summary, reference, units))
        warned = any("approach speed" in warning for warning in summary["warnings"])
        yield Row(
            f"{speed:g} m/s",
            f"{'a' if speed > 1 else 'no'} warning of large strain",
            0,
            warned != (speed > 1),
        )
    summary = bench.impact("block.toml", velocity(0.0), out=out)
    yield Row(
        "at rest, touching",
        "nothing happens",
        0,
        max(summary["impulse_ns"], summary["contact_steps"], summary["energy_drift"]),
    )
    summary = bench.impact("block.toml", "bodies.block.velocity=[1,0,0]", out=out)
    yield Row("grazing, touching", "no impulse", 1e-15, summary["impulse_ns"])
    summary = bench.impact("block.toml", "bodies.block.velocity=[1,0,-1e-9]", out=out)
    yield Row(
        "grazing, 1e-9 of the speed inwards",
        "restitution of 0.01 m/s",
        1e-6,
        relative(summary["restitution"], reference["restitution"]),
    )
    line = bench.refusal("block.toml", velocity(1e200), out=out)
    yield Row("1e200 m/s", "refused, and why", 0, "velocity" not in line)


def nothing_touches(bench):
    """A body in free fall above the floor, and two that part."""
    out = bench.fresh()
    summary = bench.impact("block.toml", "contact.gap=1e3", "loads.gravity=[0,0,-9.81]", out=out)
    with h5py.File(out / "block.result.h5") as file:
        fallen = file["bodies/block/velocity"][:, 2] + 0.01 + 9.81 * file["time"][:]
    yield Row(
        "free fall far above the floor",
        "v = v₀ + g t; no contact",
        1e-10,
        np.nan if summary["contact_steps"] else np.abs(fallen).max(),
    )
    line = bench.refusal(
        "block.toml", "obstacles.floor.point=[0,0,2]", "obstacles.floor.normal=[0,0,-1]", out=out
    )
    yield Row(
        "a floor that the block turns its back to",
        "refused: nothing faces it",
        0,
        'faces "floor"' not in line,
    )
    summary = bench.impact("rods.toml", "bodies.moving.velocity=[-0.01,0,0]")
    yield Row("rods that part", "no contact", 0, max(summary["contact_steps"], summary["impulse_ns"]))


def damping(bench):
    """A held block falls into its own weight: q̇_n = f_n e^{−ζωt} sin(ω_d t)/ω_d, whatever ζ, by complex
    arithmetic."""
    free = bench.fresh()
    for ratio in (0.0, 1.0, 1 + 1e-9, 100.0):
        out, sets = bench.fresh(), [
            f"bodies.block.damping={{ratio={ratio!r}}}",
            "bodies.block.support={top='xyz'}",
            velocity(0.0),
            "contact.gap=10.0",
            "loads.gravity=[0,0,-0.001]",
        ]
        bench.impact("block.toml", *sets, out=out)
        (kernel,) = out.glob("*.kernel.h5")
        with h5py.File(kernel) as file, h5py.File(out / "block.result.h5") as result:
            omega, weight = file["modes/angular_frequency"][:], file["loads/body_force"][2]
            time, momentum = result["time"][:][:, None], result["bodies/block/momentum"][:, 2]
        root = np.sqrt(complex(ratio**2 - 1)) * omega * time
        # (eʳ − e⁻ʳ)/2 with the decay inside, so that nothing overflows.
        decay = -ratio * omega * time
        sine = np.where(
            np.abs(root) < 1e-3,
            np.exp(decay) * (1 + root**2 / 6),
            (np.exp(decay + root) - np.exp(decay - root)) / (2 * np.where(root == 0, 1, root)),
        )
        expected = (-0.001 * weight**2 * (sine * time).real).sum(axis=1)
        yield Row(
            f"ζ = {ratio:.10g}",
            "free motion of each mode",
            1e-10,
            np.abs(momentum - expected).max() / np.abs(expected).max(),
        )
        summary = bench.impact("block.toml", f"bodies.block.damping={{ratio={ratio!r}}}", out=free)
        yield Row(f"ζ = {ratio:.10g}", "impact: ledger and momentum", 1e-12, balance(summary))


def ranks(bench):
    """Kernels do not depend on the number of ranks, even where some have no element."""
    one = ["bodies.block.geometry={nx=1,ny=1,nz=1}", "modes={count=20}"]
    reference, summary = bench.impact("block.toml", *one), bench.impact("block.toml", *one, ranks=4)
    yield Row("4 ranks, 1 element", "impact by 1 rank", 1e-9, departure(summary, reference, SAME))
    few = ["bodies.moving.geometry={elements=2}", "bodies.resting.geometry={elements=2}", "modes={count=3}"]
    reference, summary = bench.impact("rods.toml", *few), bench.impact("rods.toml", *few, ranks=4)
    yield Row(
        "4 ranks, rods of 2 elements",
        "impact by 1 rank",
        1e-9,
        max(relative(summary[key], reference[key]) for key in SAME),
    )


def double_modes(bench):
    """Two equal blocks in one mesh, held to nothing: each mode twice, twelve of them rigid, and the impact of
    each."""
    single, twice = bench.fresh(), bench.fresh()
    copies = ["bodies.block.geometry={copies=2}", "modes={count=60}"]
    reference, summary = bench.impact("block.toml", out=single), bench.impact(
        "block.toml", *copies, out=twice
    )
    omega = []
    for out in (single, twice):
        (path,) = out.glob("*.kernel.h5")
        with h5py.File(path) as file:
            omega.append(file["modes/angular_frequency"][:])
    pairs = np.repeat(omega[0], 2)[: len(omega[1])]
    yield Row(
        "two equal blocks as one body",
        "all modes double",
        1e-9,
        np.abs(omega[1] - pairs).max() / pairs.max() if len(pairs) == len(omega[1]) else np.nan,
    )
    units = SAME | {"peak_force_n": 2, "impulse_ns": 2}
    yield Row(
        "two equal blocks as one body", "twice the impact of one", 1e-9, departure(summary, reference, units)
    )


def nonsense(bench):
    """What is beyond arithmetic is refused before it is computed."""
    out = bench.fresh()
    for setting, word in (
        ("bodies.block.material.density=1e300", "density"),
        ("bodies.block.material.young=1e-300", "young"),
        ("bodies.block.scale=1e150", "scale"),
        ("modes={up_to_hz=1e300}", "up_to_hz"),
        ("modes={up_to_hz=1e-9}", "up_to_hz"),
        ("bodies.block.geometry={a=0}", "block.geo"),
        ("time.rate_hz=1e300", "rate_hz"),
        ("loads.gravity=[0,0,-1e300]", "gravity"),
    ):
        line = bench.refusal("block.toml", setting, out=out)
        yield Row(setting, f"refused, naming {word}", 0, word not in line)


def laws(bench):
    """The other ends of [contact] and [time.precision]."""
    out = bench.fresh()
    reference = bench.impact("block.toml", out=out)
    # Round-off of single precision, over as many steps as they touch.
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


ALL = [
    materials,
    poisson,
    laws,
    mode_counts,
    mass_ratios,
    thin_elements,
    placements,
    speeds,
    nothing_touches,
    damping,
    ranks,
    double_modes,
    nonsense,
]
