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


def clockwise(node: Array, facets: Array, i: Array, j: Array) -> int:
    """Number of facets that run clockwise seen from outside. `facets`: (T,k) node numbers from 0.

    The stiffness, with entries at rows i and columns j, shows on which side the body is: a node that is
    coupled with all corners of a facet belongs to its element, so it lies inside.
    """
    corners = facets[:, : 3 if np.shape(facets)[1] in (3, 6, 10) else 4]
    here = np.isin(i // 3, corners)
    pairs = np.unique((i[here] // 3) * len(node) + j[here] // 3)
    nodes, start = np.unique(pairs // len(node), return_index=True)
    coupled = {
        of: set(others.tolist()) for of, others in zip(nodes.tolist(), np.split(pairs % len(node), start[1:]))
    }
    count = 0
    for facet, corner in zip(facets.tolist(), corners.tolist()):
        behind = list(set.intersection(*(coupled.get(k, set()) for k in corner)).difference(facet))
        if behind:
            place = node[corner]
            inward = np.cross(place[2] - place[0], place[1] - place[-1])
            away = node[behind].mean(axis=0) - place.mean(axis=0)
            # A flat element has no inside.
            count += bool(inward @ away < -1e-6 * np.linalg.norm(inward) * np.linalg.norm(away))
    return count
