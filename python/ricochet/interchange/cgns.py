# SPDX-License-Identifier: BSD-2-Clause
"""The mesh of a CGNS file with one unstructured zone: sections of elements and boundary conditions become groups.

Source: CGNS, "Standard interface data structures" 4, and its mapping to HDF5, in which " data" holds the values of a node.
"""
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.cells import FACET, SOLID, Cells, from_hdf5, mesh_of, no_pyramids
from ricochet.interchange.elements import TOP_LAST
from ricochet.interchange.mesh import Mesh
from ricochet.interchange.numbers import LONGEST_RANGE

# Dimension and number of nodes by type.
KINDS = {
    **{10: (SOLID, 4), 11: (SOLID, 10), 14: (SOLID, 6), 15: (SOLID, 15), 16: (SOLID, 18)},
    **{17: (SOLID, 8), 18: (SOLID, 20), 19: (SOLID, 27)},
    **{5: (FACET, 3), 6: (FACET, 6), 7: (FACET, 4), 8: (FACET, 8), 9: (FACET, 9)},
}
WITHOUT = {2: 1, 3: 2, 4: 3}  # points and lines with their number of nodes, which are left out in silence
MIXED = 20


def children(node: h5py.Group, label: str) -> Iterator[tuple[str, h5py.Group]]:
    """Yields the nodes below one that have this label."""
    for name, child in node.items():
        if (
            isinstance(child, h5py.Group)
            and bytes(child.attrs.get("label", b"")).rstrip(b"\0") == label.encode()
        ):
            yield name, child


def data(node: h5py.Group) -> Array:
    return np.asarray(node[" data"][:]).ravel()


def text(node: h5py.Group) -> str:
    return data(node).astype(np.uint8).tobytes().decode(errors="replace").strip("\0 ")


class Section:
    """Elements with numbers from `first` on, by type: (T) places of their numbers and (T,k) nodes."""

    def __init__(self, path: Path, name: str, node: h5py.Group) -> None:
        self.path, self.name = path, name
        self.first = int(data(node["ElementRange"])[0])
        kind, nodes = int(data(node)[0]), data(node["ElementConnectivity"]).astype(np.int64)
        self.blocks: list[tuple[int, Array, Array]] = []
        if kind != MIXED:
            size = self.size_of(kind)
            if nodes.size % size:
                raise ValueError(f"{name} has {nodes.size} values")
            self.blocks.append((kind, np.arange(nodes.size // size), nodes.reshape(-1, size)))
            return
        found: dict[int, list[tuple[int, Array]]] = {}
        at = number = 0
        while at < nodes.size:
            kind = int(nodes[at])
            size = self.size_of(kind)
            found.setdefault(kind, []).append((number, nodes[at + 1 : at + 1 + size]))
            at, number = at + 1 + size, number + 1
        for kind, rows in found.items():
            self.blocks.append((kind, np.array([k for k, _ in rows]), np.stack([row for _, row in rows])))

    def size_of(self, kind: int) -> int:
        if kind in WITHOUT:
            return WITHOUT[kind]
        if kind not in KINDS:
            raise no_pyramids(f"{self.path}: section {self.name}")
        return KINDS[kind][1]


def conditions(zone: h5py.Group) -> Iterator[tuple[str, bool, Array]]:
    """Yields the boundary conditions: name, whether it lists nodes, and the numbers of elements or nodes."""
    for _, group in children(zone, "ZoneBC_t"):
        for name, condition in children(group, "BC_t"):
            place = text(condition["GridLocation"]) if "GridLocation" in condition else "Vertex"
            for key in ("PointList", "ElementList", "PointRange", "ElementRange"):
                if key in condition:
                    numbers = data(condition[key]).astype(np.int64)
                    if key.endswith("Range"):
                        if numbers[-1] - numbers[0] > LONGEST_RANGE:
                            raise ValueError(f"{name} has a range of more than {LONGEST_RANGE} numbers")
                        numbers = np.arange(numbers[0], numbers[-1] + 1)
                    yield name, place == "Vertex" and not key.startswith("Element"), numbers


def mesh_in(path: Path, file: h5py.File) -> Mesh:
    zones = [zone for _, base in children(file, "CGNSBase_t") for _, zone in children(base, "Zone_t")]
    if len(zones) != 1:
        raise InputError(f"{path}: has {len(zones)} zones: save the body as one unstructured zone")
    zone = zones[0]
    if "ZoneType" in zone and text(zone["ZoneType"]) != "Unstructured":
        raise InputError(f"{path}: has a structured zone: save an unstructured one")
    (_, grid), *_ = children(zone, "GridCoordinates_t")
    node = np.stack([data(grid[f"Coordinate{axis}"]).astype(float) for axis in "XYZ"], axis=1)
    listed = list(conditions(zone))
    blocks = []
    for section in (Section(path, *found) for found in children(zone, "Elements_t")):
        for kind, places, nodes in section.blocks:
            if kind in WITHOUT:
                continue
            groups = {section.name: np.arange(len(nodes))}
            for name, of_nodes, numbers in listed:
                if not of_nodes and (here := np.flatnonzero(np.isin(section.first + places, numbers))).size:
                    groups[name] = here
            blocks.append(Cells(KINDS[kind][0], nodes - 1, groups))
    nodes_of = {name: numbers - 1 for name, of_nodes, numbers in listed if of_nodes}
    for name, nodes in nodes_of.items():
        if nodes.min(initial=0) < 0 or nodes.max(initial=0) >= len(node):
            raise ValueError(f"{name} names a node that is not there")
    mesh = mesh_of(path, node, blocks, nodes_of)
    mesh.edges = TOP_LAST
    return mesh


def read(path: Path) -> Mesh:
    """The mesh of a CGNS file in its units. Raises InputError and OSError."""
    return from_hdf5(path, "CGNS file in HDF5", mesh_in)
