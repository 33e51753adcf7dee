# SPDX-License-Identifier: BSD-2-Clause
"""Writes the mesh files of gmsh: binary, version 4.1.

Source: gmsh reference manual, "MSH file format".
"""
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ricochet import files
from ricochet.arrays import Array
from ricochet.interchange.elements import GMSH_FACETS, GMSH_POINT, GMSH_SOLIDS
from ricochet.interchange.faces import Faces, Groups
from ricochet.interchange.mesh import Mesh

Block = tuple[int, int, int, Array, Array]  # dimension, entity, gmsh's type, (T) numbers, (T,k) nodes


def shares(count: int, groups: Sequence[Array]) -> tuple[Array, list[list[int]]]:
    """Divides elements by the groups to which they belong. @return: (count) the share of each, and the groups of
    each share. The first share belongs to no group."""
    share = np.zeros(count, np.int64)
    held: list[list[int]] = [[]]
    for group, members in enumerate(groups):
        old, new = np.unique(share[members], return_inverse=True)
        share[members] = len(held) + new
        held += [[*held[k], group] for k in old.tolist()]
    return share, held


class Writer:
    """An entity of gmsh is a share: the elements of one dimension that belong to the same groups."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self.names: list[tuple[int, int, str]] = []  # dimension, number and name of each group
        self.entities: dict[int, list[tuple[int, list[int]]]] = {dim: [] for dim in range(4)}
        self.blocks: list[Block] = []
        self.last = int(mesh.solid_number.max())  # largest number of an element

    def divide(self, dim: int, count: int, groups: dict[str, Array]) -> Array:
        """Declares groups and entities. @return: (count) the entity of each element, 0 for those that are not in the
        file"""
        numbers = [len(self.names) + 1 + k for k in range(len(groups))]
        self.names += [(dim, number, name) for number, name in zip(numbers, groups)]
        share, held = shares(count, list(groups.values()))
        for entity in np.unique(share).tolist():
            if held[entity]:
                self.entities[dim].append((entity, [numbers[k] for k in held[entity]]))
        return share

    def add(self, dim: int, kind: int, entity: Array, rows: Array, numbers: Array | None = None) -> None:
        """Adds elements of one type. Those without numbers get the next ones."""
        if numbers is None:
            numbers = self.last + 1 + np.arange(len(rows))
            self.last += len(rows)
        for one in np.unique(entity).tolist():
            here = entity == one
            self.blocks.append((dim, one, kind, numbers[here], self.mesh.node_number[rows[here]]))

    def add_all(self, faces: Faces, groups: Groups) -> None:
        entity = self.divide(3, len(self.mesh.solid_number), groups.solids)
        start = 0
        for size, rows in self.mesh.solids.items():
            here = slice(start, start + len(rows))
            self.add(3, GMSH_SOLIDS[size], entity[here], rows, self.mesh.solid_number[here])
            start += len(rows)
        entity = self.divide(2, len(faces.corner), groups.faces)
        grouped = np.flatnonzero(entity)
        for places, rows in faces.nodes(grouped):
            self.add(2, GMSH_FACETS[rows.shape[1]], entity[grouped[places]], rows)
        entity = self.divide(0, len(self.mesh.node), groups.points)
        grouped = np.flatnonzero(entity)
        self.add(0, GMSH_POINT, entity[grouped], grouped[:, None])

    def entity_bytes(self) -> bytes:
        low, high = self.mesh.node.min(axis=0), self.mesh.node.max(axis=0)
        parts = [np.array([len(self.entities[dim]) for dim in range(4)], np.uint64).tobytes()]
        for dim in range(4):
            for entity, groups in self.entities[dim]:
                place = low if dim == 0 else np.concatenate([low, high])
                parts += [np.int32(entity).tobytes(), place.tobytes(), np.uint64(len(groups)).tobytes()]
                parts += [np.array(groups, np.int32).tobytes(), b"" if dim == 0 else np.uint64(0).tobytes()]
        return b"".join(parts)

    def node_bytes(self) -> bytes:
        used = np.unique(np.concatenate([rows.ravel() for rows in self.mesh.solids.values()]))
        number = self.mesh.node_number[used].astype(np.uint64)
        head = np.array([1, len(used), number.min(), number.max()], np.uint64)
        # All nodes are those of the first volume.
        block = np.array([3, self.entities[3][0][0], 0], np.int32)
        count = np.uint64(len(used))
        return b"".join(x.tobytes() for x in (head, block, count, number, self.mesh.node[used]))

    def element_bytes(self) -> bytes:
        total = sum(len(numbers) for *_, numbers, _ in self.blocks)
        low = min(numbers.min() for *_, numbers, _ in self.blocks)
        parts = [np.array([len(self.blocks), total, low, self.last], np.uint64).tobytes()]
        for *head, numbers, rows in self.blocks:
            parts += [np.array(head, np.int32).tobytes(), np.uint64(len(rows)).tobytes()]
            parts.append(np.column_stack([numbers, rows]).astype(np.uint64).tobytes())
        return b"".join(parts)

    def content(self) -> bytes:
        names = [f'{dim} {number} "{name}"' for dim, number, name in self.names]
        sections = [
            ("MeshFormat", b"4.1 1 8\n" + np.int32(1).tobytes()),
            ("PhysicalNames", "\n".join([str(len(names)), *names]).encode()),
            ("Entities", self.entity_bytes()),
            ("Nodes", self.node_bytes()),
            ("Elements", self.element_bytes()),
        ]
        return b"".join(
            b"$%b\n%b\n$End%b\n" % (name.encode(), data, name.encode()) for name, data in sections
        )


def write(path: Path, mesh: Mesh, faces: Faces, groups: Groups) -> None:
    """Writes the file completely or not at all. Raises OSError."""
    writer = Writer(mesh)
    writer.add_all(faces, groups)
    files.write(path, writer.content())
