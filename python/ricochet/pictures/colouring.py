# SPDX-License-Identifier: BSD-2-Clause
"""Colours of the surfaces of a drawing, such that neighbours differ, and their borders."""
from collections.abc import Sequence

import numpy as np

from ricochet.arrays import Array

COLOURS = 6  # of bodies in the style sheet of pages


def borders(element: Array) -> Array:
    """(E,2) the edges of triangles that belong to one of them only, the smaller number first."""
    edges = np.sort(element[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    found, count = np.unique(edges, axis=0, return_counts=True)
    once: Array = found[count == 1]
    return once


def neighbours(outlines: Sequence[Array]) -> list[set[int]]:
    """For each outline, the indices of the others with which it shares an edge."""
    found: list[set[int]] = [set() for _ in outlines]
    owners: dict[tuple[int, int], list[int]] = {}
    for k, outline in enumerate(outlines):
        for first, second in outline.tolist():
            owners.setdefault((first, second), []).append(k)
    for sharing in owners.values():
        for k in sharing:
            found[k].update(other for other in sharing if other != k)
    return found


def colours(near: Sequence[set[int]]) -> list[int]:
    """Numbers of colours from 0, such that neighbours differ. Those with the fewest neighbours choose last, so that six
    colours are enough for every map on a sphere (Matula and Beck 1983)."""
    left, order = {k: set(others) for k, others in enumerate(near)}, []
    while left:
        k = min(left, key=lambda k: (len(left[k]), k))
        for other in left.pop(k):
            left[other].discard(k)
        order.append(k)
    chosen: dict[int, int] = {}
    used = [0] * (COLOURS + len(near))
    for k in reversed(order):
        taken = {chosen[other] for other in near[k] if other in chosen}
        free = [colour for colour in range(max(COLOURS, len(taken) + 1)) if colour not in taken]
        # All colours are used equally often, so that a part of few surfaces has many; more than COLOURS in need only.
        chosen[k] = min(free, key=lambda colour: (colour >= COLOURS, used[colour], colour))
        used[chosen[k]] += 1
    return [chosen[k] for k in range(len(near))]


def map_colours(outlines: Sequence[Array]) -> list[int]:
    """The `colours` of surfaces with these `borders`."""
    return colours(neighbours(outlines))
