# SPDX-License-Identifier: BSD-2-Clause
"""The obstacles of a result as pictures, pages and films show them: triangles, which a prescribed motion carries."""
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.pictures.moving_surfaces import Poses, read_poses
from ricochet.pictures.planes import normals_of, planes_of, square_of
from ricochet.result_file import File


@dataclass
class ShownObstacle:
    """An obstacle with the triangles `element` (t,3)."""

    node: Array  # (n,3) [m] in its own axes if it moves, otherwise in those of the world
    element: NDArray[np.int64]
    normal: Array | None = None  # (3) out of a half-space
    poses: Poses | None = None  # at the snapshots, if it moves

    def at(self, k: int) -> Array:
        """(n,3) nodes at snapshot k, world axes [m]"""
        if self.poses is None:
            return self.node
        return np.asarray(self.node @ self.poses.rotation[k].T + self.poses.translation[k])


def shown_obstacles(file: File, scene: dict[str, Any], low: Array, high: Array) -> dict[str, ShownObstacle]:
    """By name: the part of each half-space that is near the box of the bodies, from `low` to `high` [m], and the surfaces of the
    other obstacles."""
    groups = {file.text(f"/obstacles/{n}", "name") or n: f"/obstacles/{n}" for n in file.names("/obstacles")}
    normals, square = normals_of(scene), np.array([[0, 1, 2], [0, 2, 3]])
    found = {
        name: ShownObstacle(square_of(plane, low, high), square, normals[name])
        for name, plane in planes_of(scene).items()
    }
    for name, group in groups.items():
        if file.has(f"{group}/node"):
            node, element = file.array(f"{group}/node", None, 3), file.array(f"{group}/element", None, 3)
            found[name] = ShownObstacle(node, element.astype(np.int64))
        if file.has(f"{group}/pose/position"):
            one, count = found[name], len(file.array("/snapshots/time", None))
            one.poses = read_poses(file, f"{group}/pose", count, np.zeros(3))
            start = np.reshape(file.attribute(group, "rotation"), (3, 3))
            one.node = (one.node - file.attribute(group, "translation")) @ start
    return found
