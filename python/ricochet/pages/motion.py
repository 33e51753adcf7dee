# SPDX-License-Identifier: BSD-2-Clause
"""The motion of a run for a page: visualisation surfaces of the bodies, moved by a few shapes in place of all
modes."""
import base64
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.interchange.rotations import product
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.planes import gravity_of, normals_of, square_of, upward
from ricochet.pictures.moving_surfaces import (
    MovingSurface,
    Poses,
    amplification,
    largest_amplification,
    moving_surfaces,
)
from ricochet.pictures.snapshots import MOMENTS as PICTURES
from ricochet.pictures.snapshots import drawn_path, moments
from ricochet.pictures.viewpoint import View, clearest

Packed = dict[str, Any]  # an array encoded as text

MOMENTS = 1200  # maximum number of snapshots, evenly spaced
TRIANGLES = 80_000  # maximum number of triangles of all bodies
SHAPES = 80  # maximum number of shapes of a body, without rigid motion
SHAPES_MB = 4  # maximum memory of the shapes of all bodies
LEFT_OUT = 3e-4  # allowed relative root mean square error of the deformation
POINTS = 300  # number of contact points whose forces are drawn, those with the largest impulse
SIDES = 12  # sides of a rod's cross-section
MODES = 20  # maximum number of modes of a body whose shapes are in the page
MODES_MB = 4  # maximum size of the shapes of modes of all bodies, as text


def packed(values: Any, kind: str = "f4") -> Packed:
    """Encodes an array as text. The types i2 and u2 contain fractions of the largest value, with 15 and 16
    bits. The types f4, u1 and u4 contain the values."""
    values = np.asarray(values)
    out: Packed = {"type": kind, "shape": list(values.shape)}
    if kind in ("i2", "u2"):
        largest = float(np.max(np.abs(values), initial=0)) or 1.0
        out["scale"] = largest / (32767 if kind == "i2" else 65535)
        values = np.rint(values / out["scale"])
    return out | {"data": base64.b64encode(np.ascontiguousarray(values, "<" + kind).tobytes()).decode()}


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


@dataclass
class Drawn:
    """A body of the page."""

    data: dict[str, Any]
    place: Array  # (V,3) nodes at rest [m]
    element: Array  # (T,3)
    missed: float  # largest error of its deformation by the few shapes, at 60 moments [m]
    deformation: Array  # (S) largest displacement by elastic modes at each moment [m]


def body_of(name: str, surface: MovingSurface, chosen: Array, share: float, scene: dict[str, Any]) -> Drawn:
    """A body at the snapshots `chosen`.

    @param share  share of this body in the triangles and shapes that all bodies may have
    """
    node, element, coordinates = surface.node, surface.element, surface.coordinates[chosen]
    offset: Any = 0.0
    of, tubular = np.arange(len(node)), element.shape[1] == 2
    if tubular:
        length = np.ptp(node, axis=0).max()
        element, of, offset = tube(node, element, radius_of(scene.get("bodies", {}).get(name, {}), length))
    elif len(element) > share * TRIANGLES:
        of, element = coarser(node, element, int(share * TRIANGLES))
    rotation, translation = surface.placement(0)
    shape = np.einsum("ij,vjn->vin", rotation.astype("f4"), surface.shape[of]).reshape(3 * len(of), -1)
    most = max(1, min(SHAPES, int(share * SHAPES_MB * 2**20 / (6 * len(of)))))
    rigid, moved = few_shapes(shape[:, surface.rigid], coordinates[:, surface.rigid], 6, 1e-12)
    bending, static = np.split(
        np.flatnonzero(~surface.rigid), [surface.modes - np.count_nonzero(surface.rigid)]
    )
    # The static fields are sharp and small, so that a fit to all fields would miss the place of contact.
    local = few_shapes(shape[:, static], coordinates[:, static], most // 2, LEFT_OUT)
    wide = few_shapes(shape[:, bending], coordinates[:, bending], most - local[0].shape[1], LEFT_OUT)
    bent, amount = (np.concatenate(parts, axis=1) for parts in zip(wide, local))
    elastic, coordinates = shape[:, ~surface.rigid], coordinates[:, ~surface.rigid]
    some = np.unique(np.linspace(0, len(chosen) - 1, 60).astype(int))
    missed = np.abs(elastic @ coordinates[some].T - bent @ amount[some].T).max(initial=0)
    place = (node[of] + offset) @ rotation.T + translation
    deformation = np.zeros(len(chosen))
    for part in np.array_split(bent.reshape(len(of), 3, -1), len(of) // 2000 + 1):
        np.maximum(deformation, np.linalg.norm(part @ amount.T, axis=1).max(axis=0), out=deformation)
    some = bending[: min(MODES, int(share * MODES_MB * 2**20 / (8 * len(of))))]
    data = {
        "name": name,
        "node": packed(place),
        "element": packed(element, "u4"),
        "lines": not tubular,
        "rigid": packed(rigid.T),
        "moved": packed(moved),
        "bent": [packed(column, "i2") for column in bent.T],
        "amount": packed(amount),
        "modes": {int(n) + 1: packed(shape[:, n], "i2") for n in some},
    }
    if surface.poses:
        data["poses"] = poses_of(surface.poses, chosen)
    return Drawn(data, place, element, missed, deformation)


def poses_of(poses: Poses, chosen: Array) -> dict[str, Any]:
    """The poses at the snapshots `chosen`: the centre of mass, its position, and the turn of the body since the first
    snapshot, whose axes are those of its nodes and shapes."""
    start = poses.attitude[0] * [1, -1, -1, -1]
    return {
        "centre": poses.position[0].tolist(),
        "position": packed(poses.position[chosen]),
        "turn": packed(product(poses.attitude[chosen], start)),
    }


def nearest(points: Array, places: Sequence[Array]) -> tuple[Array, Array]:
    """The nearest body and node of each point, and the offset of the point from that node."""
    best = np.full(len(points), np.inf)
    found, offset = np.zeros((len(points), 2), int), np.zeros((len(points), 3))
    for body, place in enumerate(places):
        for i, point in enumerate(points):
            away = np.sum((place - point) ** 2, axis=1)
            if away.min() < best[i]:
                node = away.argmin()
                best[i], found[i], offset[i] = away[node], (body, node), point - place[node]
    return found, offset


def rows_at(result: LoadedResult, times: Array) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """The contact row of each time, and whether there is one."""
    if len(result.contact_time) == 0:
        return np.zeros(len(times), int), np.zeros(len(times), bool)
    half = 0.5 * result.spacing
    row = np.minimum(np.searchsorted(result.contact_time, times - half), len(result.contact_time) - 1)
    return row, np.abs(result.contact_time[row] - times) <= half


def forces_at(result: LoadedResult, times: Array, points: Array) -> Array:
    """(S,p) force at these points and times; 0 if the result has no contact row for a time."""
    row, near = rows_at(result, times)
    out = np.zeros((len(times), len(points)))
    out[near] = result.forces.of_rows(row[near], points)
    return out


def states_at(result: LoadedResult, times: Array, points: Array) -> Array:
    """(S,p) states at these points and times; open if the result has no contact row for a time."""
    row, near = rows_at(result, times)
    out = np.zeros((len(times), len(points)), dtype=np.uint8)
    out[near] = result.states.of_rows(row[near], points)
    return out


@dataclass
class Spikes:
    """Contact points whose forces a page draws."""

    data: dict[str, Any]
    place: Array  # (p,3) where they are at the start, or would be if they moved with their body [m]


def spikes_at(
    result: LoadedResult, times: Array, points: NDArray[np.int64], places: Sequence[Array]
) -> Spikes:
    """Points that stay where they are on their body."""
    anchor, offset = nearest(result.point_a[points], places)
    data = {
        "anchor": anchor.tolist(),
        "offset": packed(offset),
        "normal": packed(result.normal[points]),
        "force": packed(forces_at(result, times, points), "u2"),
        "state": packed(states_at(result, times, points), "u1") if result.has_friction else None,
    }
    return Spikes(data, result.point_a[points])


def moving_spikes(
    result: LoadedResult,
    surfaces: dict[str, MovingSurface],
    chosen: Array,
    time: Array,
    points: NDArray[np.int64],
    places: Sequence[Array],
) -> Spikes:
    """Points that move over the bodies: those of each snapshot in `chosen`, of which "first" has the number of the first
    one, and at last the number of all."""
    contacts, names = result.contacts, list(surfaces)
    shown = np.flatnonzero(np.isin(contacts.point, points))
    row, near = rows_at(result, time[chosen])
    edges = np.searchsorted(contacts.row[shown], [row, row + near])
    some = [shown[first:stop] for first, stop in edges.T]
    entry = np.concatenate([*some, np.zeros(0, int)])
    snapshot = np.repeat(chosen, [len(one) for one in some])
    anchor, offset = np.zeros((len(entry), 2), int), np.zeros((len(entry), 3))
    place = contacts.place[entry]
    for number, (e, k) in enumerate(zip(entry, snapshot)):
        body = names.index(contacts.a[e] if contacts.a[e] in surfaces else contacts.b[e])
        place[number] = surfaces[names[body]].at_start(place[number], k)
        (found,), offset[number] = nearest(place[[number]], [places[body]])
        anchor[number] = body, found[1]
    data = {
        "first": np.cumsum([0, *(len(one) for one in some)]).tolist(),
        "anchor": anchor.tolist(),
        "offset": packed(offset),
        "normal": packed(contacts.normal[entry]),
        "force": packed(contacts.force[entry], "u2"),
        "state": None if contacts.state is None else packed(contacts.state[entry], "u1"),
    }
    return Spikes(data, place)


def of_rest(bodies: Sequence[dict[str, Any]], view: View) -> dict[str, Any]:
    """The data of bodies that do not move, in the form of an animation of one moment."""
    none = packed(np.zeros(0))
    return {
        "time": packed([0.0]),
        "snapshots": True,
        "bodies": bodies,
        "obstacles": [],
        "amplify": {"natural": 1, "most": 2},
        "view": {"base": view.base, "azimuth": view.azimuth, "elevation": view.elevation},
        "points": {"anchor": [], "offset": none, "normal": none, "force": none, "state": None},
    }


def motion_of(result: LoadedResult, folder: Path, scene: dict[str, Any]) -> dict[str, Any]:
    """The data of the animation, or {"missing": reason} if there are no visualisation surfaces or kernels. Without
    snapshots, it consists of one moment, of bodies at rest."""
    found = moving_surfaces(result, folder, at_rest=True)
    if isinstance(found, str):
        return {"missing": found}
    surfaces, time = found
    every = -(-len(time) // MOMENTS)
    chosen = np.arange(0, len(time), every)
    bodies = [body_of(name, surface, chosen, 1 / len(surfaces), scene) for name, surface in surfaces.items()]
    places = [body.place for body in bodies]
    reaches = [surface.reach() for surface in surfaces.values() if surface.poses]
    everything = np.concatenate([*places, *reaches])
    box = everything.min(axis=0), everything.max(axis=0)
    points = np.sort(np.argsort(result.impulse())[::-1][:POINTS])
    points = points[result.impulse()[points] > 0]
    if result.has_entries:
        spikes = moving_spikes(result, surfaces, chosen, time, points, places)
    else:
        spikes = spikes_at(result, time[chosen], points, places)
    planes = normals_of(scene)
    view = clearest(
        [(body.place, body.element) for body in bodies],
        spikes.place,
        tilted=True,
        up=upward(scene),
        normals=list(planes.values()),
    )
    strain = np.max(
        [body.deformation / surface.size for body, surface in zip(bodies, surfaces.values())], axis=0
    )
    spans = result.spans()
    touching = (time[chosen] >= spans[0][0]) & (time[chosen] <= spans[-1][1]) if spans else np.array([False])
    during = np.flatnonzero(touching) if touching.any() else np.arange(len(chosen))
    natural = amplification(strain[during].max())
    largest = max(body.deformation.max() for body in bodies)
    return {
        "time": packed(time[chosen]),
        "thinned": every,
        "snapshots": result.file.has("/snapshots/time"),
        "bodies": [body.data for body in bodies],
        "obstacles": [
            {
                "name": name,
                "node": packed(square_of(plane, *box)),
                "element": packed([[0, 1, 2], [0, 2, 3]], "u4"),
                "normal": planes[name],
            }
            for name, plane in scene.get("obstacles", {}).items()
        ],
        "gravity": gravity_of(scene),
        "view": {"base": view.base, "azimuth": view.azimuth, "elevation": view.elevation},
        "amplify": {"natural": natural, "most": max(natural, largest_amplification(strain.max()))},
        "pictures": during[moments(drawn_path(surfaces, chosen[during], natural), PICTURES)],
        "shapes": sum(len(body.data["bent"]) for body in bodies),
        "static": bool(result.file.names("/static")),
        "coordinates": sum(surface.modes for surface in surfaces.values()),
        "missed": max(body.missed for body in bodies) / largest if largest else 0.0,
        "points": spikes.data
        | {
            "left_out": int(np.count_nonzero(result.impulse())) - len(points),
        },
    }
