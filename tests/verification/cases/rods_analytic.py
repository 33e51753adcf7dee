# SPDX-License-Identifier: BSD-2-Clause
"""Two equal rods (ρ = A = E = 1, L = 10, Δ = 0.01), 1 apart, one at rest and one arriving at 1, with their response in closed form, under the
paper's algorithm (30) and under `compliant`. In the wave solution, contact lasts from t = 1 to 21, and both ends move at 1/2 under the
force Zv/2 = 1/2; then the moving rod stands still and the other one leaves at 1. With this response the printed algorithm is exact, so any
error of an impact by modes comes from the modes."""
import subprocess
import sys

from case import BLUE, GREY, ORANGE, Stopped
from ricochet.programs import ROOT

TITLE = "The paper's Figure 5 (i, ii): rods by their closed form"
SOURCE = "Bensoam, section 4.1.1 and Figure 5 (i, ii); Taylor & Papadopoulos 1993, Int. J. Numer. Methods Eng. 36, 2123: the rods."
RESTS_ON = "theory"
LONG = False
ROUND_OFF = 1e-10  # sums of 3000 samples of size 1


def run(bench):
    meshes = ROOT / "meshes" / "two-rods-analytic"
    table = bench.folder / "rods.table.h5"
    done = subprocess.run(
        [sys.executable, str(meshes / "table.py"), str(table)], capture_output=True, text=True
    )
    if done.returncode != 0:
        raise Stopped(f"table.py: {done.stderr.strip()}")
    results = {}
    for scheme in ("impulse", "compliant"):
        result = bench.contact(
            meshes / "two-rods-analytic.toml", f"contact.table={table}", f"contact.scheme={scheme}"
        )
        results[scheme] = result
        time, force = result.contact_time, result.force[:, 0]
        # An impulse at t_k represents the force over the next step; a
        # compliant force acts over the previous step.
        start, end = (time[0], time[-1] + 0.01) if scheme == "impulse" else (time[0] - 0.01, time[-1])
        bench.compare(
            f"{scheme}: start of contact (s)", start, 1.0, ROUND_OFF, "round-off: both instants lie on steps"
        )
        bench.compare(
            f"{scheme}: end of contact (s)", end, 21.0, ROUND_OFF, "round-off: 2L/c later, on a step"
        )
        bench.compare(
            f"{scheme}: smallest force (N)", force.min(), 0.5, ROUND_OFF, "round-off: the force is constant"
        )
        bench.compare(
            f"{scheme}: largest force (N)", force.max(), 0.5, ROUND_OFF, "round-off: the force is constant"
        )
        for body, speed in (("moving", 0.0), ("resting", 1.0)):
            bench.compare(
                f"{scheme}: exit velocity of the {body} rod (m/s)",
                result.summary["exit_velocity"][body][0],
                speed,
                ROUND_OFF,
                "round-off: the impulse is exact",
                absolute=True,
            )
        bench.below(
            f"{scheme}: largest penetration (m)",
            result.summary["max_penetration_m"],
            ROUND_OFF,
            "round-off: equality in (2)",
            rests_on="construction",
        )

    figure, axes = bench.figure(2, sharey="row")
    for ax, (scheme, result) in zip(axes, results.items()):
        time, force = result.time, result.total_force
        ax.plot(time, force, color="#b03a48", label="force at the ends")
        for body, colour in (("moving", BLUE), ("resting", ORANGE)):
            ax.plot(time, result.bodies[body].velocity[:, 0], color=colour, label=f"mean velocity, {body}")
        ax.vlines([1, 21], 0, 1, color=GREY, linewidth=0.8, linestyle=":", label="wave solution: 1 … 21")
        ax.set(xlabel="time (s)", ylabel="N, m/s", title=f"{scheme}, response in closed form")
    axes[0].set_ylim(-0.05, 1.5)
    axes[0].legend(loc="upper left", ncols=2)
    bench.save(figure, "Figure 5 (i): the force and the mean velocities of both rods")
