# SPDX-License-Identifier: BSD-2-Clause
"""Free bricks of 100 × 130 × 170 mm: one of each crystal class, from cubic with 3 constants to triclinic with 21, and one of Sitka spruce by nine
constants. A single element of order 3 has the same functions as the polynomials of degree 3, so its frequencies agree to round-off. Two
elements of order 4 along each side are compared with degree 9; the first six frequencies count, and the error of the oracle is shown by
the change from degree 8. One brick is repeated with twice as many elements along each side. Spruce is 23 times stiffer along the grain
than across it, and both converge more slowly. `tests/verification/crystal_agreement.py`, a long test, goes on until both have converged: with
four elements of order 5 along each side, thinner at the faces, and degree 14 they agree within 1e-6 for each crystal class."""
import numpy as np

import crystals
import ritz
from block import GEO
from case import BLUE, ORANGE

TITLE = "Free bricks of crystals and of wood"
SOURCE = (
    "Rayleigh–Ritz in products of Legendre polynomials, computed in the case: Demarest 1971, J. Acoust. Soc. Am. 49, 768; "
    "Visscher et al. 1991, 90, 2154."
)
RESTS_ON = "theory"
LONG = False
SIDES, SAME, FIRST = (0.1, 0.13, 0.17), 12, 6


def scene_of(bench, order, elements, names=None):
    bodies = [
        f"""[bodies.{name}]
mesh = "box.geo"
order = {order}
geometry = {{ a = {SIDES[0]}, b = {SIDES[1]}, c = {SIDES[2]}, n = {elements} }}
material = {table}
"""
        for name, (table, _, _) in crystals.materials().items()
        if name in (names or crystals.materials())
    ]
    text = "".join(bodies) + f"[modes]\ncount = {6 + SAME}\nresidual_flexibility = false\n"
    return bench.write(f"order-{order}-{elements}.toml", text)


def run(bench):
    bench.write("box.geo", GEO)
    coarse, fine = scene_of(bench, 3, 1), scene_of(bench, 4, 2)
    rows, errors = [], []
    for name, (_, density, law) in crystals.materials().items():
        same, finer = (
            bench.kernel(scene, body=name)["modes/angular_frequency"][6 : 6 + SAME] / (2 * np.pi)
            for scene in (coarse, fine)
        )
        cubic, low, high = (
            ritz.box(SIDES, degree, density, law)[6 : 6 + count]
            for degree, count in ((3, SAME), (8, FIRST), (9, FIRST))
        )
        error, own = np.abs(finer[:FIRST] / high - 1).max(), np.abs(low / high - 1).max()
        bench.below(
            f"{name}: {SAME} frequencies of one element of order 3 beside degree 3",
            np.abs(same / cubic - 1).max(),
            1e-9,
            "the same functions: round-off",
        )
        bench.below(
            f"{name}: first {FIRST} frequencies of 2 × 2 × 2 elements of order 4 beside degree 9",
            error,
            1e-2 if name == "wood" else 5e-4,
            "a quarter of a wavelength along an element, and along the grain much less of one",
        )
        if name == "orthorhombic":
            finest = bench.kernel(scene_of(bench, 4, 4, [name]), body=name)["modes/angular_frequency"]
            bench.below(
                f"{name}: the same with 4 × 4 × 4 elements",
                np.abs(finest[6 : 6 + FIRST] / (2 * np.pi) / high - 1).max(),
                1e-5,
                "the change of the oracle from degree 8 to 9, 6e-6",
            )
        rows.append([name, f"{high[0]:.3f}", f"{finer[0]:.3f}", f"{error:.1e}", f"{own:.1e}"])
        errors.append((error, own))
    bench.table(
        ["brick", "first frequency (Hz), degree 9", "ours", "largest error of six", "change of the oracle"],
        rows,
    )
    figure, ax = bench.figure()
    names = [row[0] for row in rows]
    ax.semilogy(
        names, [error for error, _ in errors], "o", color=BLUE, label="ours, 2 × 2 × 2 elements of order 4"
    )
    ax.semilogy(names, [own for _, own in errors], "x", color=ORANGE, label="oracle of degree 8")
    ax.set(ylabel="relative difference", title="First six frequencies beside the oracle of degree 9")
    ax.tick_params(axis="x", rotation=45)
    ax.legend()
    bench.save(figure, "Bricks of each crystal class and of spruce against Rayleigh–Ritz of degree 9")
