# SPDX-License-Identifier: BSD-2-Clause
"""The contact forces of a film, an arrow for each contact point."""
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.films.bodies import FilmBody
from ricochet.pages.motion import rows_at
from ricochet.pictures.loaded_result import LoadedResult

MOST = 100  # arrows, of the points with the largest impulse
SIDES = 12
HEAD, THIN, WIDE = (
    0.3,
    0.02,
    0.06,
)  # length of the head, radius of the shaft and of the head, relative to the length


@dataclass
class Arrow:
    """The force on a body at a contact point, at the snapshots `keys` (n) of the film: those at which it is not 0, and the ones
    before and after."""

    name: str
    keys: NDArray[np.int64]
    place: Array  # (n,3) where the point is drawn [m], world axes
    force: Array  # (n,3) [N], world axes
    inside: bool  # whether it lies in the other body of the pair


def arrows_of(result: LoadedResult, time: Array, bodies: dict[str, FilmBody]) -> tuple[list[Arrow], float]:
    """The arrows, by the number of the contact point, and the share of the impulse of the points that have none.

    @param time    of the snapshots of the film [s]
    @param bodies  by name
    """
    impulse = result.impulse()
    points = np.argsort(impulse, kind="stable")[::-1][:MOST]
    left_out = 1 - impulse[points].sum() / (impulse.sum() or 1)
    contacts = result.contacts
    row, near = rows_at(result, time)
    edges = np.searchsorted(contacts.row, [row, row + near])
    entry = np.concatenate([np.arange(first, stop) for first, stop in edges.T]).astype(int)
    snapshot = np.repeat(np.arange(len(time)), edges[1] - edges[0])
    pressed = contacts.force[entry] > 0
    entry, snapshot = entry[pressed], snapshot[pressed]
    found = []
    for point in np.intersect1d(points, contacts.point[entry]):
        here = contacts.point[entry] == point
        found.append(arrow_at(result, int(point), entry[here], snapshot[here], bodies))
    return [arrow for arrow in found if arrow], max(float(left_out), 0.0)


def arrow_at(
    result: LoadedResult,
    point: int,
    entry: NDArray[np.int64],
    snapshot: NDArray[np.int64],
    bodies: dict[str, FilmBody],
) -> Arrow | None:
    """The arrow of a contact point, with the entries `entry` of the contacts at the snapshots `snapshot`. It shows the force on
    the first body, or on the second one if the first is not drawn. None if neither is drawn."""
    contacts, (a, b) = result.contacts, result.sides_names(point)
    name, sign = (a, -1) if a in bodies else (b, 1)
    if name not in bodies:
        return None
    body = bodies[name]
    force = contacts.force[entry, None] * contacts.normal[entry]  # on the second body
    if contacts.tangential_force is not None:
        force = force + contacts.tangential_force[entry]
    local = np.stack([body.local(at, k) for at, k in zip(contacts.place[entry], snapshot)])
    keys = np.unique(np.clip(snapshot[:, None] + [-1, 0, 1], 0, len(body.chosen) - 1))
    vertex = int(np.argmin(np.linalg.norm(body.place - local[0], axis=1)))
    if result.has_entries:  # the places are those of the deformed body; otherwise of the start
        local = local - body.deformation(vertex, snapshot)
    known = np.searchsorted(keys, snapshot)
    all_forces, nearest = np.zeros((len(keys), 3)), np.abs(keys[:, None] - snapshot).argmin(axis=1)
    all_forces[known] = sign * force
    place = body.at(vertex, local[nearest], keys)
    inside = a in bodies and b in bodies
    return Arrow(f"force on {name} at point {point}", keys, place, all_forces, inside)


def turns_to(direction: Array) -> Array:
    """(n,4) unit quaternions w, x, y, z of the smallest turns from the y axis to unit vectors (n,3)."""
    x, y, z = direction.T
    half = np.stack(
        [1 + y, z, 0 * y, -x], axis=1
    )  # 1 + cos, and the cross product of the y axis and the vector
    half[y < -1 + 1e-12] = [0, 1, 0, 0]
    return np.asarray(half / np.linalg.norm(half, axis=1, keepdims=True))


def directions(force: Array) -> Array:
    """(n,3) unit vectors along forces (n,3), at least one of which is not 0; where one is 0, that of the nearest other."""
    size = np.linalg.norm(force, axis=1)
    known = np.flatnonzero(size)
    nearest = known[np.abs(np.arange(len(force))[:, None] - known).argmin(axis=1)]
    return force[nearest] / size[nearest, None]


def mesh() -> tuple[Array, Array]:
    """(V,3) vertices and (T,3) triangles of an arrow along the y axis, of length 1, whose tip is at the origin."""
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    circle = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)
    rings = [circle * radius - [0, down, 0] for radius, down in ((THIN, 1), (THIN, HEAD), (WIDE, HEAD))]
    place = np.concatenate([*rings, [[0, -1, 0], [0, 0, 0]]])
    here = np.arange(SIDES)
    turned = (here + 1) % SIDES
    faces = [np.stack([np.full(SIDES, len(place) - 2), turned, here], axis=1)]
    for ring in (0, SIDES):
        faces.append(np.stack([ring + here, ring + turned, ring + SIDES + turned], axis=1))
        faces.append(np.stack([ring + here, ring + SIDES + turned, ring + SIDES + here], axis=1))
    last = 2 * SIDES
    faces.append(np.stack([last + here, last + turned, np.full(SIDES, len(place) - 1)], axis=1))
    return place, np.concatenate(faces)
