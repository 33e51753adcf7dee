# SPDX-License-Identifier: BSD-2-Clause
"""Meshes from blocks of cells that name their nodes by place, as most files of meshes have them."""
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.elements import FACET_CORNERS
from ricochet.interchange.mesh import Mesh

SOLID, FACET = 3, 2


@dataclass
class Cells:
    """Cells of one type. `dim`: SOLID or FACET; `nodes` (T,k), counted from 0; `groups`: places of their members."""

    dim: int
    nodes: Array
    groups: dict[str, Array] = field(default_factory=dict)


def no_pyramids(where: object) -> InputError:
    return InputError(f"{where}: has pyramids or polyhedra: mesh with tetrahedra, hexahedra or prisms")


def from_hdf5(path: Path, kind: str, mesh_in: Callable[[Path, h5py.File], Mesh]) -> Mesh:
    """The mesh that a function finds in an HDF5 file. Raises InputError, also for whatever the function raises where the
    file is no complete one of this kind, and OSError."""
    path.open("rb").close()  # HDF5 has no error of its own for a file that is not there
    try:
        with h5py.File(path) as file:
            return mesh_in(path, file)
    except InputError:
        raise
    except (
        KeyError,
        ValueError,
        IndexError,
        AttributeError,
        TypeError,
        OSError,
        RuntimeError,
        MemoryError,
    ) as error:
        what = " ".join(str(error).split())[:80]
        raise InputError(f"{path}: is no complete {kind} ({what}): save it again") from None


def labelled(values: Array, names: dict[int, str] | None = None) -> Iterator[tuple[str, Array]]:
    """Yields a group for each number but 0 of a list with a number for each cell."""
    for value in np.unique(values).tolist():
        if value != 0 and value == int(value):
            yield (names or {}).get(int(value), str(int(value))), np.flatnonzero(values == value)


def corners_of(nodes: Array) -> Array:
    """(T,4) corners of facets of one type, −1 behind those of triangles."""
    corners = FACET_CORNERS[nodes.shape[1]]
    return np.hstack([nodes[:, :corners], np.full((len(nodes), 4 - corners), -1)])


def joined(blocks: Sequence[Cells]) -> dict[str, Array]:
    """The groups of blocks that follow each other."""
    found: dict[str, list[Array]] = {}
    start = 0
    for block in blocks:
        for name, places in block.groups.items():
            found.setdefault(name, []).append(start + places)
        start += len(block.nodes)
    return {name: np.concatenate(places) for name, places in found.items()}


def mesh_of(path: Path, node: Array, blocks: list[Cells], node_groups: dict[str, Array]) -> Mesh:
    """A mesh of solids with groups. `node`: (n,1 to 3). Raises InputError."""
    if node.ndim != 2:
        raise InputError(f"{path}: has no nodes: export the mesh again")
    position = np.zeros((len(node), 3))
    position[:, : node.shape[1]] = node[:, :3]
    for block in blocks:
        if block.nodes.min(initial=0) < 0 or block.nodes.max(initial=0) >= len(node):
            raise InputError(f"{path}: a cell names a node that is not there: export the mesh again")
    solids = sorted((block for block in blocks if block.dim == SOLID), key=lambda block: block.nodes.shape[1])
    facets = [block for block in blocks if block.dim == FACET]
    by_size: dict[int, list[Array]] = {}
    for block in solids:
        by_size.setdefault(block.nodes.shape[1], []).append(block.nodes)
    corners = np.concatenate([corners_of(block.nodes) for block in facets] or [np.empty((0, 4), np.int64)])
    return Mesh(
        path,
        position,
        1 + np.arange(len(node)),
        {size: np.concatenate(same) for size, same in by_size.items()},
        1 + np.arange(sum(len(block.nodes) for block in solids)),
        joined(solids),
        {name: corners[places] for name, places in joined(facets).items()},
        node_groups,
        oriented=False,
    )
