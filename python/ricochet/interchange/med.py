# SPDX-License-Identifier: BSD-2-Clause
"""The mesh of a MED file of Salome or code_aster, with its groups.

Source: MED 3 and 4, "Format de données MED". A MED file is an HDF5 file; numbers of nodes are from 1.
"""
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.cells import FACET, SOLID, Cells, from_hdf5, mesh_of, no_pyramids
from ricochet.interchange.mesh import Mesh

# Dimension and number of nodes by type. Points and lines are left out in silence.
KINDS = {
    **{"TE4": (SOLID, 4), "T10": (SOLID, 10), "PE6": (SOLID, 6), "P15": (SOLID, 15), "P18": (SOLID, 18)},
    **{"HE8": (SOLID, 8), "H20": (SOLID, 20), "H27": (SOLID, 27)},
    **{
        "TR3": (FACET, 3),
        "TR6": (FACET, 6),
        "TR7": (FACET, 7),
        "QU4": (FACET, 4),
        "QU8": (FACET, 8),
        "QU9": (FACET, 9),
    },
}
WITHOUT = {"PO1", "SE2", "SE3", "SE4"}


def rows(data: h5py.Dataset, count: int) -> Array:
    """(T,count) values that MED stores one column after the other."""
    values = np.asarray(data[:]).ravel()
    if values.size % count:
        raise ValueError(f"{data.name} has {values.size} values")
    return values.reshape(count, -1).T


def family_groups(families: Any) -> dict[int, list[str]]:
    """The names of the groups of each family, by its number."""
    found = {}
    for family in families.values():
        names = family.get("GRO/NOM", ())  # (n,80) letters
        letters = [bytes(np.asarray(name).astype(np.uint8)) for name in names]
        texts = [text.partition(b"\0")[0].decode(errors="replace").strip() for text in letters]
        found[int(family.attrs["NUM"])] = [text for text in texts if text]
    return found


def members(family: Array, groups: dict[int, list[str]]) -> Iterator[tuple[str, Array]]:
    """Yields each group and the places of its members, which are in one of its families."""
    for name in sorted({name for names in groups.values() for name in names}):
        numbers = [number for number, names in groups.items() if name in names]
        if (places := np.flatnonzero(np.isin(family, numbers))).size:
            yield name, places


def mesh_in(path: Path, file: h5py.File) -> Mesh:
    meshes = file["ENS_MAA"]
    if len(meshes) != 1:
        raise InputError(
            f"{path}: holds {len(meshes)} meshes ({', '.join(list(meshes)[:5])}): save the one of the body alone"
        )
    name, mesh = next(iter(meshes.items()))
    step = mesh if "NOE" in mesh else mesh[sorted(mesh)[0]]  # the first state of a mesh that changes
    families = file.get(f"FAS/{name}", {})
    of_elements, of_nodes = (family_groups(families.get(kind, {})) for kind in ("ELEME", "NOEUD"))
    blocks = []
    for kind, block in step["MAI"].items():
        if kind in WITHOUT:
            continue
        if kind not in KINDS:
            raise no_pyramids(path)
        dim, size = KINDS[kind]
        nodes = rows(block["NOD"], size).astype(np.int64) - 1
        family = np.asarray(block["FAM"][:]).ravel() if "FAM" in block else np.zeros(len(nodes))
        if len(family) != len(nodes):
            raise ValueError(f"{kind} has {len(family)} families")
        blocks.append(Cells(dim, nodes, dict(members(family, of_elements))))
    family = np.asarray(step["NOE/FAM"][:]).ravel() if "NOE/FAM" in step else np.empty(0)
    return mesh_of(path, rows(step["NOE/COO"], 3).astype(float), blocks, dict(members(family, of_nodes)))


def read(path: Path) -> Mesh:
    """The mesh of a MED file in its units. Raises InputError and OSError."""
    return from_hdf5(path, "MED file of version 3 or later", mesh_in)
