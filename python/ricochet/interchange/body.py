# SPDX-License-Identifier: BSD-2-Clause
"""Bodies from other programs, and the body files (docs/interchange.md) that a scene names as a mesh."""
import io
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from ricochet import files
from ricochet.errors import InputError
from ricochet.arrays import Array
from ricochet.interchange.numbers import Entries

ASYMMETRY = 1e-9  # of the diagonal, as ricochet-kernel accepts it


@dataclass
class Body:
    """A mesh with its matrices. Nodes are numbered from 0 here and in the file."""

    node: Array  # (n,3) [m]
    matrices: dict[str, Entries]  # "stiffness" [N/m] and "mass" [kg], (3n,3n), both triangles
    surfaces: dict[str, list[Array]]  # by name: blocks of facets, (T,k) node numbers
    supports: dict[str, Array] = field(default_factory=dict)  # by name: node numbers
    skin: Array | None = None  # (T,3) triangles for pictures
    warnings: list[str] = field(default_factory=list)

    def in_units(self, length: float, mass: float) -> None:
        """Converts the body to SI units. Its present units are `length` [m] and `mass` [kg]."""
        with np.errstate(over="ignore"):
            self.node = self.node * length
            self.matrices = {name: (i, j, value * mass) for name, (i, j, value) in self.matrices.items()}
        for values in (self.node, *(value for _, _, value in self.matrices.values())):
            if not np.isfinite(values).all():
                raise InputError("--length-unit, --mass-unit: make numbers that are not finite")

    def write(self, path: Path) -> None:
        """Writes the body file completely or not at all. Raises OSError."""
        image = io.BytesIO()  # written to memory first, because HDF5 crashes if the disk is full
        with h5py.File(image, "w") as file:
            file.attrs["format"] = np.bytes_("ricochet-body")
            file.attrs["version"] = 1
            file["node"] = np.asarray(self.node, float)
            for name, blocks in self.surfaces.items():
                for facets in blocks:
                    file[f"surface/{name}/{np.shape(facets)[1]}"] = np.asarray(facets, np.int64)
            for name, nodes in self.supports.items():
                file[f"nodes/{name}"] = np.asarray(nodes, np.int64)
            if self.skin is not None:
                file["skin"] = np.asarray(self.skin, np.int64)
            for name, (i, j, value) in self.matrices.items():
                for part, numbers in zip(
                    ("start", "column", "value"), rows_of(i, j, value, 3 * len(self.node))
                ):
                    file[f"{name}/{part}"] = numbers
        files.write(path, image.getbuffer())


def is_name(text: str) -> bool:
    """Whether a body file and a scene can contain a surface or support of this name."""
    return text not in ("", ".", "..") and "/" not in text and text.isprintable()


def rows_of(i: Array, j: Array, value: Array, size: int) -> Entries:
    """Compressed rows with ascending columns: start, column, value. Duplicate entries are summed."""
    order = np.lexsort((j, i))
    i, j, value = i[order], j[order], value[order]
    first = np.ones(i.size, bool)
    first[1:] = (i[1:] != i[:-1]) | (j[1:] != j[:-1])
    if i.size:
        value = np.add.reduceat(value, np.flatnonzero(first))
    start = np.zeros(size + 1, np.int64)
    np.cumsum(np.bincount(i[first], minlength=size), out=start[1:])
    return start, j[first].astype(np.int64), value


def corners_of(facets: Array) -> Array:
    """(T,3) or (T,4) corners of facets of one size, which come first."""
    return facets[:, : 3 if np.shape(facets)[1] in (3, 6, 10) else 4]


def wrong_facet(node: Array, facets: Array, i: Array, j: Array) -> tuple[int, str] | None:
    """The first facet that is not an outer face of an element, counter-clockwise seen from outside, and what it
    is; None if all are. `facets`: (T,k) node numbers from 0.

    The stiffness, with entries at rows i and columns j, shows where elements are: it couples all nodes of a face
    with each other, and with nodes off the face, which belong to its elements. Those of an outer face lie on one
    side of it. In front of a hollow surface there may be others, but these are fewer.
    """
    here = np.isin(i // 3, facets)
    pairs = np.unique((i[here] // 3) * len(node) + j[here] // 3)
    nodes, start = np.unique(pairs // len(node), return_index=True)
    coupled = {
        of: set(others.tolist()) for of, others in zip(nodes.tolist(), np.split(pairs % len(node), start[1:]))
    }
    for index, (facet, corner) in enumerate(zip(facets.tolist(), corners_of(facets).tolist())):
        common = set.intersection(*(coupled.get(k, set()) | {k} for k in facet))
        others = list(common.difference(facet))
        if not common.issuperset(facet) or not others:
            return index, "is not a face of an element: the stiffness does not couple its nodes like one"
        place = node[corner]
        inward = np.cross(place[2] - place[0], place[1] - place[-1])
        depth = (node[others] - place.mean(axis=0)) @ inward
        extent = float(np.linalg.norm(np.ptp(node[others + facet], axis=0)))
        # A flat element has no inside. A third: most of the nodes are on one side.
        if np.abs(depth).max() < 1e-6 * np.linalg.norm(inward) * extent:
            continue
        side = depth.sum() / np.abs(depth).sum()
        if side < -1 / 3:
            return index, "runs clockwise seen from outside: reverse the order of its nodes"
        if side < 1 / 3:
            return index, "lies inside the body: the stiffness couples it with nodes on both sides"
    return None


def wrong_edge(blocks: list[Array]) -> tuple[int, int] | None:
    """The nodes of an edge that two facets of a surface have in the same direction, as no two neighbours of an
    oriented surface do; None if there is none. `blocks`: facets of each size."""
    edges = np.concatenate(
        [
            np.stack([corner, np.roll(corner, -1, axis=1)], axis=-1).reshape(-1, 2)
            for corner in map(corners_of, blocks)
        ]
    )
    found, count = np.unique(edges, axis=0, return_counts=True)
    twice = found[count > 1]
    return (int(twice[0, 0]), int(twice[0, 1])) if len(twice) else None


def asymmetry(i: Array, j: Array, value: Array, size: int) -> tuple[int, int, float, float] | None:
    """Row, column, entry and opposite entry where a matrix differs most from its transpose, in units of its
    diagonal; None where it does so by the last printed digits only."""
    start, column, entry = rows_of(i, j, value, size)
    row = np.repeat(np.arange(size), np.diff(start))
    key, opposite = row * size + column, column * size + row
    place = np.minimum(np.searchsorted(key, opposite), max(key.size - 1, 0))
    other = np.where(key[place] == opposite, entry[place], 0.0)
    diagonal = np.zeros(size)
    diagonal[row[row == column]] = np.abs(entry[row == column])
    excess = np.abs(entry - other) - ASYMMETRY * (diagonal[row] + diagonal[column])
    if not excess.size or excess.max() <= 0:
        return None
    worst = int(np.argmax(excess))
    return int(row[worst]), int(column[worst]), float(entry[worst]), float(other[worst])
