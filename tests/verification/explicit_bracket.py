# SPDX-License-Identifier: BSD-2-Clause
"""A steel bracket that falls on an edge, with default settings, compared with explicit spectral elements.

    scripts/verify --bracket [--out DIR] [--ranks N]  # about 8 minutes

The oracle has no modes, patches, residual flexibilities or implicit steps. It is linear elasticity in the initial axes by
hexahedra with the nodes of Gauss, Lobatto and Legendre, whose mass is diagonal (Komatitsch & Tromp 1999, Geophys. J. Int.
139, 806), and by central differences. A node that a step would take below the floor gets the force that takes it to the
floor (Carpenter, Taylor & Katona 1991, Int. J. Numer. Meth. Eng. 32, 103); the energy that it loses vanishes as elements become
smaller. First, a rod that falls on its end is compared with Saint-Venant: its force is ρcAv and its impulse 2mv.

The bracket is 60 × 40 × 60 mm, 5 mm thick and turned by 10° about y. It touches the floor several times within 350 µs, and its
centre of mass still falls thereafter: the restitution is negative. Half of it is computed, up to its plane of symmetry. The
contact is some µm wide, and its flexibility grows with the logarithm of the size of larger elements, so elements at the edge
that lands are divided six times by 3. Those smaller than a given length have the density by which their stable step is that
of this length; elements around them lose as much mass.

The last run is the reference; its uncertainty is the root of the sum of squares of what each refinement changed. The status
is 1 if Ricochet differs by more than its own estimate, or if the rod is off by more than 1 %. Units are SI. Prints Markdown.
"""
import itertools
import json
import math
import time
from pathlib import Path

import numpy as np
from numpy.polynomial import Legendre, legendre
from scipy.sparse import csr_array

from ricochet import programs
from ricochet.programs import ROOT

STEEL = {"density": 7850.0, "young": 210e9, "poisson": 0.3}
LEG, DEPTH, THICK = 60e-3, 40e-3, 5e-3
TURN, SPEED, GAP, DURATION = 10, 0.5, 31.1e-6, 6e-4
SHARE, ROD_BOUND = 0.8, 0.01
# Element size [mm], order, divisions at the inner edge and at the edge that lands, smallest elements [mm] of the density of
# steel, step relative to SHARE of the longest stable one.
BASE, REFERENCE = (5, 3, 0, 0, 0, 1), (5, 3, 1, 6, 0.1, 1)
REFINEMENTS = [
    (BASE, (5, 3, 0, 0, 0, 0.5)),
    (BASE, (5, 4, 0, 0, 0, 1)),
    (BASE, (2.5, 3, 0, 0, 0, 1)),
    ((5, 3, 1, 1, 0, 1), (5, 3, 2, 1, 0, 1)),
    ((5, 3, 1, 6, 0.3, 1), REFERENCE),
]
GEO = f"""SetFactory("OpenCASCADE");
Box(1) = {{0, 0, 0, {LEG}, {DEPTH}, {THICK}}};
Box(2) = {{0, 0, 0, {THICK}, {DEPTH}, {LEG}}};
BooleanUnion(3) = {{ Volume{{1}}; Delete; }}{{ Volume{{2}}; Delete; }};
Physical Volume("body") = {{3}};
Physical Surface("skin") = Surface{{:}};
Mesh.MeshSizeMax = {THICK};
"""
SCENE = f"""title = "bracket"
obstacles.floor.normal = [0, 0, 1]
contact = {{ between = ["bracket", "floor"], direction = [0, 0, -1], gap = {GAP} }}
time = {{ duration = {DURATION}, rate_hz = 1e6 }}
[bodies.bracket]
mesh = "bracket.geo"
material = {programs.toml(STEEL)}
rotate_deg = [0, {TURN}, 0]
translate = [0, 0, 0.2]
velocity = [0, 0, -{SPEED}]
contact = "skin"
"""


def product(a, b, c):
    return np.kron(np.kron(a, b), c)


class Solid:
    """Layers of hexahedra along y, above quadrilaterals (e,2,2,2) of the plane x z: by index along x and z, coordinates."""

    def __init__(self, quadrilaterals, depth, layers, order, density, young, poisson):
        top, n, one = Legendre.basis(order), (order + 1) ** 3, np.eye(order + 1)
        x = np.concatenate([[-1.0], top.deriv().roots().real, [1.0]])
        weight = 2 / (order * (order + 1) * top(x) ** 2)
        # Slopes at node k of the polynomial that is 1 at node l.
        slope = np.stack([Legendre.basis(k).deriv()(x) for k in range(order + 1)], axis=1)
        slope = slope @ np.linalg.inv(legendre.legvander(x, order))
        gradient = np.stack([product(slope, one, one), product(one, slope, one), product(one, one, slope)])
        hat = np.stack([1 - x, 1 + x], axis=1) / 2
        plane = np.einsum("xi,zj,eijk->exzk", hat, hat, quadrilaterals)[:, :, None].repeat(order + 1, axis=2)
        line = np.broadcast_to(depth / layers * hat[:, 1, None], plane.shape[:-1])
        place = np.stack([plane[..., 0], line, plane[..., 1]], axis=-1).reshape(-1, n, 3)

        jacobian = np.einsum("bpq,eqk->epkb", gradient, place)
        volume = np.linalg.det(jacobian) * product(weight, weight, weight)
        gradient = np.einsum("epbk,bpq->ekpq", np.linalg.inv(jacobian), gradient)
        pairs = np.einsum("eapq,ep,ebpr->eabqr", gradient, volume, gradient, optimize=True)
        shear, lame = young / 2 / (1 + poisson), young * poisson / (1 + poisson) / (1 - 2 * poisson)
        stiffness = lame * pairs + shear * pairs.swapaxes(1, 2)
        for k in range(3):
            stiffness[:, k, k] += shear * np.einsum("eaaqr->eqr", pairs)
        stiffness = stiffness.swapaxes(2, 3).reshape(-1, 3 * n, 3 * n)

        place = (place[:, :, None] + depth / layers * np.arange(layers)[:, None] * [0, 1, 0]).reshape(-1, 3)
        grid = np.round(place * 1e10 / math.pi)  # so that no node is in the middle between two integers
        _, first, nodes = np.unique(grid, axis=0, return_index=True, return_inverse=True)
        self.points, nodes = place[first], nodes.reshape(-1, n, layers)
        mass = np.reshape(density, (-1, 1)) * volume
        self.mass = np.bincount(nodes.ravel(), mass.repeat(layers))
        # Entries that are 0 but for round-off are left out.
        element, i, j = np.nonzero(abs(stiffness) > 1e-13 * abs(stiffness).max())
        degrees = np.concatenate([3 * nodes + k for k in range(3)], axis=1)
        places = degrees[element, i].ravel(), degrees[element, j].ravel()
        self.stiffness = csr_array((stiffness[element, i, j].repeat(layers), places))

    def force(self, u):
        return -(self.stiffness @ u.ravel()).reshape(u.shape)

    def stable_step(self):
        u = np.random.default_rng(1).standard_normal(self.points.shape)
        for _ in range(200):
            u = self.force(u / np.linalg.norm(u)) / self.mass[:, None]
        return 2 / math.sqrt(np.linalg.norm(u))


def fall(solid, normal, speed, gap, duration, share, held=()):
    """Step, impulse of each step, mean normal velocity at the end, and the share of the energy that is lost, for a fall
    on a plane. `held` nodes do not move along y."""
    steps = math.ceil(duration / share / solid.stable_step())
    step, height = duration / steps, solid.points @ normal
    height += gap - height.min()
    u, impulse = np.zeros(solid.points.shape), np.zeros(steps)
    v, rate = u - speed * normal, u + step / solid.mass[:, None]
    rate[held, 1] = 0
    for i in range(steps):
        v += rate * solid.force(u)
        push = np.maximum(-(height + (u + step * v) @ normal) / step, 0)
        v += push[:, None] * normal
        u += step * v
        impulse[i] = solid.mass @ push
    energy = solid.mass @ (v**2).sum(axis=1) - ((u - step * v) * solid.force(u)).sum()  # twice it
    mass = solid.mass.sum()
    return step, impulse, solid.mass @ v @ normal / mass, 1 - energy / mass / speed**2


def divided(square, corner, divisions):
    """Parts of a square (2,2,2), the smallest of which, of 3^-divisions of its size, is at this corner."""
    for _ in range(divisions):
        inner = square[corner] + (square - square[corner]) / 3
        for axis, side in enumerate(corner):
            part = square.copy()
            part.swapaxes(0, axis)[side] = inner.swapaxes(0, axis)[1 - side]
            yield part
        square = inner
    yield square


def explicit(size, order, inner, landing, smallest, share):
    """Restitution, impulse, step, and the share of the energy that is lost."""
    leg, thick, turn = round(LEG / size), round(THICK / size), math.radians(TURN)
    divisions = {(thick, thick - 1): ((0, 1), inner), (thick - 1, thick): ((1, 0), inner)}
    divisions |= {(thick - 1, thick - 1): ((1, 1), inner), (leg - 1, 0): ((1, 0), landing)}
    squares = []
    for cell in itertools.product(range(leg), repeat=2):
        if min(cell) < thick:
            square = size * (np.array(cell) + np.moveaxis(np.indices((2, 2)), 0, -1))
            if cell == (leg - 1, 0):
                around = slice(len(squares), len(squares) + 2)  # its largest parts
            squares += divided(square, *divisions.get(cell, (None, 0)))
    squares = np.array(squares)
    sides = np.concatenate([squares[:, 0] - squares[:, 1], squares[:, :, 0] - squares[:, :, 1]], axis=1)
    density = np.maximum(1, (smallest / np.linalg.norm(sides, axis=-1).min(axis=1)) ** 2)
    across = np.stack([squares[:, 1, 1] - squares[:, 0, 0], squares[:, 0, 1] - squares[:, 1, 0]], axis=1)
    area = np.linalg.det(across) / 2
    density[around] -= (density - 1) @ area / area[around].sum()
    steel = STEEL | {"density": STEEL["density"] * density}
    solid = Solid(squares, DEPTH / 2, round(DEPTH / 2 / size), order, **steel)
    held, normal = solid.points[:, 1] > 0.499 * DEPTH, np.array([-math.sin(turn), 0, math.cos(turn)])
    step, impulse, velocity, lost = fall(solid, normal, SPEED, GAP, DURATION, share, held)
    return velocity / SPEED, 2 * impulse.sum(), step, lost


def rod():
    """Relative errors of the force, in the middle of its duration, and of the impulse of a rod that falls on its end."""
    side, length, speed, steel = 10e-3, 0.2, 1.0, STEEL | {"poisson": 0}
    levels = length / 20 * (np.arange(20)[:, None, None] + np.indices((2, 2))[1])
    squares = np.stack([np.broadcast_to(side * np.indices((2, 2))[0], levels.shape), levels], axis=-1)
    wave = math.sqrt(steel["young"] / steel["density"])
    force, duration = steel["density"] * wave * side**2 * speed, 2 * length / wave
    solid, up = Solid(squares, side, 1, 4, **steel), np.array([0, 0, 1.0])
    step, impulse, *_ = fall(solid, up, speed, 0.0, 1.5 * duration, SHARE)
    middle = impulse[round(0.1 * duration / step) : round(0.9 * duration / step)].mean() / step
    return middle / force - 1, impulse.sum() / (force * duration) - 1


def default_settings(folder, ranks):
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "bracket.toml"
    scene.write_text(SCENE)
    (folder / "bracket.geo").write_text(GEO)
    programs.kernel(scene, ["--quiet", "--out", folder], ranks)
    programs.contact(scene, ["--quiet", "--out", folder])
    return json.loads((folder / "bracket.summary.json").read_text())


def add_arguments(parser):
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "bracket", help="(default: out/bracket)")
    parser.add_argument("--ranks", type=int, default=2, help="ranks of ricochet-kernel (default: 2)")


def row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |", flush=True)


def run(given):
    summary, of_rod, found = default_settings(given.out, given.ranks), rod(), {}
    print("Rod: the force differs by {:+.2%}, the impulse by {:+.2%}.\n".format(*of_rod))
    row(
        "elements",
        "order",
        "inner",
        "landing",
        "steel from",
        "step",
        "restitution",
        "impulse",
        "lost",
        "seconds",
    )
    row(*10 * ["---"])
    for setting in itertools.chain(*REFINEMENTS):
        if setting not in found:
            (size, order, inner, landing, smallest, share), start = setting, time.monotonic()
            *values, step, lost = explicit(size / 1e3, order, inner, landing, smallest / 1e3, share * SHARE)
            cells = f"{values[0]:.5f}", f"{values[1]:.6f}", f"{lost:.2%}", f"{time.monotonic() - start:.0f}"
            row(f"{size} mm", order, inner, landing, f"{smallest} mm", f"{step * 1e6:.4f} µs", *cells)
            found[setting] = np.array(values)
    reference, changes = found[REFERENCE], [found[one] - found[other] for one, other in REFINEMENTS]
    uncertainty = np.linalg.norm(changes, axis=0)
    estimated, impulse = summary["error_estimate"]["quantities"], summary["impulse_ns"]
    errors = np.array([summary["restitution"], impulse]) - reference
    estimates = np.array([estimated["rebound"]["total"], estimated["impulse"]["total"] * impulse])
    within = abs(errors) <= estimates
    print()
    row("quantity", "explicit", "uncertainty", "Ricochet", "difference", "estimate", "verdict")
    row(*7 * ["---"])
    for k, name in enumerate(("restitution", "impulse")):
        numbers = reference[k], uncertainty[k], reference[k] + errors[k], errors[k], estimates[k]
        cells = (f"{number:.5f}" for number in numbers)
        row(name, *cells, f"{'within' if within[k] else 'BEYOND'} the estimate")
    return 0 if within.all() and max(map(abs, of_rod)) <= ROD_BOUND else 1
