# SPDX-License-Identifier: BSD-2-Clause
"""Bodies from MatrixMarket files and lists of nodes and facets."""
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ricochet.errors import InputError
from ricochet.interchange.body import Body, asymmetry, wrong_edge, wrong_facet
from ricochet.arrays import Array
from ricochet.interchange.numbers import numbers_from_zero, read_matrix_market, table

FACETS = (3, 4, 6, 9, 10, 16)  # supported numbers of nodes of a facet
Named = Sequence[tuple[str, Path]]


def read(stiffness: Path, mass: Path, nodes: Path, surfaces: Named, supports: Named) -> Body:
    """Reads a body in the units of its files. Raises InputError and OSError."""
    node = table(nodes, "x y z of a node")
    if node.shape[1] != 3:
        raise InputError(f"{nodes}: has {node.shape[1]} columns: give x y z of each node")
    matrices = {}
    for name, path in (("stiffness", stiffness), ("mass", mass)):
        matrices[name], shape = read_matrix_market(path)
        if shape != (3 * len(node), 3 * len(node)):
            raise InputError(
                f"{path}: is {shape[0]} x {shape[1]}: {len(node)} nodes have {3 * len(node)} displacements"
            )
        if found := asymmetry(*matrices[name], 3 * len(node)):
            row, column, value, other = found
            raise InputError(
                f"{path}: is not symmetric: row {row + 1} has {value:.10g} in column {column + 1}, row {column + 1} has "
                f"{other:.10g} in column {row + 1}. Write both triangles alike, or one of them as a symmetric matrix"
            )
    body = Body(node, matrices, {})
    blocks: dict[str, dict[int, list[Array]]] = {}
    for name, path in surfaces:
        facets = numbers_from_zero(path, len(node), "the nodes of a facet, numbered from 1")
        size = facets.shape[1]
        if size not in FACETS:
            raise InputError(f"{path}: has facets of {size} nodes: read are {', '.join(map(str, FACETS))}")
        blocks.setdefault(name, {}).setdefault(size, []).append(facets)
        if wrong := wrong_facet(node, facets, *matrices["stiffness"][:2]):
            index, what = wrong
            raise InputError(
                f"{path}: facet {index + 1}, of nodes {' '.join(str(k + 1) for k in facets[index])}, {what}. Nodes are "
                "numbered from 1"
            )
    body.surfaces = {name: [np.vstack(same) for same in sizes.values()] for name, sizes in blocks.items()}
    for name, sizes in body.surfaces.items():
        if edge := wrong_edge(sizes):
            raise InputError(
                f"surface {name}: two facets run from node {edge[0] + 1} to node {edge[1] + 1}: a facet is given twice, or "
                "one of its neighbours is clockwise seen from outside"
            )
    for name, path in supports:
        numbers = numbers_from_zero(path, len(node), "nodes, numbered from 1")
        body.supports[name] = np.union1d(body.supports.get(name, []), numbers)
    return body
