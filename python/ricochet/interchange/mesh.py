# SPDX-License-Identifier: BSD-2-Clause
"""Meshes of other programs: solids in gmsh's order, with groups of solids, of faces and of nodes."""
import itertools
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange import elements
from ricochet.interchange.elements import SOLIDS, Corners

FARTHEST = 1e30  # as for numbers of a scene
SECOND_ORDER = 10  # least number of nodes of a solid of order 2; those of order 1 have at most 8


@dataclass
class Mesh:
    """Nodes and solids are counted from 0. `number`s are those of the file, and stay in the .msh."""

    path: Path
    node: Array  # (n,3)
    node_number: Array  # (n)
    solids: dict[int, Array]  # by number of nodes k: (T,k) nodes
    solid_number: Array  # of all solids, block after block
    solid_groups: dict[str, Array] = field(default_factory=dict)  # places in solid_number
    facet_groups: dict[str, Array] = field(default_factory=dict)  # (F,4) corners, −1 behind a triangle
    node_groups: dict[str, Array] = field(default_factory=dict)  # nodes
    edges: dict[int, Corners] = field(default_factory=dict)  # of the middle nodes, if not those of Abaqus
    oriented: bool = True  # whether another order than that of the format is worth a warning
    warnings: list[str] = field(default_factory=list)

    def warn(self, text: str) -> None:
        self.warnings.append(f"{self.path.name}: {text}")

    def numbers_of(self, size: int) -> Array:
        """The numbers of the solids of one block."""
        before = itertools.takewhile(lambda k: k != size, self.solids)
        start = sum(len(self.solids[k]) for k in before)
        return self.solid_number[start : start + len(self.solids[size])]

    def nodes_of(self, solids: Array) -> Array:
        """The nodes of some solids, ascending."""
        wanted = np.zeros(len(self.solid_number), bool)
        wanted[solids] = True
        ends = np.cumsum([len(rows) for rows in self.solids.values()])
        blocks = zip(self.solids.values(), np.split(wanted, ends[:-1]))
        return np.unique(np.concatenate([rows[here].ravel() for rows, here in blocks]))

    def check(self) -> None:
        """Refuses what no body can be made of. Raises InputError."""
        if not any(map(len, self.solids.values())):
            raise InputError(
                f"{self.path}: holds no tetrahedra, hexahedra or prisms: export the volume elements as well"
            )
        if (wrong := np.flatnonzero(~(np.abs(self.node) < FARTHEST).all(axis=1))).size:
            place = " ".join(f"{x:g}" for x in self.node[wrong[0]])
            raise InputError(
                f"{self.path}: node {self.node_number[wrong[0]]} is at {place}: coordinates must be below {FARTHEST:g}"
            )
        sizes = sorted(self.solids)
        if sizes[0] < SECOND_ORDER <= sizes[-1]:
            raise InputError(
                f"{self.path}: has solids of {sizes[0]} and of {sizes[-1]} nodes: mesh with elements of one order"
            )
        for small, large in elements.COMPLETE.items():
            if {small, large} <= set(sizes):
                raise InputError(
                    f"{self.path}: has solids of {small} and of {large} nodes: mesh with one of both kinds"
                )
        for size, rows in self.solids.items():
            ordered = np.sort(rows, axis=1)
            twice = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
            if twice.size:
                raise InputError(
                    f"{self.path}: element {self.numbers_of(size)[twice[0]]} names a node twice, as collapsed elements do: "
                    "mesh with tetrahedra, hexahedra or prisms instead"
                )

    def order_nodes(self) -> None:
        """Puts the nodes of all solids into gmsh's order. Mirrored elements, and middle nodes in an order that is
        not the one of the format, are found by the places of the nodes."""
        corrected = 0
        for size, rows in self.solids.items():
            rows = elements.to_gmsh(rows, self.edges.get(size))
            wrong = elements.mirrored(self.node, rows)
            if size > SOLIDS[size].corners:
                rows, moved = self.order_middle_nodes(rows)
                wrong = wrong | moved
            turned = elements.mirrored(self.node, rows)
            rows[turned] = elements.mirror(rows[turned])
            self.solids[size] = rows
            corrected += int(np.count_nonzero(wrong))
        if corrected and self.oriented:
            self.warn(
                f"the nodes of {corrected} elements were in an order in which they are inverted, and were put in gmsh's "
                "order"
            )

    def order_middle_nodes(self, rows: Array) -> tuple[Array, bool]:
        """Solids with the nodes between their corners where gmsh has them, and whether those of edges were elsewhere.
        Some elements may be curved so strongly that another node is nearer; the file has one order for all. Formats
        define the order of edges; that of centres is always found here."""
        found = elements.nearest(self.node, rows)
        own = np.arange(found.shape[1])
        if (found == own).all():
            return rows, False
        orders, count = np.unique(found, axis=0, return_counts=True)
        usual = orders[np.argmax(count)]
        if (usual == own).all() or len(set(usual.tolist())) < len(own) or 2 * count.max() < len(rows):
            return rows, False
        corners = rows.shape[1] - len(own)
        edges = len(SOLIDS[rows.shape[1]].edges)
        moved = bool((usual[:edges] != own[:edges]).any())
        return np.hstack([rows[:, :corners], rows[:, corners + usual]]), moved

    def complete(self) -> int:
        """Gives solids of 15 and 20 nodes the nodes in the middle of their quadrangles and bricks that gmsh's
        elements have. They lie where the shape functions of these solids have them, so no shape changes. A group of
        nodes that holds a whole face or solid holds the new node too. @return: number of new nodes"""
        before = len(self.node)
        sizes = [size for size in self.solids if size in elements.COMPLETE]
        # For each new node, the nodes of its face or brick, corners first.
        quadrangles, hulls = list[Array](), list[Array]()
        for size in sizes:
            for corners in SOLIDS[size].gmsh_centres:
                rows = self.solids[size][:, around(size, corners)]
                (quadrangles if len(corners) == 4 else hulls).append(rows)
        if not sizes:
            return 0
        # Two solids share the node in the middle of their common face.
        faces = np.concatenate(quadrangles)
        _, first, same = np.unique(
            np.sort(faces[:, :4], axis=1), axis=0, return_index=True, return_inverse=True
        )
        added = self.add_between(faces[first])[same.ravel()]
        centres = iter(np.split(added, np.cumsum([len(rows) for rows in quadrangles])[:-1]))
        blocks = {}
        for size, rows in self.solids.items():
            family = SOLIDS[size]
            if size in sizes:
                new = [next(centres) for corners in family.gmsh_centres if len(corners) == 4]
                new += [self.add_between(hulls.pop(0)) for corners in family.gmsh_centres if len(corners) > 4]
                rows = np.column_stack([rows, *new])
            blocks[elements.COMPLETE.get(size, size)] = rows
        self.solids = blocks
        return len(self.node) - before

    def add_between(self, rows: Array) -> Array:
        """Adds a node in the middle of each face of 8 nodes or brick of 20, corners first. @return: the new nodes"""
        corners = 4 if rows.shape[1] == 8 else 8
        # The values of the shape functions there: −1/4 at each corner, and the rest in equal shares.
        weight = np.full(rows.shape[1], (1 + corners / 4) / (rows.shape[1] - corners))
        weight[:corners] = -1 / 4
        new = len(self.node) + np.arange(len(rows))
        self.node = np.concatenate([self.node, np.einsum("k,tkc->tc", weight, self.node[rows])])
        self.node_number = np.concatenate(
            [self.node_number, self.node_number.max() + 1 + np.arange(len(rows))]
        )
        for name, nodes in self.node_groups.items():
            held = np.isin(rows, nodes).all(axis=1)
            self.node_groups[name] = np.concatenate([nodes, new[held]])
        return new


def around(size: int, corners: tuple[int, ...]) -> list[int]:
    """The corners of a face or solid of `size` nodes, and then the nodes in the middle of its edges."""
    family = SOLIDS[size]
    edges = [k for k, edge in enumerate(family.gmsh_edges, family.corners) if set(edge) <= set(corners)]
    return [*corners, *edges]
