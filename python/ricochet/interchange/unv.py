# SPDX-License-Identifier: BSD-2-Clause
"""Universal files of I-deas, as Salome and others write them: nodes, elements and groups.

Source: SDRC universal file datasets 781 and 2411 (nodes), 780 and 2412 (elements), 2467 and its predecessors (groups).
"""
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.elements import FACET_CORNERS
from ricochet.interchange.mesh import Mesh

NODES, ELEMENTS, GROUPS = {781, 2411}, {780, 2412}, {2429, 2430, 2432, 2435, 2452, 2467, 2477}
# Number of nodes by descriptor. The nodes of elements of order 2 follow the edges around a face, each corner before
# the middle of the edge that begins there.
SOLIDS = {111: 4, 118: 10, 112: 6, 113: 15, 115: 8, 116: 20}
FACETS = {**dict.fromkeys((41, 51, 61, 91), 3), **dict.fromkeys((42, 52, 62, 92), 6)}
FACETS |= {**dict.fromkeys((44, 54, 64, 94), 4), **dict.fromkeys((45, 55, 65, 95), 8)}
OTHER_SOLIDS = {101, 102, 103, 104, 105, 106, 107, 108, 109, 110, 114, 117, 119, 120}
BEAMS = {11, 21, 22, 23, 24}  # of which a further line names the ends
# For each node of an element in Abaqus, its place in the file.
RINGS = {
    10: [0, 2, 4, 9, 1, 3, 5, 6, 7, 8],
    15: [0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8],
    20: [0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11],
    6: [0, 2, 4, 1, 3, 5],
    8: [0, 2, 4, 6, 1, 3, 5, 7],
}
NODE, ELEMENT = 7, 8  # kinds of members of groups


def datasets(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yields the number and the lines of each dataset."""
    number, lines = -1, list[str]()
    inside = False
    for line in path.read_text(errors="replace").splitlines():
        if line.strip() != "-1":
            if inside and number < 0:
                number = int(line.split()[0].rstrip("b"))
            elif inside:
                lines.append(line)
        elif inside and number >= 0:
            yield number, lines
            inside, number, lines = False, -1, []
        else:
            inside = True
    if inside:
        raise ValueError("its last dataset has no end")


class File:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.position: dict[int, list[float]] = {}
        self.solids: dict[int, dict[int, list[int]]] = {}  # by number of nodes, by number
        self.facets: dict[int, list[int]] = {}  # corners by number
        self.groups: list[tuple[str, list[tuple[int, int]]]] = []  # kind and number of each member
        for number, lines in datasets(path):
            if number in NODES:
                self.take_nodes(lines)
            elif number in ELEMENTS:
                self.take_elements(lines)
            elif number in GROUPS:
                self.take_groups(lines, 4 if number >= 2435 else 2)
        if not self.position:
            raise ValueError("it has no nodes")

    def take_nodes(self, lines: list[str]) -> None:
        for head, place in zip(lines[::2], lines[1::2]):
            self.position[int(head.split()[0])] = [
                float(x.replace("D", "E").replace("d", "e")) for x in place.split()
            ]

    def take_elements(self, lines: list[str]) -> None:
        words = iter(lines)
        for line in words:
            number, kind, *_, count = map(int, line.split())
            if kind in BEAMS:
                next(words)
            nodes: list[int] = []
            while len(nodes) < count:
                nodes += map(int, next(words).split())
            if kind in SOLIDS and SOLIDS[kind] == count:
                block = self.solids.setdefault(count, {})
                block[number] = [nodes[k] for k in RINGS[count]] if count in (10, 15, 20) else nodes
            elif kind in FACETS and FACETS[kind] == count:
                rows = [nodes[k] for k in RINGS[count]] if count in (6, 8) else nodes
                self.facets[number] = rows[: FACET_CORNERS[count]]
            elif kind in OTHER_SOLIDS or kind in SOLIDS:
                raise InputError(
                    f"{self.path}: element {number} is a solid of {count} nodes (descriptor {kind}): 4, 6, 8, 10, 15 and 20 "
                    "are read"
                )

    def take_groups(self, lines: list[str], step: int) -> None:
        """A head with the number of members, a name, and lines of members of `step` words: kind, number and others."""
        words = iter(lines)
        for line in words:
            count = int(line.split()[-1])
            name, members = next(words).strip(), list[tuple[int, int]]()
            while len(members) < count:
                values = list(map(int, next(words).split()))
                members += [(values[k], values[k + 1]) for k in range(0, len(values), step)]
            self.groups.append((name, members))

    def mesh(self) -> Mesh:
        numbers = sorted(self.position)
        index = {number: k for k, number in enumerate(numbers)}
        solid = {number: k for k, number in enumerate(n for block in self.solids.values() for n in block)}
        blocks = {
            size: np.array([[index[node] for node in nodes] for nodes in block.values()])
            for size, block in self.solids.items()
        }
        node = np.array([self.position[number] for number in numbers], float).reshape(-1, 3)
        mesh = Mesh(
            self.path, node, np.array(numbers), blocks, np.array(list(solid), np.int64), oriented=False
        )
        for name, members in self.groups:
            elements = [number for kind, number in members if kind == ELEMENT]
            if solids := [solid[number] for number in elements if number in solid]:
                mesh.solid_groups[name] = np.array(solids)
            rows = [self.facets[number] for number in elements if number in self.facets]
            if rows:
                mesh.facet_groups[name] = self.corners(rows, index)
            if nodes := [index[number] for kind, number in members if kind == NODE and number in index]:
                mesh.node_groups[name] = np.array(nodes)
        return mesh

    def corners(self, rows: list[list[int]], index: dict[int, int]) -> Array:
        return np.array([([index[node] for node in row] + [-1])[:4] for row in rows])


def read(path: Path) -> Mesh:
    """The mesh of a universal file in its units. Raises InputError and OSError."""
    try:
        return File(path).mesh()
    except (ValueError, IndexError, KeyError, StopIteration) as error:
        what = " ".join(str(error).split())[:80]
        raise InputError(
            f"{path}: is no complete universal file ({what or 'it is cut off'}): save it again"
        ) from None
