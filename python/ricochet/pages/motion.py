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
from ricochet.pictures.obstacles import ShownObstacle, shown_obstacles
from ricochet.pictures.planes import gravity_of, normals_of, upward
from ricochet.pictures.moving_surfaces import (
    MovingSurface,
    Poses,
    amplification,
    largest_amplification,
    moving_surfaces,
)
from ricochet.pictures.simplified import few_shapes, simplified
from ricochet.pictures.snapshots import MOMENTS as PICTURES
from ricochet.pictures.snapshots import drawn_path, moments
from ricochet.pictures.viewpoint import View, clearest

Packed = dict[str, Any]  # an array encoded as text

MOMENTS = 1200  # maximum number of snapshots, evenly spaced
SHAPES = 80  # maximum number of shapes of a body, without rigid motion
SHAPES_MB = 4  # maximum memory of the shapes of all bodies
LEFT_OUT = 3e-4  # allowed relative root mean square error of the deformation
POINTS = 300  # number of contact points whose forces are drawn, those with the largest impulse
MODES = 20  # maximum number of modes of a body whose shapes are in the page
MODES_MB = 4  # maximum size of the shapes of modes of all bodies, as text
STRESSES_MB = 4  # maximum memory of the fields of stress of all bodies


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


@dataclass
class Drawn:
    """A body of the page."""

    data: dict[str, Any]
    of: Array  # (V) node of the surface at each of its nodes
    place: Array  # (V,3) nodes at rest [m]
    element: Array  # (T,3)
    missed: float  # largest error of its deformation by the few shapes, at 60 moments [m]
    deformation: Array  # (S) largest displacement by elastic modes at each moment [m]


def fitted(
    shape: Array, coordinates: Array, modal: Array | slice, static: Array | slice, most: int
) -> tuple[Array, Array]:
    """At most `most` fields and their amplitudes in place of modal and static ones. The static fields are sharp and small, so that
    a fit to all fields would miss the place of contact."""
    local = few_shapes(shape[:, static], coordinates[:, static], most // 2, LEFT_OUT)
    wide = few_shapes(shape[:, modal], coordinates[:, modal], most - local[0].shape[1], LEFT_OUT)
    fields, amount = (np.concatenate(parts, axis=1) for parts in zip(wide, local))
    return fields, amount


def stress_of(
    result: LoadedResult, folder: Path, name: str, of: Array, chosen: Array, share: float
) -> dict[str, Any]:
    """The stress at the nodes `of` at the snapshots `chosen` by a few fields of xx, yy, zz, yz, xz, xy, its largest error by
    them as a share of the largest component, and the envelopes of the run.

    @param share  share of this body in the fields that all bodies may have
    """
    shape, coordinates = result.stress_fields(name, folder)
    shape = shape[of].reshape(6 * len(of), -1)
    modes = result.snapshots[name].shape[1]
    most = max(2, int(share * STRESSES_MB * 2**20 / (12 * len(of))))
    fields, amount = fitted(shape, coordinates[chosen], slice(modes), slice(modes, None), most)
    missed, largest = 0.0, 0.0
    for k in np.unique(np.linspace(0, len(chosen) - 1, 60).astype(int)):
        exact = shape @ coordinates[chosen[k]].astype(shape.dtype)
        largest = max(largest, float(np.abs(exact).max()))
        missed = max(missed, float(np.abs(exact - fields @ amount[k]).max()))
    envelope = result.stress[name]
    return {
        "fields": [packed(column, "i2") for column in fields.T],
        "amount": packed(amount),
        "missed": missed / largest if largest else 0.0,
        "envelope": {
            measure: packed(getattr(envelope, measure)[of], "i2")
            | {"largest": float(getattr(envelope, measure).max())}
            for measure in ("von_mises", "principal", "shear")
        },
    }


def body_of(name: str, surface: MovingSurface, chosen: Array, share: float, scene: dict[str, Any]) -> Drawn:
    """A body at the snapshots `chosen`.

    @param share  share of this body in the triangles and shapes that all bodies may have
    """
    node, coordinates = surface.node, surface.coordinates[chosen]
    element, of, offset = simplified(surface, share, scene.get("bodies", {}).get(name, {}))
    rotation, translation = surface.placement(0)
    shape = np.einsum("ij,vjn->vin", rotation.astype("f4"), surface.shape[of]).reshape(3 * len(of), -1)
    most = max(1, min(SHAPES, int(share * SHAPES_MB * 2**20 / (6 * len(of)))))
    rigid, moved = few_shapes(shape[:, surface.rigid], coordinates[:, surface.rigid], 6, 1e-12)
    bending, static = np.split(
        np.flatnonzero(~surface.rigid), [surface.modes - np.count_nonzero(surface.rigid)]
    )
    bent, amount = fitted(shape, coordinates, bending, static, most)
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
        "lines": surface.element.shape[1] == 3,
        "rigid": packed(rigid.T),
        "moved": packed(moved),
        "bent": [packed(column, "i2") for column in bent.T],
        "amount": packed(amount),
        "modes": {int(n) + 1: packed(shape[:, n], "i2") for n in some},
    }
    if surface.poses:
        data["poses"] = poses_of(surface.poses, chosen)
    return Drawn(data, of, place, element, missed, deformation)


def poses_of(poses: Poses, chosen: Array) -> dict[str, Any]:
    """The poses at the snapshots `chosen`: the centre of mass, its position, and the turn since the first snapshot, whose
    axes are those of the nodes and shapes."""
    start = poses.attitude[0] * [1, -1, -1, -1]
    return {
        "centre": poses.position[0].tolist(),
        "position": packed(poses.position[chosen]),
        "turn": packed(product(poses.attitude[chosen], start)),
    }


def obstacle_of(name: str, obstacle: ShownObstacle, chosen: Array) -> dict[str, Any]:
    """An obstacle at the snapshots `chosen`."""
    data = {"name": name, "node": packed(obstacle.at(0)), "element": packed(obstacle.element, "u4")}
    if obstacle.normal is not None:
        data["normal"] = obstacle.normal
    if obstacle.poses:
        data["poses"] = poses_of(obstacle.poses, chosen)
    return data


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
    share = 1 / len(surfaces)
    bodies = [body_of(name, surface, chosen, share, scene) for name, surface in surfaces.items()]
    for name, body in zip(surfaces, bodies):
        if name in result.stress and name in result.snapshots:
            body.data["stress"] = stress_of(result, folder, name, body.of, chosen, share)
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
    view = clearest(
        [(body.place, body.element) for body in bodies],
        spikes.place,
        tilted=True,
        up=upward(scene),
        normals=list(normals_of(scene).values()),
    )
    strain = np.max(
        [body.deformation / surface.size for body, surface in zip(bodies, surfaces.values())], axis=0
    )
    during = result.during(time[chosen])
    natural = amplification(strain[during].max())
    largest = max(body.deformation.max() for body in bodies)
    return {
        "time": packed(time[chosen]),
        "thinned": every,
        "snapshots": result.file.has("/snapshots/time"),
        "bodies": [body.data for body in bodies],
        "obstacles": [
            obstacle_of(name, obstacle, chosen)
            for name, obstacle in shown_obstacles(result.file, scene, *box).items()
        ],
        "gravity": gravity_of(scene),
        "view": {"base": view.base, "azimuth": view.azimuth, "elevation": view.elevation},
        "amplify": {"natural": natural, "most": max(natural, largest_amplification(strain.max()))},
        "pictures": during[moments(drawn_path(surfaces, chosen[during], natural), PICTURES)],
        "shapes": sum(len(body.data["bent"]) for body in bodies),
        "static": bool(result.file.names("/static")),
        "coordinates": sum(surface.modes for surface in surfaces.values()),
        "missed": max(body.missed for body in bodies) / largest if largest else 0.0,
        "stress_missed": max(
            (body.data["stress"]["missed"] for body in bodies if "stress" in body.data), default=0.0
        ),
        "points": spikes.data
        | {
            "left_out": int(np.count_nonzero(result.impulse())) - len(points),
        },
    }
