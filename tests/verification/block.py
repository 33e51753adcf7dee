# SPDX-License-Identifier: BSD-2-Clause
"""A box of n × n × n equal bricks of order p, built from products of one-dimensional piecewise polynomials. The small dense
matrices describe the same discrete space as Ricochet but share no code, quadrature or node numbering with it."""
import numpy as np
from numpy.polynomial import legendre

from ritz import isotropic, stiffness_of

GEO = """
SetFactory("Built-in");
DefineConstant[a = 1, b = 1, c = 1, n = 2];
Point(1) = {0, 0, 0}; Point(2) = {a, 0, 0}; Point(3) = {a, b, 0}; Point(4) = {0, b, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1:4} = n + 1; Transfinite Surface{1}; Recombine Surface{1};
box[] = Extrude {0, 0, c} { Surface{1}; Layers{n}; Recombine; };
Physical Volume("box") = {box[1]};
Physical Surface("foot") = {1};
Physical Surface("top") = {box[0]};
Physical Surface("x sides") = {box[3], box[5]};
Physical Surface("y sides") = {box[2], box[4]};
"""

# Frequencies alone need no contact.
SCENE = """[bodies.box]
mesh = "box.geo"
order = 5
material = {{ density = {density}, young = {young}, poisson = {poisson} }}
[modes]
count = {count}
residual_flexibility = false
"""


def lagrange(order, x):
    """Lagrange polynomials on equal nodes of [0, 1] and their derivatives at x: (order + 1, len(x)) each."""
    nodes = np.linspace(0, 1, order + 1)
    coefficients = np.linalg.inv(np.vander(nodes, increasing=True)).T
    powers = np.arange(order + 1)
    values = coefficients @ np.array([x**k for k in powers])
    return values, coefficients @ np.array([k * x ** max(k - 1, 0) for k in powers])


class Line:
    """One dimension: integrals of products of the functions and their slopes, and of their products with hats on all nodes."""

    def __init__(self, length, elements, order):
        size, h = elements * order + 1, length / elements
        self.node = np.linspace(0, length, size)
        self.table = {pair: np.zeros((size, size)) for pair in ("00", "01", "10", "11")}
        self.hat = np.zeros((size, size))  # ∫ hat_i f_j
        point, weight = legendre.leggauss(order + 2)
        for e in range(elements):
            at = slice(e * order, e * order + order + 1)
            # Hats have a kink at each node, so each part between two nodes has its own quadrature rule.
            for part in range(order):
                x = (part + (point + 1) / 2) / order
                w = weight / 2 / order * h
                value, slope = lagrange(order, x)
                slope = slope / h
                for a, f in enumerate((value, slope)):
                    for b, g in enumerate((value, slope)):
                        self.table[f"{a}{b}"][at, at] += (f * w) @ g.T
                rising = (point + 1) / 2
                first = e * order + part
                self.hat[first, at] += value @ (w * (1 - rising))
                self.hat[first + 1, at] += value @ (w * rising)


class Block:
    """Mass, stiffness, and unit normal loads on the hats of the top face. Unknowns: components, then nodes, z fastest."""

    def __init__(self, sides, elements, order, density, young, poisson, clamped=False):
        lines = [Line(side, elements, order) for side in sides]

        def product(a, b):
            pairs = [f"{int(a == axis)}{int(b == axis)}" for axis in "xyz"]
            tables = [line.table[pair] for line, pair in zip(lines, pairs)]
            return np.kron(np.kron(tables[0], tables[1]), tables[2])

        scalar = density * product("0", "0")
        count = len(scalar)
        stiffness = stiffness_of(
            lambda a, b, rows, columns: product(a, b), isotropic(young, poisson), [range(count)] * 3
        )
        x, y = (line.node for line in lines[:2])
        self.node = np.array([(a, b) for a in x for b in y])
        load = np.kron(lines[0].hat, lines[1].hat)
        self.area = load.sum(axis=1)  # the functions sum to one
        top = np.zeros(len(lines[2].node))
        top[-1] = 1
        normal = np.kron(load / self.area[:, None], top).T
        loads = np.zeros((3 * count, normal.shape[1]))
        loads[2 * count :] = normal
        free = np.ones(count, bool)
        if clamped:
            free[:: len(lines[2].node)] = False  # the nodes at z = 0
        free = np.flatnonzero(np.tile(free, 3))
        self.stiffness, self.loads = stiffness[np.ix_(free, free)], loads[free]
        self.mass = np.kron(np.eye(3), scalar)[np.ix_(free, free)]

    def rows(self, node):
        """Indices of the block's candidates at the positions (x, y, …)."""
        distance = np.abs(self.node[:, None, :] - np.asarray(node)[None, :, :2]).max(axis=2)
        found = distance.argmin(axis=0)
        assert distance.min(axis=0).max() < 1e-9 * self.node.max()
        return found
