# SPDX-License-Identifier: BSD-2-Clause
"""The axis along which pictures draw the motion at a contact point.

It points out of the side that an observer takes as still, so a body that falls on a floor comes down and rebounds
upwards. This side is the obstacle; otherwise the body with supports, if the other one has none; otherwise a body of at
least ten times the mass of the other one. Without such a side, the axis points from the first body to the second one.
"""
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ricochet.arrays import Array

HEAVY = 10.0  # ratio of masses from which the heavier body counts as still


@dataclass(frozen=True)
class NormalAxis:
    #: the axis is `sign` times the normal, which points out of the first side
    sign: int
    #: the side at whose initial surface positions are 0, and the same in words
    origin: str
    zero: str
    #: what a position and a velocity along it mean, for the labels of axes
    position: str
    velocity: str


def normal_axis(
    sides: tuple[str, str], normal: Array, scene: Mapping[str, Any], masses: Mapping[str, float]
) -> NormalAxis:
    """The axis at a contact point.

    @param sides   names of the two sides; names that are neither bodies nor obstacles are possible
    @param normal  (3) out of the first side, world axes
    @param masses  of the bodies [kg]
    """
    first, second = sides
    still = still_side(sides, scene, masses)
    if still is None:
        zero = f"where the surface of {second} was"
        return NormalAxis(1, second, zero, f"position towards {second}", f"velocity towards {second}")
    sign = 1 if still == first else -1
    is_obstacle = still in scene.get("obstacles", {})
    name = f"the {still}" if is_obstacle else still
    zero = name if is_obstacle and not moves(still, scene) else f"where the surface of {name} was"
    gravity = np.asarray(scene.get("loads", {}).get("gravity", [0, 0, 0]), dtype=float)
    upwards = -sign * (normal @ gravity) > 0.9 * np.linalg.norm(gravity)
    position = f"height above {name}" if upwards else f"distance from {name}"
    return NormalAxis(sign, still, zero, position, f"velocity away from {name}")


def moves(obstacle: str, scene: Mapping[str, Any]) -> bool:
    """Whether the surface of an obstacle moves: that of a half-space, along its normal."""
    table = scene["obstacles"][obstacle]
    motions = [one for one in scene.get("loads", {}).get("motion", []) if one.get("obstacle") == obstacle]
    shifts = np.array([table.get("velocity", [0, 0, 0])] + [one.get("vector", [0, 0, 0]) for one in motions])
    turns = [table.get("angular_velocity", [0, 0, 0])] + [one.get("turn_deg", [0, 0, 0]) for one in motions]
    if "normal" in table:
        along = shifts @ table["normal"] / np.linalg.norm(table["normal"])
        return bool(np.any(np.abs(along) > 1e-9 * np.linalg.norm(shifts, axis=1)))
    return bool(shifts.any() or np.any(turns))


def still_side(sides: tuple[str, str], scene: Mapping[str, Any], masses: Mapping[str, float]) -> str | None:
    """The side that an observer takes as still, or None if neither is."""
    first, second = sides
    if second in scene.get("obstacles", {}):
        return second
    if first not in masses or second not in masses:
        return None
    fixed = [bool(scene.get("bodies", {}).get(name, {}).get("support")) for name in sides]
    if fixed[0] != fixed[1]:
        return first if fixed[0] else second
    if fixed[0]:
        return None
    light, heavy = sorted(sides, key=lambda name: masses[name])
    return heavy if masses[heavy] >= HEAVY * masses[light] else None
