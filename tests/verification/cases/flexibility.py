# SPDX-License-Identifier: BSD-2-Clause
"""A steel block of 60 × 50 × 40 mm on a clamped foot, in 4 × 4 × 4 bricks of order 2. The displacement of the contact patches on its top
under a unit normal force on each is Σ_n φ_in φ_jn/ω_n² + R_ij for any number of modes, because R represents the others. The oracle
assembles the same bricks from one-dimensional integrals and solves for all patches at once."""
import numpy as np

import scenes
from block import GEO, Block
from case import BLUE, RED, plain_ticks

TITLE = "Static flexibility of a clamped block"
SOURCE = "A direct dense solve of finite elements assembled in the case as Kronecker products, which shares no code with Ricochet."
RESTS_ON = "theory"
LONG = False
SIDES, ELEMENTS, ORDER = (0.06, 0.05, 0.04), 4, 2
MATERIAL = dict(density=7850.0, young=210e9, poisson=0.3)

SCENE = scenes.scene(
    {
        "box": f"""
mesh = "block.geo"
geometry = {{ a = {SIDES[0]}, b = {SIDES[1]}, c = {SIDES[2]}, n = {ELEMENTS} }}
order = {ORDER}
material = {{ density = {MATERIAL['density']}, young = {MATERIAL['young']}, poisson = {MATERIAL['poisson']} }}
contact = "top"
support = {{ foot = "xyz" }}
"""
    },
    modes="count = 10",
    contact="direction = [0, 0, 1]",
    time="duration = 1.0",
    obstacles={"ceiling": "point = [0, 0, 1]\nnormal = [0, 0, -1]"},
)


def run(bench):
    bench.write("block.geo", GEO)
    scene = bench.write("block.toml", SCENE)
    block = Block(SIDES, ELEMENTS, ORDER, **MATERIAL, clamped=True)
    exact = block.loads.T @ np.linalg.solve(block.stiffness, block.loads)
    counts, modal, whole = [10, 40, 160], [], []
    scale = np.abs(exact).max()
    for count in counts:
        kernel = bench.kernel(scene, f"modes={{count={count}}}", body="box", out=f"out-{count}")
        omega, shape = kernel["modes/angular_frequency"][:], kernel["surface/shape"][:]
        rows = block.rows(kernel["surface/node"][:])
        reference = exact[np.ix_(rows, rows)]
        part = (shape / omega**2) @ shape.T
        total = part + kernel["surface/residual_flexibility"][:]
        modal.append(np.abs(part - reference).max() / scale)
        whole.append(np.abs(total - reference).max() / scale)
        bench.compare(
            f"{count} modes: flexibility of the patch at the centre (nm/N)",
            1e9 * total.diagonal()[rows.argsort()][len(rows) // 2],
            1e9 * exact.diagonal()[len(rows) // 2],
            1e-8,
            "modes of residual 1e-8 and static solves to 1e-10",
        )
        bench.below(
            f"{count} modes: largest error of all {len(rows)}² entries, over the largest entry",
            whole[-1],
            1e-8,
            "modes of residual 1e-8 and static solves to 1e-10",
        )
    area = kernel["surface/area"][:]
    bench.below(
        "largest relative error of the areas of the patches",
        np.abs(area / block.area[rows] - 1).max(),
        1e-11,
        "round-off, including that of the mesh generator",
    )
    bench.below(
        "160 modes: negative part of the smallest eigenvalue of R, over the largest entry",
        max(0.0, -np.linalg.eigvalsh(kernel["surface/residual_flexibility"][:])[0]) / scale,
        1e-12,
        "R is positive semidefinite",
        rests_on="ourselves",
    )
    figure, ax = bench.figure()
    ax.loglog(counts, modal, "o-", color=RED, label="modes alone")
    ax.loglog(counts, whole, "o-", color=BLUE, label="modes + R")
    ax.axhline(1e-8, color="black", linestyle=":", linewidth=0.8, label="bound")
    plain_ticks(ax, counts)
    ax.set(
        xlabel="modes",
        ylabel="largest error / largest entry",
        title="Static flexibility of the contact patches",
    )
    ax.legend()
    bench.save(figure, "Static flexibility of a clamped block by modes alone and with residual flexibility")
