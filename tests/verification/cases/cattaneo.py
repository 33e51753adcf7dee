# SPDX-License-Identifier: BSD-2-Clause
"""Two equal steel hemispheres are pressed together and sheared back and forth, at rest (`meshes/hertz/sheared-domes.toml`). An annulus slips
around a circle that sticks. Mindlin's displacement is that of distant points of half-spaces; the hemispheres are held at their bases,
whose own flexibility adds a share of about 3 a/R. Two contact radii a are therefore computed, with meshes in proportion: the
compliance of all points that stick is extrapolated to a/R = 0. The heat of a cycle does not depend on the flexibility of the bases."""
import shutil

import numpy as np

import hertz_theory as hertz
import mindlin
from case import BLUE, GREY, ORANGE
from ricochet.programs import ROOT

TITLE = "Cattaneo and Mindlin: sheared contact of spheres"
SOURCE = "Cattaneo 1938; Mindlin 1949; Mindlin & Deresiewicz 1953; as in Johnson 1985, *Contact Mechanics*, sections 7.2 and 7.4."
RESTS_ON = "theory"
LONG = True
MODULUS, CURVATURE, FRICTION = hertz.MODULUS / 2, hertz.RADIUS / 2, 0.3
COMPLIANCE = mindlin.compliance(*2 * [(hertz.YOUNG, hertz.POISSON)])
HALVES = 2  # half of each hemisphere is meshed
ELEMENTS = 8 / 1.28  # across the contact radius


class Sheared:
    """Rows of a run at its knots: forces [N] on the whole, motion of the base [m], heat [J] and states."""

    def __init__(self, bench, ratio, friction, shear):
        """`shear` [m] of the base after the press, which gives the contact radius `ratio` times R."""
        a = ratio * hertz.RADIUS
        folder = ROOT / "meshes" / "hertz"
        for name in ("half-dome.geo", "sheared-domes.toml"):
            shutil.copy(folder / name, bench.folder)
        bench.write("press.csv", f"0,0\n1,{(ratio / 0.005) ** 2!r}\n")
        steps = "".join(f"{2 + k},{x / 1.2e-7!r}\n" for k, x in enumerate(shear))
        bench.write("shear.csv", "0,0\n1,0\n" + steps)
        mesh = f"{{reach={1.28 * a!r},size={a / ELEMENTS!r}}}"
        result = bench.impact(
            bench.folder / "sheared-domes.toml",
            f"contact.friction={friction}",
            "contact.increments=1",
            *(f"bodies.{body}.geometry={mesh}" for body in ("upper", "lower")),
        )
        self.shear = np.array([0, *shear])
        self.normal = HALVES * result.force.sum(axis=1)
        self.tangential = HALVES * result.tangential_force[:, :, 0].sum(axis=1)
        self.heat = HALVES * result.energy["friction"][1:]  # without the row of t = 0, before contact
        self.state = result.state
        self.distance = np.hypot(*result.point_a[:, :2].T)
        self.spacing = np.sqrt(np.median(result.area))
        self.load = self.normal[-1]
        self.a = hertz.radius(self.load, MODULUS, CURVATURE)


def run(bench):
    stuck = {}
    for ratio in (0.005, 0.01):
        rows = Sheared(bench, ratio, 1.0, [1e-9])
        force = rows.tangential[1] - rows.tangential[0]
        stuck[rows.a / hertz.RADIUS] = 1e-9 / force * rows.a / COMPLIANCE
    (small, at_small), (large, at_large) = stuck.items()
    of_bases = (at_large - at_small) / (large - small)
    bench.compare(
        "tangential compliance a/C δ/T where all points stick, extrapolated to a/R = 0",
        at_small - of_bases * small,
        1.0,
        0.01,
        "first-order patches, six elements across the contact radius",
    )

    a = 0.005 * hertz.RADIUS
    load = 4 / 3 * MODULUS * a**3 / CURVATURE
    peak = 0.8 * FRICTION * load
    end = mindlin.displacement(peak, load, FRICTION, a, COMPLIANCE)
    end += of_bases * COMPLIANCE / hertz.RADIUS * peak
    up, down = np.linspace(0, end, 7)[1:], np.linspace(end, -end, 13)[1:]
    rows = Sheared(bench, 0.005, FRICTION, [*up, *down, *-down])
    force = rows.tangential - rows.tangential[0]
    limit = FRICTION * rows.load
    first, last = len(up), len(rows.shear) - 1

    measured, exact = [], mindlin.stick_radius(force[1 : first + 1], rows.load, FRICTION)
    for state in rows.state[1 : first + 1]:
        measured.append(rows.distance[state == 1].max() / rows.a)
    for k in (1, 3, 5):
        bench.compare(
            f"stick radius c/a at T = {force[1 + k] / limit:.2f} μN",
            measured[k],
            float(exact[k]),
            rows.spacing / rows.a,
            "the candidate spacing",
            absolute=True,
        )
    amplitude = (force[first] - force[first + len(down)]) / 2
    bench.compare(
        f"heat of a cycle between ±{amplitude / limit:.2f} μN (nJ)",
        1e9 * (rows.heat[last] - rows.heat[first]),
        1e9 * mindlin.loop_energy(amplitude, rows.load, FRICTION, rows.a, COMPLIANCE),
        0.02,
        "first-order patches at the edge of the sticking circle; 2.6 % with elements of 8/5 of the size",
    )
    bench.compare(
        "area of the loop ∮ T dδ over the heat",
        np.trapz(force[first:], rows.shear[first:]) / (rows.heat[last] - rows.heat[first]),
        1.0,
        0.02,
        "the trapezoidal rule over 24 knots",
        rests_on="ourselves",
    )

    figure, axes = bench.figure(columns=2)
    own = of_bases * COMPLIANCE / hertz.RADIUS
    t = np.linspace(-amplitude, amplitude, 200)
    arguments = (rows.load, FRICTION, rows.a, COMPLIANCE)
    for x, y in (
        (mindlin.displacement(t[t >= 0], *arguments) + own * t[t >= 0], t[t >= 0]),
        (mindlin.unloading(t, amplitude, *arguments) + own * t, t),
        (mindlin.reloading(t, amplitude, *arguments) + own * t, t),
    ):
        axes[0].plot(x * 1e9, y / limit, color=BLUE, linewidth=1)
    axes[0].plot(rows.shear * 1e9, force / limit, "o", color=ORANGE, markersize=3)
    axes[0].set(xlabel="δ (nm)", ylabel="T / μN", title="Lines: Mindlin and Deresiewicz; circles: ours")
    fine = np.linspace(0, 0.999, 200)
    axes[1].plot(fine, np.cbrt(1 - fine), color=BLUE, linewidth=1)
    axes[1].plot(force[1 : first + 1] / limit, measured, "o", color=ORANGE, markersize=4)
    axes[1].fill_between(
        fine,
        np.cbrt(1 - fine) - rows.spacing / rows.a,
        np.cbrt(1 - fine) + rows.spacing / rows.a,
        color=GREY,
        alpha=0.2,
    )
    axes[1].set(
        xlabel="T / μN", ylabel="c / a", ylim=(0, 1.1), title="Farthest sticking point; band: the spacing"
    )
    bench.save(figure, "Two hemispheres under constant load, sheared back and forth")
