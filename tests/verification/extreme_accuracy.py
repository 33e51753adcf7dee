# SPDX-License-Identifier: BSD-2-Clause
"""Cases of scripts/verify --extremes that run the programs: contact steps, the accuracy dial and its pilot. There is a function
for each kind of extreme, which takes a Bench and yields Row(setting, oracle, bound, found). If `found` exceeds `bound` or is
not a number, the case fails."""

import math

import h5py
import numpy as np
from extreme_bench import BLOCK, RODS, SAME, Row, balance, departure, relative, velocity


def contact_steps(bench):
    """Steps of contact from one for each output sample to 1e6, and a flight that a single jump crosses."""
    out = bench.fresh()
    reference = bench.impact("block.toml", out=out)
    for rate in (100.0, 1.0, 1e-30):
        summary = bench.impact("block.toml", f"time.contact_rate_hz={rate!r}", out=out)
        yield Row(
            f"contact_rate_hz = {rate:g}, rate_hz = 100",
            "steps of a sample",
            0,
            departure(summary, reference, SAME),
        )
    # The times of contact are rounded to steps of 0.01 s and 0.001 s.
    coarse = {key: 1 for key in ("impulse_ns", "restitution")}
    finer = [bench.impact("block.toml", f"time.contact_rate_hz={rate}", out=out) for rate in (1e3, 1e4)]
    # An error of second order falls from 7e-5 by a factor of 100.
    yield Row("contact_rate_hz = 1e3", "that of 1e4", 2e-6, departure(finer[0], finer[1], coarse))
    line = bench.refusal("block.toml", "time.contact_rate_hz=1e9", out=out)
    yield Row("1e7 contact steps a sample", "refused, naming the rate", 0, "contact_rate_hz" not in line)
    for rate in (1e-2, 1e-4):
        sets = ["contact.gap=1.0", "time.duration=1e4", f"time.rate_hz={rate!r}", "time.contact_rate_hz=100"]
        summary = bench.impact("block.toml", *sets, out=out)
        summary["contact_end_s"] -= 100
        # The position has the round-off of 1 m, 1e4 times the deformation.
        yield Row(
            f"a flight of 100 s, samples of {1 / rate:g} s",
            "the impact without it",
            1e-9,
            departure(summary, reference, SAME),
        )
    summary = bench.impact("block.toml", "time.rate_hz=0.1", "time.duration=100", out=out)
    yield Row("steps five times as long as the impact", "ledger and momentum", 1e-12, balance(summary))
    sets = [velocity(0.0), "time.rate_hz=1e-2", "time.contact_rate_hz=1e3", "time.duration=1e2"]
    summary = bench.impact("block.toml", *sets, out=out)
    yield Row("at rest, 1e5 contact steps a sample", "nothing happens", 0, summary["impulse_ns"])
    sets = ["contact.gap=1e6", "loads.gravity=[0,0,-1e-3]", "time.rate_hz=1e-4", "time.contact_rate_hz=100"]
    summary = bench.impact("block.toml", *sets, "time.duration=4e4", out=out)
    with h5py.File(out / "block.result.h5") as file:
        fallen = file["bodies/block/velocity"][-1, 2] + 0.01 + 1e-3 * file["time"][-1]
    yield Row(
        "4e6 steps of free fall in four jumps",
        "v = v₀ + g t",
        1e-12,
        np.nan if summary["contact_steps"] else abs(fallen) / 40,
    )
    for mass in (1e-6, 1e6):
        sets = ["contact.gap=1e3", "time.duration=2e5", "time.rate_hz=1e-3", "time.contact_rate_hz=1e3"]
        summary = bench.impact("rods.toml", *sets, f"bodies.resting.material.area={mass!r}")
        left = summary["exit_velocity"]["moving"][0] / 0.01
        # The front is a few of 100 elements wide, as in the rows of mass ratios.
        yield Row(
            f"a flight of 1e5 s, then rods of masses as 1 to {mass:g}",
            "v (m₁ − m₂)/(m₁ + m₂)",
            0.02,
            abs(left - (1 - mass) / (1 + mass)),
        )


def _open(bench):
    """Writes the scenes whose modes and steps are left to the accuracy. Rates are those of the output alone."""
    for name, text, modes in (("rods", RODS, 100), ("block", BLOCK, 30)):
        closed = f"[modes]\ncount = {modes}\n"
        assert closed in text
        (bench.folder / f"open-{name}.toml").write_text(text.replace(closed, ""))


def _estimate(summary, accuracy):
    """The estimate as a share of the accuracy; not a number if there is none."""
    return summary["error_estimate"]["total"] / accuracy if summary["error_estimate"] else math.nan


def _exchange(summary, impulse=0.1):
    """Error of the impulse of the rods and of the momentum that it leaves to each."""
    left = summary["exit_velocity"]
    return max(
        relative(summary["impulse_ns"], impulse),
        abs(left["moving"][0] - (0.01 - impulse / 10)) / 0.01,
        abs(left["resting"][0] - impulse / 10) / 0.01,
    )


def accuracy_dial(bench):
    """Rods whose settings are chosen. They exchange their velocities; a rigid rod of mass M that a rod of impedance Z meets takes
    the impulse M v (1 − e^{−2LZ/(Mc)})."""
    _open(bench)
    for accuracy in (0.5, 1e-1, 1e-2):
        summary = bench.impact("open-rods.toml", f"accuracy={accuracy!r}")
        case = f"accuracy = {accuracy:g}"
        yield Row(case, "impulse and velocities of d'Alembert", accuracy, _exchange(summary))
        yield Row(case, "estimate below the accuracy", 1, _estimate(summary, accuracy))
    for length in (1e-7, 10.0):  # times 10 m
        sets = [f"bodies.{body}.scale={length!r}" for body in ("moving", "resting")]
        sets += [f"bodies.moving.translate=[{-10 * length!r},0,0]", f"time.rate_hz={100 / length!r}"]
        summary = bench.impact("open-rods.toml", "accuracy=1e-2", f"time.duration={30 * length!r}", *sets)
        yield Row(
            f"accuracy = 0.01, rods of {10 * length:g} m",
            "impulse and velocities of d'Alembert",
            1e-2,
            max(_exchange({**summary, "impulse_ns": summary["impulse_ns"] / length}), _estimate(summary, 1)),
        )
    summary = bench.impact("open-rods.toml", "accuracy=1e-2", "bodies.resting.material.young=1e12")
    case = "accuracy = 0.01, a rod meets one 1e12 times as stiff"
    stiff = 0.1 * (1 - math.exp(-2))
    # The given elements of order 1 do not meet the accuracy.
    yield Row(case, "M v (1 − e⁻²) within the estimate", 1, _exchange(summary, stiff) / _estimate(summary, 1))
    warned = any("above accuracy = 0.01; its largest share" in text for text in summary["warnings"])
    yield Row(case, "a warning with the estimate", 0, not warned)
    # Five modes and steps of a sample cannot meet it.
    summary = bench.impact("rods.toml", "modes.count=5", "time.contact_rate_hz=100", "accuracy=1e-6")
    warned = [text for text in summary["warnings"] if "above accuracy = 1e-06" in text]
    yield Row("accuracy = 1e-6 with 5 modes", "a warning with the estimate", 0, len(warned) != 1)
    yield Row(
        "accuracy = 1e-6 with 5 modes",
        "error below 3 times the estimate",
        3,
        _exchange(summary) / _estimate(summary, 1),
    )
    for accuracy in ("0.6", "0.0", "1e-7", "-1.0", '"on"'):
        line = bench.refusal("open-rods.toml", f"accuracy={accuracy}")
        yield Row(f"accuracy = {accuracy}", "refused, naming accuracy", 0, "accuracy" not in line)


def pilots(bench):
    """Scenes in which the pilot sees no contact, or contact late, twice or by a spinning body."""
    _open(bench)
    summary = bench.impact("open-rods.toml", "bodies.moving.velocity=[-0.01,0,0]")
    silent = summary["impulse_ns"] == 0 and summary["error_estimate"] is None
    yield Row("rods that part", "no impulse, no estimate", 0, not silent)
    warned = any("nothing touched" in text for text in summary["warnings"])
    yield Row("rods that part", "a warning that nothing touched", 0, not warned)
    summary = bench.impact("open-rods.toml", "contact.gap=10", "time.rate_hz=1", "time.duration=1100")
    yield Row("rods that meet after 1000 s", "impulse and velocities of d'Alembert", 1e-2, _exchange(summary))
    between = """
[obstacles.right]
point = [10, 0, 0]
normal = [-1, 0, 0]
[obstacles.left]
point = [-20, 0, 0]
normal = [1, 0, 0]
"""
    (bench.folder / "walls.toml").write_text(
        'title = "Walls"\n[bodies.rod]\nmesh = "rod.geo"\norder = 1\n'
        "material = { density = 1.0, young = 1.0, area = 1.0 }\n"
        'velocity = [0.01, 0, 0]\ncontact = ["left", "right"]\n'
        f'{between}[[contact.pair]]\nbetween = ["rod", "right"]\n'
        '[[contact.pair]]\nbetween = ["rod", "left"]\n[time]\nrate_hz = 10.0\nduration = 2100.0\n'
    )
    summary = bench.impact("walls.toml")
    # The rod leaves each wall at its speed, after the impulse 2 m v. Its given elements of order 1 do not meet the accuracy.
    error = relative(summary["impulse_ns"], 4 * 0.1)
    yield Row("two impacts 2000 s apart", "4 m v within the estimate", 1, error / _estimate(summary, 1))
    warned = any("above accuracy = 0.01; its largest share" in text for text in summary["warnings"])
    yield Row("two impacts 2000 s apart", "a warning with the estimate", 0, not warned)
    sets = ["bodies.block.angular_velocity=[0,0,0.01]", "bodies.block.geometry={nx=1,ny=1,nz=1}"]
    summary = bench.impact("open-block.toml", "accuracy=0.1", *sets)
    # A spin about the normal does not move the contact points.
    yield Row("a block that spins about its normal", "ledger and momentum", 1e-9, balance(summary))


ALL = [contact_steps, accuracy_dial, pilots]
