# SPDX-License-Identifier: BSD-2-Clause
"""The half-spaces of a scene, and the direction that points up in its pictures."""
from typing import Any

import numpy as np

from ricochet.arrays import Array

WALL = 0.9  # a normal within acos(0.9) = 26° of x is that of a wall, because x is horizontal by custom


def planes_of(scene: dict[str, Any]) -> dict[str, Any]:
    """The tables of the half-spaces, by name."""
    obstacles = scene.get("obstacles", {})
    return {
        name: table for name, table in obstacles.items() if table.get("shape", "half-space") == "half-space"
    }


def normals_of(scene: dict[str, Any]) -> dict[str, Array]:
    """(3) unit normals of the half-spaces, out of them, by name."""
    found = {name: np.array(plane["normal"], float) for name, plane in planes_of(scene).items()}
    return {name: normal / np.linalg.norm(normal) for name, normal in found.items()}


def gravity_of(scene: dict[str, Any]) -> Array | None:
    """(3) the acceleration of gravity [m/s²]; None if there is none."""
    gravity = np.array(scene.get("loads", {}).get("gravity", [0, 0, 0]), float)
    return gravity if gravity.any() else None


def upward(scene: dict[str, Any]) -> Array | None:
    """(3) the unit vector that points up: against gravity; without gravity, the normal of the half-spaces if they
    are parallel and no wall. Otherwise None."""
    gravity, normals = gravity_of(scene), list(normals_of(scene).values())
    if gravity is not None:
        return np.asarray(-gravity / np.linalg.norm(gravity))
    if normals and all(normal @ normals[0] > 0.999 for normal in normals) and abs(normals[0][0]) < WALL:
        return np.asarray(normals[0])
    return None


def square_of(plane: dict[str, Any], low: Array, high: Array) -> Array:
    """(4,3) corners of the part of a half-space that is near the box of the bodies, from `low` to `high` [m]."""
    point, normal = np.array(plane.get("point", [0, 0, 0]), float), np.array(plane["normal"], float)
    normal /= np.linalg.norm(normal)
    centre = (low + high) / 2
    centre = centre - normal * (normal @ (centre - point))
    side = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    side *= 0.7 * np.max(high - low) / np.linalg.norm(side)
    other = np.cross(normal, side)
    return np.asarray(centre + np.array([side + other, side - other, -side - other, other - side]))
