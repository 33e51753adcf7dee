# SPDX-License-Identifier: BSD-2-Clause
"""Chooses a viewpoint from which no body hides another and the contact is hidden as little as possible."""
from collections.abc import Iterator, Sequence
import itertools

import numpy as np

from ricochet.arrays import Array, Floats

CELLS = 48  # cells along the longer side of the grid that determines what is hidden
GAIN = 0.05  # a later view is chosen only if it is better by this


class View:
    """A viewpoint. The rows of `base` are right, up and towards the eye. They are turned by `azimuth` and
    `elevation` [rad]. `toward` counts without its part along `up`."""

    def __init__(self, toward: Array, up: Array, azimuth: float = 0.0, elevation: float = 0.0) -> None:
        right = np.cross(up, toward)
        right = right / np.linalg.norm(right)
        self.base = np.array([right, up, np.cross(right, up)])
        self.azimuth, self.elevation = azimuth, elevation

    def turn(self) -> Array:
        """(3,3) rows: right, up, towards the eye."""
        right, up, toward = self.base
        c, s = np.cos(self.azimuth), np.sin(self.azimuth)
        ce, se = np.cos(self.elevation), np.sin(self.elevation)
        deep = c * toward - s * right
        return np.array([c * right + s * toward, ce * up - se * deep, se * up + ce * deep])


def views(low: Array, high: Array, tilted: bool, up: Array | None = None) -> Iterator[View]:
    """Yields views along the axes, starting with the axis of smallest extent, and along space diagonals. If
    `tilted`, views along the axes are slightly turned. If `up` is given, it points up in all views, and none is
    from below."""
    extent, axes = high - low, np.eye(3)
    depth = 2 if extent[2] <= 1.001 * extent.min() else int(np.argmin(extent))
    flat = extent[depth] < 0.3 * np.delete(extent, depth).min()
    order = [depth, *(axis for axis in range(3) if axis != depth)]
    if up is None:
        asides = [(-0.12, 0.06) if flat else (-0.35, 0.2)] if tilted else [(0.0, 0.0)]
        across, slopes = [axes[0], axes[1]], [1, -1]
    else:
        lying = flat and abs(up[depth]) > 0.9  # a plate is seen obliquely, not along its edge
        aside = (-0.35, 0.6) if lying else (-0.12, 0.06) if flat else (-0.35, 0.2)
        asides = [aside, (-aside[0], aside[1])] if tilted else [(0.0, 0.0)]
        order = sorted({0, 1, 2} - {int(np.argmax(np.abs(up)))}, key=lambda axis: extent[axis])
        across, slopes = [axis - up * (up @ axis) for axis in axes[sorted(order)]], [1]
    for axis in order:
        for way, aside in itertools.product((-1, 1) if axis == 1 else (1, -1), asides):
            yield View(way * axes[axis], axes[1 if axis == 2 else 2] if up is None else up, *aside)
    for x, y, way in itertools.product((1, -1), (-1, 1), slopes):
        toward = (x * across[0] + y * across[1]) / np.sqrt(2)
        yield View(toward, axes[2] if up is None else up, 0.0, way * np.arctan(np.sqrt(0.5)))


def spread(node: Array, element: Array, distance: float) -> Array:
    """Points on lines or triangles, at most `distance` apart."""
    corner = node[element]
    longest = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).max(axis=1)
    # Rounded up by a fifth at most, so that many elements have one number of parts.
    parts = np.ceil(2 ** (np.ceil(4 * np.log2(np.maximum(longest / distance, 1))) / 4)).astype(int)
    out = []
    for n in np.unique(parts):
        i, j = np.nonzero(np.tri(n + 1)[::-1])  # i + j <= n
        whole = np.column_stack([i, j, n - i - j])
        weights = whole if element.shape[1] == 3 else whole[whole[:, 2] == 0, :2]
        out.append((weights / n @ corner[parts == n]).reshape(-1, 3))
    return np.concatenate(out)


def nearest(place: Array, depth: Array, cells: int) -> Floats:
    """The largest depth in each cell, -inf in empty ones. `place`: the cell of each of the depths."""
    order = np.argsort(place, kind="stable")
    place = place[order]
    first = np.flatnonzero(np.diff(place, prepend=-1))
    found = np.full(cells, -np.inf)
    found[place[first]] = np.maximum.reduceat(depth[order], first)
    return found


def clearness(view: View, bodies: Sequence[Array], contact: Array, cell: float) -> float:
    """The quality of a view, at most 1: the smallest visible share of any body, minus the mean depth of the
    parts that hide the contact, relative to the size of all bodies. `bodies`: (·,3) points on each body, at
    most a `cell` apart."""
    turn = view.turn()
    seen = [points @ turn.T for points in [*bodies, contact]]
    everything = np.concatenate(seen)
    low, high = everything.min(axis=0), everything.max(axis=0)
    wide = int((high[0] - low[0]) / cell) + 1

    def places(points: Array) -> Array:
        right, up = ((points[:, :2] - low[:2]) / cell).astype(int).T
        return up * wide + right

    cells = (int((high[1] - low[1]) / cell) + 1) * wide
    front = [nearest(places(points), points[:, 2], cells) for points in seen[: len(bodies)]]
    hiding = np.max(front, axis=0)
    shares = [np.mean(depth[np.isfinite(depth)] >= hiding[np.isfinite(depth)] - cell) for depth in front]
    before = np.maximum(hiding[places(seen[-1])] - seen[-1][:, 2], 0) if len(contact) else np.zeros(1)
    return min(shares) - before.mean() / np.linalg.norm(high - low)


def clearest(
    surfaces: Sequence[tuple[Array, Array]],
    contact: Array,
    tilted: bool = False,
    up: Array | None = None,
    normals: Sequence[Array] = (),
) -> View:
    """Returns the first view that is not much worse than any other.

    @param surfaces    nodes (V,3) and elements (E,2 or 3) of each body
    @param contact  (·,3) points that touch
    @param up       (3) the direction that points up
    @param normals  (3) normals of planes. Views of their back are used only if there are no others.
    """
    places = np.concatenate([node for node, _ in surfaces])
    low, high = places.min(axis=0), places.max(axis=0)
    cell = (high - low).max() / CELLS
    bodies = [spread(node, element, 0.7 * cell) for node, element in surfaces]
    every = list(views(low, high, tilted, up))
    choices = [view for view in every if all(view.turn()[2] @ normal > -1e-9 for normal in normals)] or every
    best, most = choices[0], -np.inf
    for view in choices:
        clear = clearness(view, bodies, contact, cell)
        if clear > most + GAIN:
            best, most = view, clear
    return best
