# SPDX-License-Identifier: BSD-2-Clause
"""The free disk of the paper's Table 1 (soft lead: ρ = 11 300 kg/m³, E = 10.4 MPa, ν = 0.37, radius 50 mm, thickness 5 mm), on the mesh of
`meshes/two-disks` with elements of order 3. Its mass and its elastic frequencies are compared with polynomials over the whole disk, which
have no mesh."""
import numpy as np

import ritz
from case import BLUE, GREY
from ricochet.programs import ROOT

TITLE = "The disk of the paper's Table 1"
SOURCE = "Bensoam, Table 1; Rayleigh–Ritz in global polynomials, computed in the case: Visscher et al. 1991, J. Acoust. Soc. Am. 90, 2154."
RESTS_ON = "theory"
LONG = False
DENSITY, YOUNG, POISSON, RADIUS, THICKNESS = 11.3e3, 10.4e6, 0.37, 0.05, 5e-3
ELASTIC = 30


def run(bench):
    scene = ROOT / "meshes" / "two-disks" / "two-disks.toml"
    kernel = bench.kernel(
        scene,
        f"modes={{count={6 + ELASTIC},residual_flexibility=false}}",
        "bodies.lower.support={}",
        "output.view=false",
        "bodies.upper.geometry={size=1e-2}",
        "bodies.lower.geometry={size=1e-2}",
        body="upper",
    )
    ours = kernel["modes/angular_frequency"][:] / (2 * np.pi)
    law = ritz.isotropic(YOUNG, POISSON)
    fine = ritz.disk(RADIUS, THICKNESS, 18, 5, DENSITY, law)[6 : 6 + ELASTIC]
    coarse = ritz.disk(RADIUS, THICKNESS, 16, 4, DENSITY, law)[6 : 6 + ELASTIC]
    elastic = ours[6 : 6 + ELASTIC]
    error = np.abs(elastic / fine - 1)
    bench.compare(
        "mass (kg)",
        kernel.attrs["mass"],
        DENSITY * np.pi * RADIUS**2 * THICKNESS,
        1e-4,
        "the cubic edges of the rim, 5.6° each, deviate from the circle by less",
    )
    bench.compare("rigid modes", np.count_nonzero(ours == 0), 6, 0, "a count")
    for number in (0, 9, 19, 29):
        bench.compare(
            f"elastic frequency {number + 1} (Hz)",
            elastic[number],
            fine[number],
            6e-3,
            "order 3, elements a fifth of the radius",
        )
    bench.below(
        f"largest relative error of {ELASTIC} elastic frequencies",
        error.max(),
        6e-3,
        "order 3, elements a fifth of the radius",
    )
    bench.below(
        "change of the oracle from degree 16 to 18",
        np.abs(coarse / fine - 1).max(),
        6e-4,
        "a tenth of the bound",
        rests_on="construction",
    )

    figure, ax = bench.figure()
    number = np.arange(1, ELASTIC + 1)
    ax.plot(number, fine, "_", color=GREY, markersize=12, label="Rayleigh–Ritz")
    ax.plot(number, elastic, "o", color=BLUE, markersize=3, label="ours")
    ax.set(
        xlabel="elastic mode",
        ylabel="frequency (Hz)",
        title=f"{kernel.attrs['dofs']} unknowns, largest error {error.max():.1e}",
    )
    ax.legend()
    bench.save(figure, "Elastic frequencies of the free disk")
