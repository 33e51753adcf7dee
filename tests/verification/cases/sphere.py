# SPDX-License-Identifier: BSD-2-Clause
"""A free sphere (R = E = ρ = 1, ν = 0.3). Torsional modes of degree l are roots x = ωR/c_s of (l − 1) j_l(x) = x j_{l+1}(x); spheroidal
ones are roots of a 2 × 2 determinant of the surface tractions. Each root has 2l + 1 modes. The case finds the roots from spherical Bessel
functions by their series. A mesh has no such symmetry, so finding each root 2l + 1 times shows that no mode is missing or spurious."""
import math

import numpy as np

from case import BLUE, GREEN, ORANGE

TITLE = "Lamb's modes of the free sphere"
SOURCE = "Lamb 1882, Proc. London Math. Soc. 13, 189; traction determinants as in Eringen & Suhubi 1975, *Elastodynamics* II, chapter 8."
RESTS_ON = "theory"
LONG = False
POISSON = 0.3
SHEAR_SPEED = np.sqrt(1 / (2 * (1 + POISSON)))
RATIO = np.sqrt((1 - 2 * POISSON) / (2 * (1 - POISSON)))  # c_s / c_p
HIGHEST = 5.5  # largest ωR/c_s

GEO = """SetFactory("OpenCASCADE");
DefineConstant[size = 0.6];
Sphere(1) = {0, 0, 0, 1};
MeshSize{:} = size;
Physical Volume("ball") = {1};
Physical Surface("skin") = {1};
"""
SCENE = f"""[bodies.ball]
mesh = "sphere.geo"
order = 4
material = {{ density = 1.0, young = 1.0, poisson = {POISSON} }}
contact = "skin"
[obstacles.floor]
point = [0, 0, -2]
normal = [0, 0, 1]
[modes]
up_to_hz = {HIGHEST * SHEAR_SPEED / (2 * np.pi)}
residual_flexibility = false
[contact]
between = ["ball", "floor"]
direction = [0, 0, -1]
spacing = 0.5
[time]
duration = 1.0
"""


def bessel(degree, x):
    """j_l(x) by its power series. For the small x used here, recurrences would lose digits."""
    term = x**degree / math.prod(range(1, 2 * degree + 2, 2))
    total, k = term, 0
    while abs(term) > 1e-18 * abs(total) or k < 5:
        k += 1
        term *= -x * x / 2 / (k * (2 * degree + 2 * k + 1))
        total += term
    return total


def torsional(l, x):
    return (l - 1) * bessel(l, x) - x * bessel(l + 1, x)


def spheroidal(l, x):
    a = RATIO * x
    radial = (l * l - l - x * x / 2) * bessel(l, a) + 2 * a * bessel(l + 1, a)
    if l == 0:
        return radial
    return radial * ((l * l - 1 - x * x / 2) * bessel(l, x) + x * bessel(l + 1, x)) - l * (l + 1) * (
        (l - 1) * bessel(l, x) - x * bessel(l + 1, x)
    ) * ((l - 1) * bessel(l, a) - a * bessel(l + 1, a))


def roots(condition, low=0.7, high=HIGHEST, steps=500):
    """Simple roots between low and high. The root at 0, a rigid motion, is excluded."""
    grid = np.linspace(low, high, steps)
    values = [condition(x) for x in grid]
    found = []
    for left, right, a, b in zip(grid, grid[1:], values, values[1:]):
        if a * b < 0:
            for _ in range(60):
                middle = (left + right) / 2
                left, right = (middle, right) if condition(middle) * a > 0 else (left, middle)
            found.append(left)
    return found


def run(bench):
    bench.write("sphere.geo", GEO)
    kernel = bench.kernel(bench.write("sphere.toml", SCENE), body="ball")
    ours = kernel["modes/angular_frequency"][:] / SHEAR_SPEED
    elastic = ours[ours > 0]
    table = sorted(
        (x, l, kind)
        for kind, condition in (("T", torsional), ("S", spheroidal))
        for l in range(0 if kind == "S" else 1, 8)
        for x in roots(lambda x: condition(l, x))
    )
    flat = np.array([x for x, l, _ in table for _ in range(2 * l + 1)])
    reason = "elements of order 4, a quarter to half a wavelength long, on a surface of degree 4"
    bench.compare("rigid modes", np.count_nonzero(ours == 0), 6, 0, "a count")
    bench.compare(
        f"elastic modes up to ωR/c_s = {HIGHEST}",
        len(elastic),
        len(flat),
        0,
        "a count: Σ (2l + 1) over the roots",
    )
    start = 0
    for x, l, kind in table:
        group = elastic[start : start + 2 * l + 1]
        start += 2 * l + 1
        if len(group) == 2 * l + 1:
            worst = group[np.argmax(np.abs(group - x))]
            bench.compare(
                f"{kind}, l = {l}: farthest of its {2 * l + 1} values of ωR/c_s", worst, x, 2e-3, reason
            )

    figure, ax = bench.figure()
    for kind, colour, name in (("T", ORANGE, "torsional"), ("S", GREEN, "spheroidal")):
        chosen = [(l, x) for x, l, k in table if k == kind]
        ax.plot(
            *zip(*chosen), "_", color=colour, markersize=16, markeredgewidth=2, label=f"{name}: closed form"
        )
    start = 0
    for x, l, kind in table:
        group = elastic[start : start + 2 * l + 1]
        start += 2 * l + 1
        label = "ours" if (x, l, kind) == table[0] else None
        ax.plot(l + 0.05 * (np.arange(len(group)) - l), group, ".", color=BLUE, markersize=3, label=label)
    ax.set(
        xlabel="degree l",
        ylabel="ωR/c_s",
        title=f"{len(elastic)} elastic modes of {kernel.attrs['dofs']} unknowns",
    )
    ax.legend(loc="lower right")
    bench.save(figure, "Modes of the free sphere by degree: bars in closed form, dots ours, 2l + 1 of each")
