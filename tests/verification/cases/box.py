# SPDX-License-Identifier: BSD-2-Clause
"""A free aluminium box of 100 × 130 × 170 mm and a free cube, with two elements of order 5 along each side, compared with polynomials over
the whole box. The cube has modes in pairs and triples, and the same multiplicities must be found. Both oracles are evaluated at two
degrees to show their own error."""
import numpy as np

import ritz
from block import GEO, SCENE
from case import BLUE, ORANGE

TITLE = "Free boxes: resonant ultrasound spectroscopy"
SOURCE = (
    "Rayleigh–Ritz in products of Legendre polynomials, computed in the case: Demarest 1971, J. Acoust. Soc. Am. 49, 768; "
    "Visscher et al. 1991, 90, 2154."
)
RESTS_ON = "theory"
LONG = False
DENSITY, YOUNG, POISSON = 2700.0, 70e9, 0.33
ELASTIC = 24


def run(bench):
    bench.write("box.geo", GEO)
    scene = bench.write(
        "box.toml", SCENE.format(density=DENSITY, young=YOUNG, poisson=POISSON, count=6 + ELASTIC)
    )
    figure, ax = bench.figure()
    for name, sides, colour in (("box", (0.1, 0.13, 0.17), BLUE), ("cube", (0.1, 0.1, 0.1), ORANGE)):
        a, b, c = sides
        kernel = bench.kernel(scene, f"bodies.box.geometry={{a={a},b={b},c={c}}}", body="box")
        ours = kernel["modes/angular_frequency"][:] / (2 * np.pi)
        coarse, fine = (
            ritz.box(sides, degree, DENSITY, ritz.isotropic(YOUNG, POISSON))[6 : 6 + ELASTIC]
            for degree in (7, 9)
        )
        bench.compare(f"{name}: rigid modes", np.count_nonzero(ours == 0), 6, 0, "a count")
        bench.compare(
            f"{name}: first elastic frequency (Hz)",
            ours[6],
            fine[0],
            5e-5,
            "a smooth mode, a quarter of a wavelength per element",
        )
        elastic = ours[6 : 6 + ELASTIC]
        error = np.abs(elastic / fine - 1)
        bench.below(
            f"{name}: change of the oracle from degree 7 to 9, {ELASTIC} frequencies",
            np.abs(coarse / fine - 1).max(),
            5e-4,
            "half the bound of the next line",
            rests_on="construction",
        )
        bench.below(
            f"{name}: largest relative error of {ELASTIC} elastic frequencies",
            error.max(),
            1e-3,
            "the shortest wavelengths are about two elements",
        )
        if name == "cube":
            # The number of computed modes may cut the last group.
            known = ritz.multiplicities(fine, 1e-6)[:-1]
            found = ritz.multiplicities(elastic, 1e-6)[: len(known)]
            bench.compare("cube: largest multiplicity", max(found), max(known), 0, "a count")
            bench.compare(
                "cube: groups of equal frequencies of the same size as in the oracle",
                sum(x == y for x, y in zip(found, known)),
                len(known),
                0,
                "a count",
            )
        ax.semilogy(
            np.arange(1, ELASTIC + 1),
            np.maximum(error, 1e-12),
            "o",
            markersize=3,
            color=colour,
            label=f"{name}: ours",
        )
        ax.semilogy(
            np.arange(1, ELASTIC + 1),
            np.maximum(np.abs(coarse / fine - 1), 1e-12),
            "x",
            markersize=3,
            color=colour,
            alpha=0.6,
            label=f"{name}: oracle of degree 7",
        )
    ax.set(
        xlabel="elastic mode", ylabel="relative difference", title="Frequencies beside the oracle of degree 9"
    )
    ax.legend()
    bench.save(figure, "Free box and cube against Rayleigh–Ritz of degree 9")
