# SPDX-License-Identifier: BSD-2-Clause
"""Families of finite elements: faces, edges, and the order of nodes in gmsh and in other programs.

Corners have the same order in gmsh, Abaqus, Nastran, VTK and, mirrored, in MED. Middle nodes do not.
Sources: gmsh reference manual, "Node ordering"; Abaqus, "Element library"; MED 3, "Numérotation des mailles".
"""
from collections.abc import Container
from typing import NamedTuple

import numpy as np

from ricochet.arrays import Array

Corners = list[tuple[int, ...]]


class Family(NamedTuple):
    """Tables by corner, numbered from 0."""

    corners: int
    faces: Corners  # S1, S2, … of Abaqus
    edges: Corners  # in the order of their middle nodes in Abaqus, VTK and MED
    gmsh_edges: Corners  # and in gmsh
    gmsh_centres: Corners  # places of the nodes that follow in gmsh's complete element of order 2
    axes: Corners  # two groups of corners each: from the first to the second run the axes of the element
    mirror: tuple[int, ...]  # the corners of the mirrored element

    def between(self, nodes: int) -> Corners:
        """The corners between which gmsh places each node of an element that is no corner."""
        return [*self.gmsh_edges, *self.gmsh_centres][: nodes - self.corners]


TETRAHEDRON = Family(
    4,
    [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
    [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)],
    [(0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)],
    [],
    [(0,), (1,), (0,), (2,), (0,), (3,)],
    (0, 2, 1, 3),
)
WEDGE = Family(
    6,
    [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)],
    [(0, 1), (1, 2), (0, 2), (3, 4), (4, 5), (3, 5), (0, 3), (1, 4), (2, 5)],
    [(0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)],
    [(0, 1, 3, 4), (0, 2, 3, 5), (1, 2, 4, 5)],
    [(0, 3), (1, 4), (0, 3), (2, 5), (0, 1, 2), (3, 4, 5)],
    (0, 2, 1, 3, 5, 4),
)
BRICK = Family(
    8,
    [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
    [(0, 1), (1, 2), (2, 3), (0, 3), (4, 5), (5, 6), (6, 7), (4, 7), (0, 4), (1, 5), (2, 6), (3, 7)],
    [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)],
    [
        *[(0, 1, 2, 3), (0, 1, 4, 5), (0, 3, 4, 7), (1, 2, 5, 6), (2, 3, 6, 7), (4, 5, 6, 7)],
        (0, 1, 2, 3, 4, 5, 6, 7),
    ],
    [(0, 3, 4, 7), (1, 2, 5, 6), (0, 1, 4, 5), (2, 3, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7)],
    (0, 3, 2, 1, 4, 7, 6, 5),
)
# Solids by their number of nodes. Those of 15 and 20 nodes lack the nodes in the middle of quadrangles.
SOLIDS = {
    **{4: TETRAHEDRON, 10: TETRAHEDRON},
    **{6: WEDGE, 15: WEDGE, 18: WEDGE},
    **{8: BRICK, 20: BRICK, 27: BRICK},
}
COMPLETE = {15: 18, 20: 27}
# Edges by number of nodes where the middle nodes of the vertical edges come before those of the top: Nastran, CGNS.
TOP_LAST = {
    **dict.fromkeys((15, 18), [*WEDGE.edges[:3], *WEDGE.edges[6:], *WEDGE.edges[3:6]]),
    **dict.fromkeys((20, 27), [*BRICK.edges[:4], *BRICK.edges[8:], *BRICK.edges[4:8]]),
}
FACET_CORNERS = {3: 3, 6: 3, 7: 3, 4: 4, 8: 4, 9: 4}  # by the number of nodes of a facet
# Numbers of nodes of solids and of facets, by the dimension of the element.
SIZES: dict[int, Container[int]] = {3: SOLIDS, 2: FACET_CORNERS}
# Types of gmsh by number of nodes. Facets of 4 and 6 nodes differ from solids of as many.
GMSH_SOLIDS = {4: 4, 8: 5, 6: 6, 10: 11, 27: 12, 18: 13}
GMSH_FACETS = {3: 2, 4: 3, 6: 9, 9: 10}
GMSH_POINT = 15


def to_gmsh(rows: Array, edges: Corners | None = None) -> Array:
    """(T,k) solids in gmsh's order. `edges`: those of the middle nodes in the file, by default as in Abaqus."""
    family = SOLIDS[rows.shape[1]]
    order = list(range(rows.shape[1]))
    if len(order) > family.corners:
        place = {edge: family.corners + k for k, edge in enumerate(edges or family.edges)}
        order[family.corners : family.corners + len(place)] = [place[edge] for edge in family.gmsh_edges]
    return rows[:, order]


def mirrored(node: Array, rows: Array) -> Array:
    """(T) whether each element is a mirror image of gmsh's: the triple product of its mean axes is negative."""
    ends = [node[rows[:, list(group)]].mean(axis=1) for group in SOLIDS[rows.shape[1]].axes]
    x, y, z = ends[1] - ends[0], ends[3] - ends[2], ends[5] - ends[4]
    return np.einsum("tk,tk->t", np.cross(x, y), z) < 0


def mirror(rows: Array) -> Array:
    """(T,k) the mirror images of elements: other corners, and the same node between the same corners."""
    family = SOLIDS[rows.shape[1]]
    between = family.between(rows.shape[1])
    place = {places: family.corners + k for k, places in enumerate(between)}
    moved = [place[tuple(sorted(family.mirror[corner] for corner in places))] for places in between]
    return rows[:, [*family.mirror, *moved]]


def nearest(node: Array, rows: Array) -> Array:
    """(T,m) for each node that is no corner, which of them lies nearest to where the element with straight
    edges has it. In gmsh's order these are 0, 1, …, m − 1, unless edges are strongly curved."""
    family = SOLIDS[rows.shape[1]]
    places = family.between(rows.shape[1])
    straight = np.stack([node[rows[:, list(corners)]].mean(axis=1) for corners in places], axis=1)
    given = node[rows[:, family.corners :]]
    found = np.empty(straight.shape[:2], np.int64)
    for k in range(len(places)):
        found[:, k] = np.argmin(((given - straight[:, k, None]) ** 2).sum(axis=2), axis=1)
    return found


def face_nodes(size: int, face: tuple[int, ...]) -> list[int]:
    """The nodes of a face of a complete solid of `size` nodes in the order of gmsh's facet."""
    family = SOLIDS[size]
    place = {places: family.corners + k for k, places in enumerate(family.between(size))}
    edges = [tuple(sorted(pair)) for pair in zip(face, face[1:] + face[:1])]
    wanted = [*edges, tuple(sorted(face))] if size > family.corners else []
    return [*face, *(place[corners] for corners in wanted if corners in place)]
