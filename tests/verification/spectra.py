# SPDX-License-Identifier: BSD-2-Clause
"""Measured resonances of free bodies beside ours: resonant ultrasound spectroscopy. The authors of such a measurement fit the two to 21
elastic constants to all lines at once, so the lines test the computation, and not the constants."""
import numpy as np

from case import BLUE, GREY, ORANGE, rms

RIGID = 6


def engineering(c11, c44):
    """Young's modulus, in the unit of the constants, and Poisson's ratio of an isotropic material."""
    lame = c11 - 2 * c44
    return c44 * (3 * lame + 2 * c44) / (lame + c44), lame / (2 * (lame + c44))


def isotropic(density, young, poisson):
    """The material of a scene."""
    return f"{{density={density:.6g},young={young:.6g},poisson={poisson:.5g}}}"


def frequencies(bench, scene, body, material, count):
    """The lowest `count` elastic frequencies [kHz] with this material."""
    material = f"bodies.{body}.material={material}"
    with bench.kernel(scene, material, f"modes.count={RIGID + count}", body=body) as kernel:
        return kernel["modes/angular_frequency"][RIGID:] / (2e3 * np.pi)


def compare_usual(bench, ratio, scatter):
    """Lines of constants to which nothing is fitted. `ratio`: ours / measured, `scatter`: the authors' own misfit."""
    bench.compare(
        "usual constants: mean of ours / measured",
        ratio.mean(),
        1.0,
        0.03,
        "nothing is fitted; moduli of one alloy differ by a few per cent, which counts by half",
    )
    bench.below(
        "usual constants: scatter of ours / measured about its mean",
        ratio.std() / ratio.mean(),
        2 * scatter,
        "ratios of frequencies depend on Poisson's ratio alone: twice the misfit",
    )


def compare(bench, ours, usual, resonances, computation, title):
    """Lines, table and figure of a body. `ours` and `usual` [kHz], from the fitted and from usual constants, ascend and start with the
    first elastic mode; `usual` is None if there are no usual constants. `resonances` (n, 3): number of the mode, from 1, its measured frequency [kHz] and that of the authors' own
    computation. `computation` is the bound for the difference of ours from the latter, with its reason."""
    number = resonances[:, 0].astype(int)
    measured, theirs = resonances[:, 1:].T
    ours = ours[number - 1]
    deviation, residual = ours / measured - 1, theirs / measured - 1
    scatter = rms(residual)
    bench.below(
        f"{len(number)} resonances: root mean square of ours / measured − 1",
        rms(deviation),
        1.1 * scatter,
        f"the authors' own misfit of {100 * scatter:.3f} %, and a tenth for the errors of two computations",
    )
    bench.below(
        "the same, largest",
        np.abs(deviation).max(),
        3 * scatter,
        "three times the misfit; a missing or surplus mode would shift all later lines",
    )
    bench.below(
        "root mean square of ours / the authors' computation − 1",
        rms(ours / theirs - 1),
        *computation,
        rests_on="published",
    )
    if usual is not None:
        compare_usual(bench, usual[number - 1] / measured, scatter)
    bench.table(
        ["mode", "measured (kHz)", "ours", "deviation (%)", "authors' computation", "deviation (%)"],
        [
            [str(n), f"{m:.3f}", f"{o:.3f}", f"{100 * d:+.2f}", f"{t:.3f}", f"{100 * r:+.2f}"]
            for n, m, o, d, t, r in zip(number, measured, ours, deviation, theirs, residual)
        ],
    )

    figure, (left, right) = bench.figure(2)
    left.plot(number, measured, "o", color=ORANGE, markersize=4, label="measured")
    left.plot(number, ours, "_", color=BLUE, markersize=9, label="ours")
    right.axhspan(
        -100 * scatter, 100 * scatter, color=ORANGE, alpha=0.2, linewidth=0, label="residual of the authors"
    )
    right.plot(measured, 100 * residual, "x", color=GREY, markersize=5, label="authors' computation")
    right.plot(measured, 100 * deviation, ".", color=BLUE, markersize=6, label="ours")
    left.set(xlabel="elastic mode", ylabel="frequency (kHz)", title=title)
    right.set(
        xlabel="frequency (kHz)", ylabel="computed / measured − 1 (%)", title="Deviation from the measurement"
    )
    left.legend(loc="lower right")
    right.legend(fontsize=7)
    return figure
