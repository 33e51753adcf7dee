# SPDX-License-Identifier: BSD-2-Clause
"""The end of a free rod (ρ = A = E = 1, L = 10) moves after a unit impulse on it. In closed form, N(t) is a staircase: 1 up to the first return
of the wave at 2L/c = 20, then 3, 5, … The sum over the 100 lowest modes of 100 linear elements rings about the stairs, as the paper's
Figure 4 (ii) and (iii) show. The means over a stair and the decrease of the error with the number of modes show that the ringing is only
that of a truncated series: at a jump, the root-mean-square error falls as 1/√N."""
import numpy as np

from case import BLUE, GREY, ORANGE, RED, slopes

TITLE = "The paper's Figure 4: Poisson functions of a rod"
SOURCE = "Bensoam, section 4.1 and Figure 4; Graff 1975, *Wave Motion in Elastic Solids*, chapter 2, for the closed form."
RESTS_ON = "theory"
LONG = False
LENGTH, STEP = 10.0, 0.01


def by_modes(kernel, times, count=None):
    """N(t), its rate and the jump of the rate at the struck end, from the lowest `count` modes."""
    omega, shape = kernel["modes/angular_frequency"][:count], kernel["surface/shape"][:].reshape(-1)[:count]
    square, phase = shape**2, np.outer(times, omega)
    over = np.where(omega > 0, np.sin(phase) / np.where(omega > 0, omega, 1), np.asarray(times)[:, None])
    return over @ square, np.cos(phase) @ square, square.sum()


def run(bench):
    from ricochet.programs import ROOT

    scene = ROOT / "meshes" / "two-rods" / "two-rods.toml"
    times = np.arange(STEP / 2, 50, STEP)
    stair = 1 + 2 * np.floor(times / (2 * LENGTH))

    paper = bench.kernel(scene, body="moving")
    value, rate, at_once = by_modes(paper, times)
    for number in range(2):
        inside = (times > 20 * number + 1) & (times < 20 * number + 19)
        bench.compare(
            f"stair {number + 1} of N, mean over its middle nine tenths (m/(N s))",
            value[inside].mean(),
            1.0 + 2 * number,
            5e-3,
            "the ripples of truncation average out over many of their periods",
        )
    bench.compare(
        "mean slope of N over 0 … 40 (1/kg)",
        value[times < 40].mean() / 20,
        0.1,
        5e-3,
        "the rigid mode alone gives 1/(ρAL), with stairs about it",
    )

    order = [
        f"bodies.{name}.{key}"
        for name in ("moving", "resting")
        for key in ("order=5", "geometry={elements=200}")
    ]
    fine = bench.kernel(scene, *order, "modes={count=200}", body="moving", out="fine")
    counts = np.array([25, 50, 100, 200])
    errors = []
    for count in counts:
        series, _, front = by_modes(fine, times, count)
        errors.append(np.sqrt(((series - stair) ** 2).mean()))
    bench.order(
        "rms error of N over the modes kept",
        counts,
        errors,
        -0.5,
        0.05,
        "Fourier series of a jump: coefficients 1/n, tail of their squares 1/N",
    )
    bench.compare(
        "Ṅ(0⁺) of 200 modes (1/kg)",
        front,
        (1 + 2 * 199) / LENGTH,
        1e-4,
        "1/(ρAL) for the rigid mode and 2/(ρAL) for each other one; elements of order 5, at least two per wavelength, disperse little",
    )

    figure, (left, right) = bench.figure(2)
    left.plot(times, stair, color=GREY, label="closed form")
    left.plot(times, value, color=BLUE, linewidth=0.8, label="100 modes of 100 elements")
    zoom = left.inset_axes([0.55, 0.12, 0.4, 0.32])
    near = np.abs(times - 20) < 1.5
    zoom.plot(times[near], stair[near], color=GREY)
    zoom.plot(times[near], value[near], color=BLUE, linewidth=0.8)
    zoom.tick_params(labelsize=6)
    left.set(xlabel="time (s)", ylabel="N (m/(N s))", title="Displacement of the end that is struck")
    left.legend(loc="upper left")
    right.plot(times, rate, color=ORANGE, linewidth=0.6)
    right.set(xlabel="time (s)", ylabel="Ṅ (1/kg)", title="Its rate: pulses at 0, 20, 40")
    bench.save(figure, "Figure 4: (i) closed form, (ii) by modes, (iii) enlarged at the first return")
    figure, ax = bench.figure()
    slopes(ax, counts, errors, "N", RED)
    ax.set(xlabel="modes kept", ylabel="root of the mean square error of N", title="The jump in a cut series")
    ax.legend()
    bench.save(figure, "Error of N against the number of modes", "order")
