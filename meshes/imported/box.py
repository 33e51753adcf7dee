#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Writes stiffness and mass of an aluminium box, as another finite element program would: K.mtx, M.mtx, nodes.txt, foot.txt.

Into the working folder. The box has 3 x 2 x 2 equal bricks of eight nodes. N of such a brick is a product of hats along the axes,
so that each integral over the box is a product of three over a line.
"""
import argparse

import numpy as np

argparse.ArgumentParser(description=__doc__, usage=argparse.SUPPRESS).parse_args()
DENSITY, YOUNG, POISSON = 2700.0, 70e9, 0.33  # SI, as all that follows
SIZE, CELLS = (0.03, 0.02, 0.02), (3, 2, 2)  # the foot is z = 0, about the origin


def line(length, cells):
    """∫ N N', ∫ N' N', ∫ N N over a line, the prime on the right one first: hats on equal cells."""
    h = length / cells
    slope, stiffness, mass = np.zeros((3, cells + 1, cells + 1))
    for cell in range(cells):
        both = np.s_[cell : cell + 2, cell : cell + 2]
        slope[both] += [[-1 / 2, 1 / 2], [-1 / 2, 1 / 2]]
        stiffness[both] += [[1 / h, -1 / h], [-1 / h, 1 / h]]
        mass[both] += [[h / 3, h / 6], [h / 6, h / 3]]
    return slope, stiffness, mass


lines = [line(length, cells) for length, cells in zip(SIZE, CELLS)]


def integral(a=None, b=None):
    """∫ ∂N_i/∂x_a ∂N_j/∂x_b; None: no derivative. Nodes are numbered along x first, then y, then z."""

    def along(axis):
        slope, stiffness, mass = lines[axis]
        return (stiffness if a == b else slope.T if axis == a else slope) if axis in (a, b) else mass

    return np.kron(along(2), np.kron(along(1), along(0)))


lame, shear = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
laplace = sum(integral(a, a) for a in range(3))
nodes = len(laplace)
stiffness, mass = np.zeros((2, 3 * nodes, 3 * nodes))
for a in range(3):
    mass[a::3, a::3] = DENSITY * integral()
    for b in range(3):
        stiffness[a::3, b::3] = lame * integral(a, b) + shear * integral(b, a) + (a == b) * shear * laplace

for name, matrix in (("K.mtx", stiffness), ("M.mtx", mass)):
    rows, columns = np.nonzero(np.tril(matrix))
    with open(name, "w") as file:
        file.write(f"%%MatrixMarket matrix coordinate real symmetric\n{3 * nodes} {3 * nodes} {rows.size}\n")
        file.writelines(f"{i + 1} {j + 1} {float(matrix[i, j])!r}\n" for i, j in zip(rows, columns))

x, y, z = (np.linspace(0, length, cells + 1) for length, cells in zip(SIZE, CELLS))
np.savetxt("nodes.txt", [(i - SIZE[0] / 2, j - SIZE[1] / 2, k) for k in z for j in y for i in x])
across, deep = CELLS[0] + 1, CELLS[1] + 1
corners = [i + across * j for j in range(deep - 1) for i in range(across - 1)]
np.savetxt(
    "foot.txt", [(c + 1, c + across + 1, c + across + 2, c + 2) for c in corners], fmt="%d"
)  # from below: counter-clockwise
