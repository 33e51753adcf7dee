# SPDX-License-Identifier: BSD-2-Clause
"""Cases of scripts/verify --extremes that run the programs: positions, speeds, damping and ranks. There is a function for each kind of
extreme, which takes a Bench and yields Row(setting, oracle, bound, found). If `found` exceeds `bound` or is not a number, the case
fails."""

import h5py
import numpy as np
from extreme_bench import SAME, Row, balance, departure, relative, velocity


def placements(bench):
    """Overlap is refused with its depth. Touching and distant bodies are accepted."""
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
    # Contact starts within the step in which the bodies meet.
    yield Row("a gap of 1e9 m", "met when v t = gap, to a step", 1.0, abs(summary["contact_start_s"] - 1))


def speeds(bench):
    """The response of touching bodies is proportional to their speed. Above 2 % of the wave speed there is a
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


def nothing_touches(bench):
    """A body in free fall above the floor, and two bodies that move apart."""
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
    """A held block is suddenly exposed to a pressure on its foot: q̇_n = f_n e^{−ζωt} sin(ω_d t)/ω_d for any ζ, in
    complex arithmetic."""
    free = bench.fresh()
    for ratio in (0.0, 1.0, 1 + 1e-9, 100.0):
        out = bench.fresh()
        (bench.folder / "sudden.csv").write_text("0, 1\n")
        sets = [
            f"bodies.block.damping={{ratio={ratio!r}}}",
            "bodies.block.support={top='xyz'}",
            velocity(0.0),
            "contact.gap=10.0",
            'loads.traction=[{body="block",group="foot",vector=[0,0,-0.001],history="sudden.csv"}]',
        ]
        bench.impact("block.toml", *sets, out=out)
        (kernel,) = out.glob("*.kernel.h5")
        with h5py.File(kernel) as file, h5py.File(out / "block.result.h5") as result:
            omega, weight = file["modes/angular_frequency"][:], file["loads/body_force"][2]
            pressed = file["loads/foot"][2]
            time, momentum = result["time"][:][:, None], result["bodies/block/momentum"][:, 2]
        root = np.sqrt(complex(ratio**2 - 1)) * omega * time
        # (eʳ − e⁻ʳ)/2 with the decay inside the exponents, so that nothing overflows.
        decay = -ratio * omega * time
        sine = np.where(
            np.abs(root) < 1e-3,
            np.exp(decay) * (1 + root**2 / 6),
            (np.exp(decay + root) - np.exp(decay - root)) / (2 * np.where(root == 0, 1, root)),
        )
        expected = (-0.001 * weight * pressed * (sine * time).real).sum(axis=1)
        yield Row(
            f"ζ = {ratio:.10g}",
            "free motion of each mode",
            1e-10,
            np.abs(momentum - expected).max() / np.abs(expected).max(),
        )
        summary = bench.impact("block.toml", f"bodies.block.damping={{ratio={ratio!r}}}", out=free)
        yield Row(f"ζ = {ratio:.10g}", "impact: ledger and momentum", 1e-12, balance(summary))


def ranks(bench):
    """Kernels do not depend on the number of ranks, even if some have no element."""
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
    """Two equal, unconnected blocks in one mesh: each mode occurs twice, twelve are rigid, and both blocks have
    the same impact."""
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


ALL = [placements, speeds, nothing_touches, damping, ranks, double_modes]
