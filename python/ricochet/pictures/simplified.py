# SPDX-License-Identifier: BSD-2-Clause
"""Visualisation surfaces with fewer triangles and fewer shapes, for pages and films."""
from typing import Any

import numpy as np

from ricochet.arrays import Array
from ricochet.pictures.moving_surfaces import MovingSurface

TRIANGLES = 80_000  # maximum number of triangles of all bodies
SIDES = 12  # sides of a rod's cross-section


def simplified(surface: MovingSurface, share: float, body: dict[str, Any]) -> tuple[Array, Array, Array]:
    """(T,3) triangles of a surface as they are drawn, (V) the node of each vertex, and (V,3) its offset from that node [m]. A rod
    is a tube, and of a surface with too many triangles, nodes are left out.

    @param share  share of the body in the triangles that all bodies may have
    @param body   its keys in the scene
    """
    node, element = surface.node, surface.element
    if element.shape[1] == 2:
        return tube(node, element, radius_of(body, float(np.ptp(node, axis=0).max())))
    of = np.arange(len(node))
    if len(element) > share * TRIANGLES:
        of, element = coarser(node, element, int(share * TRIANGLES))
    return element, of, np.zeros((len(of), 3))


def few_shapes(shape: Array, coordinates: Array, most: int, left_out: float) -> tuple[Array, Array]:
    """The best r fields (n,r) and amplitudes (S,r) with fields · amplitudesᵀ ≈ shape · coordinatesᵀ.

    r is the smallest number for which the relative root mean square error is within `left_out`, but at most
    `most`.
    """
    if shape.shape[1] == 0:
        return np.zeros((len(shape), 0)), np.zeros((len(coordinates), 0))
    # Converted to double precision in parts to save memory.
    parts = np.array_split(shape, len(shape) // 10_000 + 1)
    products = sum(part.T.astype(float) @ part for part in parts)
    values, vectors = np.linalg.eigh(products)
    kept = values > 1e-14 * max(values[-1], 1e-300)
    root, vectors = np.sqrt(values[kept]), vectors[:, kept]
    left, size, right = np.linalg.svd((coordinates @ vectors) * root, full_matrices=False)
    error = np.sqrt(np.append(np.cumsum(size[::-1] ** 2)[::-1], 0))  # with the first 0, 1, … shapes
    count = min(int(np.argmax(error <= left_out * error[0])), most)
    mix = (vectors / root) @ right[:count].T
    return np.concatenate([part @ mix for part in parts]), left[:, :count] * size[:count]


def coarser(node: Array, element: Array, limit: int) -> tuple[Array, Array]:
    """Coarsens a surface: all nodes in a cell of a grid become one. Returns the nodes to keep and at most
    `limit` triangles between them."""
    kept, cells = np.arange(len(node)), 2.0 * np.sqrt(limit)
    while len(element) > limit:
        width = np.ptp(node, axis=0).max() / cells
        cell = np.floor((node - node.min(axis=0)) / width).astype(int)
        _, first, of = np.unique(cell, axis=0, return_index=True, return_inverse=True)
        merged = of.ravel()[element]
        whole = (
            (merged[:, 0] != merged[:, 1]) & (merged[:, 1] != merged[:, 2]) & (merged[:, 2] != merged[:, 0])
        )
        corners, where = np.unique(np.sort(merged[whole], axis=1), axis=0, return_index=True)
        kept, thinner, cells = first, merged[whole][where], 0.8 * cells
        if len(corners) <= limit:
            return kept, thinner
    return kept, element


def tube(node: Array, element: Array, radius: float) -> tuple[Array, Array, Array]:
    """Turns a rod into a tube. Returns triangles between rings of new nodes, the old node of each new node,
    and its offset from the old node."""
    along = node[element[0, 1]] - node[element[0, 0]]
    along = along / (np.linalg.norm(along) or 1)
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    across /= np.linalg.norm(across)
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    ring = radius * (np.outer(np.cos(angle), across) + np.outer(np.sin(angle), np.cross(along, across)))
    of = np.repeat(np.arange(len(node)), SIDES)
    here = np.arange(SIDES)
    turned = (here + 1) % SIDES
    faces = []
    for a, b in element * SIDES:
        faces += [
            np.stack([a + here, b + here, b + turned], 1),
            np.stack([a + here, b + turned, a + turned], 1),
        ]
    ends, counts = np.unique(element, return_counts=True)
    for end in ends[counts == 1] * SIDES:
        faces.append(np.stack([np.full(SIDES - 2, end), end + here[1:-1], end + here[2:]], 1))
    return np.concatenate(faces), of, np.tile(ring, (len(node), 1))


def radius_of(body: dict[str, Any], length: float) -> float:
    """The radius of a rod, from its cross-section. It is at least large enough to be visible."""
    area = max((part.get("area", 0) for part in materials(body).values()), default=0)
    return max(np.sqrt(area / np.pi), 0.01 * length)


def materials(body: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The materials of a body by physical volume. The name "" stands for the whole body."""
    found = body.get("material", {})
    return {"": found} if "density" in found else found
