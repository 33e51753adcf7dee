# SPDX-License-Identifier: BSD-2-Clause
"""A box of eight-node bricks, assembled with numpy alone, and the same bricks as a gmsh mesh. Reads and writes matrices."""

import itertools

import numpy as np

MATERIAL = {"density": 2.0, "young": 3.0, "poisson": 0.3}
CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])


class Box:
    """A box of `size` with `cells` bricks along each axis. Nodes inside and on the sides are slightly displaced, so that
    nothing is symmetric. The foot z = 0 remains flat."""

    def __init__(self, size=(1.0, 0.7, 0.5), cells=(3, 2, 2)):
        points = [np.linspace(0, length, n + 1) for length, n in zip(size, cells)]
        self.node = np.array([(x, y, z) for z in points[2] for y in points[1] for x in points[0]])
        self.node[:, :2] += 0.04 * np.sin(3 * self.node[:, [2, 0]] + self.node[:, [1, 2]])
        counts = [n + 1 for n in cells]

        def number(i, j, k):
            return i + counts[0] * (j + counts[1] * k)

        self.brick = np.array(
            [
                [number(*(np.array((i, j, k)) + corner)) for corner in CORNERS]
                for k, j, i in itertools.product(*(range(n) for n in reversed(cells)))
            ]
        )
        plane = list(itertools.product(range(cells[1]), range(cells[0])))
        self.foot = np.array(
            [
                [number(i, j, 0), number(i, j + 1, 0), number(i + 1, j + 1, 0), number(i + 1, j, 0)]
                for j, i in plane
            ]
        )
        self.top = np.array(
            [
                [
                    number(i, j, cells[2]),
                    number(i + 1, j, cells[2]),
                    number(i + 1, j + 1, cells[2]),
                    number(i, j + 1, cells[2]),
                ]
                for j, i in plane
            ]
        )

    def matrices(self):
        """K and M (3n,3n) with the rows 3 node + component: ε = sym ∇u, σ = λ tr ε + 2μ ε, by Gauss quadrature."""
        density, young, poisson = MATERIAL.values()
        lame, shear = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
        elastic = np.diag([2 * shear] * 3 + [shear] * 3)
        elastic[:3, :3] += lame
        place, weight = np.polynomial.legendre.leggauss(4)
        n = 3 * len(self.node)
        stiffness, mass = np.zeros((n, n)), np.zeros((n, n))
        sign = 2 * CORNERS - 1
        for nodes in self.brick:
            rows = (3 * nodes[:, None] + np.arange(3)).ravel()
            for a, b, c in itertools.product(range(4), repeat=3):
                at = place[[a, b, c]]
                factor = (1 + sign * at) / 2
                value = factor.prod(axis=1)
                slope = np.stack(
                    [sign[:, d] / 2 * np.delete(factor, d, axis=1).prod(axis=1) for d in range(3)]
                )
                jacobian = slope @ self.node[nodes]
                volume = np.linalg.det(jacobian) * weight[a] * weight[b] * weight[c]
                gradient = np.linalg.solve(jacobian, slope)
                strain = np.zeros((6, 24))
                for d in range(3):
                    strain[d, d::3] = gradient[d]
                for row, (d, e) in enumerate([(0, 1), (1, 2), (0, 2)], 3):
                    strain[row, d::3], strain[row, e::3] = gradient[e], gradient[d]
                stiffness[np.ix_(rows, rows)] += volume * strain.T @ elastic @ strain
                mass[np.ix_(rows, rows)] += volume * density * np.kron(np.outer(value, value), np.eye(3))
        return stiffness, mass

    def gmsh(self):
        """The same bricks with their foot and top as a .msh file of version 2.2."""
        lines = [
            "$MeshFormat",
            "2.2 0 8",
            "$EndMeshFormat",
            "$PhysicalNames",
            "3",
            '2 1 "foot"',
            '2 2 "top"',
            '3 3 "body"',
            "$EndPhysicalNames",
            "$Nodes",
            str(len(self.node)),
        ]
        lines += [f"{k} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(self.node.tolist(), 1)]
        elements = (
            [(3, 1, nodes) for nodes in self.foot]
            + [(3, 2, nodes) for nodes in self.top]
            + [(5, 3, nodes) for nodes in self.brick]
        )
        lines += ["$EndNodes", "$Elements", str(len(elements))]
        lines += [
            f"{k} {kind} 2 {group} {group} " + " ".join(str(node + 1) for node in nodes)
            for k, (kind, group, nodes) in enumerate(elements, 1)
        ]
        return "\n".join([*lines, "$EndElements", ""])


def matrix_market(matrix, symmetric=True):
    """The matrix as Matrix Market text; the lower triangle if it is symmetric."""
    rows, columns = np.nonzero(np.tril(matrix) if symmetric else matrix)
    lines = [f"{i + 1} {j + 1} {float(matrix[i, j])!r}" for i, j in zip(rows.tolist(), columns.tolist())]
    kind = "symmetric" if symmetric else "general"
    return "\n".join(
        [
            f"%%MatrixMarket matrix coordinate real {kind}",
            "% made by a test",
            f"{len(matrix)} {len(matrix)} {len(lines)}",
            *lines,
            "",
        ]
    )


def listed(numbers):
    return "\n".join(" ".join(map(repr, row)) for row in np.atleast_2d(numbers).tolist()) + "\n"


def dense(matrix):
    """The dense matrix from compressed rows of FCLIB."""
    full = np.zeros((matrix["m"][0], matrix["n"][0]))
    start = matrix["p"][:]
    rows = np.repeat(np.arange(start.size - 1), np.diff(start))
    full[rows, matrix["i"][:]] = matrix["x"][:]
    return full
