# SPDX-License-Identifier: BSD-2-Clause
"""Cases of scripts/verify --extremes that run the programs: friction, few unknowns and many candidates. There is a function for
each kind of extreme, which takes a Bench and yields Row(setting, oracle, bound, found). If `found` exceeds `bound` or is not a
number, the case fails."""

import h5py
import numpy as np
from extreme_bench import SAME, Row, balance, departure, relative

OBLIQUE = "bodies.block.velocity=[0.01,0,-0.01]"


def _cut_short(summary):
    """Whether steps ended before their forces were found."""
    return summary["limited_steps"] > 0


def friction(bench):
    """A block that slides as fast as it falls, with coefficients and belts at the ends of their ranges."""
    out = bench.fresh()
    reference = bench.impact("block.toml", OBLIQUE, out=bench.fresh())

    def rubbed(coefficient, *sets):
        return bench.impact("block.toml", f"contact.friction={coefficient}", *(sets or [OBLIQUE]), out=out)

    for coefficient, bound in (("0.0", 0), ("1e-30", 1e-12), ("1e-12", 1e-10)):
        summary = rubbed(coefficient)
        error = np.nan if _cut_short(summary) else departure(summary, reference, SAME)
        yield Row(f"μ = {coefficient}", "impact without friction", bound, error)
    summary = rubbed("{static=10,dynamic=0,stribeck_velocity=1e-30}")
    yield Row("Stribeck velocity 1e-30", "impact under μ_d = 0", 1e-12, departure(summary, reference, SAME))
    rough = rubbed("10")
    summary = rubbed("{static=10,dynamic=0,stribeck_velocity=1e30}")
    yield Row("Stribeck velocity 1e30", "impact under μ_s", 1e-12, departure(summary, rough, SAME))
    for how, sets in (
        ("μ = 10", []),
        ("μ = 10, backward Euler", ['contact.integration="backward-euler"']),
        ("μ = 10, one iteration a step", ["contact.max_pivots=1"]),
    ):
        summary = rubbed("10", OBLIQUE, *sets)
        away = summary["exit_velocity"]["block"]
        lost = summary["energy_lost_contact"], summary["energy_lost_friction"]
        yield Row(how, "ledger and momentum, no energy gained", 1e-12, max(balance(summary), -min(lost)))
        # Friction stops the block, or less. A body that fell through the floor would keep its speed.
        yield Row(how, "it leaves the floor, and slides no faster", 0, not (0 < away[2] and away[0] < 0.01))
    # Round-off of single precision over the steps in contact; the ledger compares both.
    single = departure(rubbed("10", OBLIQUE, 'time.precision="single"'), rough, SAME)
    yield Row("μ = 10, single precision", "impact in double precision", 1e-4, single)
    # All points slip along the belt until the end. Their own motion turns the slip by 1e-9 at 1e9 times its speed.
    fast = rubbed("0.3", "obstacles.floor.velocity=[1e9,0,0]")
    for speed in (1e6, 1e12, 1e20, 1e30):
        summary = rubbed("0.3", f"obstacles.floor.velocity=[{speed!r},0,0]")
        yield Row(f"belt at {speed:g} m/s", "impulse of one at 1e9 m/s", 1e-6, departure(summary, fast, SAME))
    ratio = fast["friction_impulse_ns"] / fast["impulse_ns"]
    yield Row("belt at 1e9 m/s", "tangential impulse μ times the normal one", 1e-6, relative(ratio, 0.3))
    summary = rubbed("10", "bodies.block.velocity=[0,0,0]")
    yield Row(
        "at rest, touching, μ = 10",
        "nothing happens, no step is cut short",
        0,
        max(summary["impulse_ns"], summary["limited_steps"], summary["energy_drift"]),
    )


def _omega(path):
    with h5py.File(path) as file:
        return file["modes/angular_frequency"][:]


def few_unknowns(bench):
    """Rods of linear elements of length h, with all their modes: ω = √(6 (1 − cos θ)/(2 + cos θ))/h, where θ = kπ/n for n free
    elements. The dense solver finds all modes of up to 300 unknowns."""

    def rods(elements, count, *sets):
        names = ("moving", "resting")
        sizes = [f"bodies.{name}.geometry={{elements={elements}}}" for name in names]
        return [*sizes, f"modes.count={count}", *sets]

    for elements in (1, 2, 298, 299, 300):
        for count in sorted({1, 2, elements // 2 + 1, elements + 1}):
            found = _omega(bench.body("rods.toml", *rods(elements, count)))
            angle = np.pi * np.arange(count) / elements
            exact = np.sqrt(6 * (1 - np.cos(angle)) / (2 + np.cos(angle))) * elements / 10
            # Round-off of eigenvalues, relative to the highest of the mesh.
            error = np.abs(found - exact).max() / (np.sqrt(12) * elements / 10)
            yield Row(
                f"{count} of {elements + 1} modes of a rod of {elements} elements",
                "ω of linear elements",
                1e-9,
                error if len(found) == count else np.nan,
            )
    supported = ['bodies.moving.support={left="x"}', "bodies.moving.velocity=[0,0,0]"]
    summary_of = rods(1, 1, *supported)
    out = bench.fresh()
    bench.body("rods.toml", *summary_of, out=out)
    lowest = max(_omega(path)[0] for path in out.glob("*.kernel.h5"))
    yield Row("one unknown", "√3 c/L", 1e-12, relative(lowest, np.sqrt(3) / 10))
    line = bench.refusal("rods.toml", *rods(1, 3))
    yield Row("3 modes of 2 unknowns", "refused: 2 free displacements", 0, "2 free" not in line)
    line = bench.refusal("rods.toml", *rods(1, 1, 'bodies.moving.support={left="x",right="x"}', supported[1]))
    yield Row("no unknown", "refused, naming the support", 0, "support" not in line and "held" not in line)
    small = ["bodies.block.geometry={nx=1,ny=1,nz=1}", "bodies.block.order=1"]
    one = _omega(bench.body("block.toml", *small, "modes.count=24"))
    small[0] = "bodies.block.geometry={nx=1,ny=1,nz=1,copies=2}"
    both = _omega(bench.body("block.toml", *small, "modes.count=48"))
    error = np.abs(both - np.repeat(one, 2)).max() / one[-1] if len(both) == 2 * len(one) else np.nan
    yield Row("all 48 modes of two equal cubes", "twice those of one", 1e-9, error)


def many_candidates(bench):
    """A rigid block, six modes without R, rebounds like one mass: elastically and in one step. A corner has the impulse
    2 v/(1/m + (r × n)ᵀ I⁻¹ (r × n)) with I = m/6."""
    rigid = ["bodies.block.order=1", "modes={count=6,residual_flexibility=false}"]
    fine, out = "bodies.block.geometry={nx=40,ny=40,nz=1}", bench.fresh()
    summary = bench.impact("block.toml", fine, *rigid, out=out)
    error = max(abs(summary["restitution"] - 1), summary["contact_steps"] - 1, balance(summary))
    yield Row("1681 candidates, all touch", "rigid block turned round in one step", 1e-11, error)
    most = bench.impact("block.toml", "bodies.block.geometry={nx=71,ny=71,nz=1}", *rigid)
    error = max(abs(most["restitution"] - 1), most["contact_steps"] - 1, balance(most))
    yield Row("5184 candidates, all touch", "rigid block turned round in one step", 1e-11, error)
    dense = bench.impact("block.toml", fine, *rigid, "contact.spacing=1e-9", out=out)
    yield Row(
        "spacing of 4e-8 elements", "every node, as without spacing", 1e-12, departure(dense, summary, SAME)
    )
    # The force on a node at the rim of linear elements is centred a third of an element inside.
    side = 0.5 - 1 / 40 / 3
    angle = np.radians(10)
    tilted = "bodies.block.rotate_deg=[10,0,0]", "bodies.block.rotate_deg=[10,10,0]"
    # Without a direction, the normal of contact would be the mean of those of the foot and of the floor.
    down = ["contact.direction=[0,0,-1]", "contact.gap=0.0", "time.duration=0.02"]
    for turn, corner in zip(tilted, (False, True)):
        summary = bench.impact("block.toml", fine, *rigid, *down, turn, out=out)
        lean_x = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
        lean_y = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
        turned = (lean_y if corner else np.eye(3)) @ lean_x
        points = [turned @ [x, y, -0.5] for x in (-side, side) for y in (-side, side)]
        arm = min(points, key=lambda point: point[2]) if corner else turned @ [0, -side, -0.5]
        lever = np.cross(arm, [0, 0, 1])
        impulse = 2 * 0.01 / (1 + 6 * lever @ lever)
        yield Row(
            f"1681 candidates, {'a corner' if corner else 'an edge'} touches",
            "impulse on a rigid cube",
            1e-9,
            relative(summary["impulse_ns"], impulse),
        )
    rubbed = ["contact.friction=10", "bodies.block.geometry={nx=20,ny=20,nz=1}", *rigid]
    summary = bench.impact("block.toml", *rubbed, "bodies.block.velocity=[0,0,-0.01]", out=bench.fresh())
    yield Row("441 candidates with μ = 10", "ledger and momentum", 1e-11, balance(summary))


ALL = [friction, few_unknowns, many_candidates]
