# SPDX-License-Identifier: BSD-2-Clause
"""Visualisation surfaces of the bodies of a result, moved by its snapshots."""
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.rotations import matrices_of
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.static_part import static_part
from ricochet.result_file import File, are_finite, is_there

STILL = 0.01  # deformation is drawn larger if all of it is below this, relative to the size of the body
SHOWN = 0.1  # largest deformation, relative to the size, that is then drawn
MOST = 0.25  # the same at the upper end of a choice


@dataclass
class Poses:
    """Where a body with finite rotations, or an obstacle, is at each snapshot; world axes."""

    position: Array  # (s,3) centre of mass, or origin of an obstacle [m]
    attitude: Array  # (s,4) unit quaternion w, x, y, z, from its own axes
    centre: Array  # (3) the same point in its own axes [m]

    def __post_init__(self) -> None:
        self.rotation: Array = matrices_of(self.attitude)  # (s,3,3)
        self.translation: Array = self.position - self.rotation @ self.centre  # (s,3) [m]


class MovingSurface:
    """The visualisation surface of a body, moved by its modes and by the static response of the modes left out
    (`static`, fields and amplitudes, after the modes in `shape` (V,3,N+r) and `coordinates` (s,N+r)). With `poses`,
    these move the body as a whole, and the coordinates of its rigid modes are 0."""

    def __init__(
        self,
        kernel: File,
        rotation: Array,
        translation: Array,
        coordinates: Array,
        static: tuple[Array, Array] | None = None,
        poses: Poses | None = None,
    ) -> None:
        self.rotation, self.translation, self.poses = rotation, translation, poses
        self.node = kernel.array("/view/node", None, 3).astype(float)
        self.element = kernel.array("/view/element", None, None).astype(int)
        self.modes = coordinates.shape[1]
        shape = kernel.array("/view/shape", len(self.node), 3, self.modes)
        fields, amplitudes = static or (shape[:, :, :0], coordinates[:, :0])
        self.shape = np.concatenate([shape, fields], axis=2)
        if self.element.size == 0 or self.element.shape[1] not in (2, 3):
            raise InputError(
                f'{kernel.path}: dataset "/view/element" holds neither lines nor triangles. Compute it again.'
            )
        if not (0 <= self.element.min() and self.element.max() < len(self.node)):
            raise InputError(
                f'{kernel.path}: dataset "/view/element" names nodes that do not exist. ' "Compute it again."
            )
        self.omega = kernel.array("/modes/angular_frequency", coordinates.shape[1])
        self.rigid = np.append(self.omega == 0, np.zeros(amplitudes.shape[1], bool))
        self.coordinates = np.concatenate([coordinates, amplitudes], axis=1)

    @property
    def size(self) -> float:
        """The diagonal of the box around the body at rest [m]"""
        return float(np.linalg.norm(np.ptp(self.node, axis=0)))

    def weights(self, amplify: float) -> Array:
        """(N) factors on the coordinates: `amplify` on elastic modes, 1 on rigid ones."""
        return np.where(self.rigid, 1.0, amplify)

    def at(self, k: int, amplify: float = 1.0) -> Array:
        """(V,3) node positions at snapshot k [m]. `amplify` multiplies the deformation, not the rigid motion."""
        now = self.weights(amplify) * self.coordinates[k]
        rotation, translation = self.placement(k)
        return np.asarray((self.node + self.shape @ now) @ rotation.T + translation)

    def placement(self, k: int) -> tuple[Array, Array]:
        """(3,3) rotation and (3) translation [m] from the axes of the body to those of the world at snapshot k: the
        initial ones without poses."""
        if self.poses is None:
            return self.rotation, self.translation
        return self.poses.rotation[k], self.poses.translation[k]

    def carried(self, points: Array, k: int) -> Array:
        """(·,3) points of the initial placement, moved by the pose of snapshot k [m]; without poses, not moved."""
        if self.poses is None:
            return points
        rotation, translation = self.placement(k)
        return np.asarray((points - self.translation) @ self.rotation @ rotation.T + translation)

    def at_start(self, points: Array, k: int) -> Array:
        """(·,3) places at snapshot k, moved back with the body to the initial placement [m]; inverse of `carried`."""
        if self.poses is None:
            return points
        rotation, translation = self.placement(k)
        return np.asarray((points - translation) @ rotation @ self.rotation.T + self.translation)

    def reach(self) -> Array:
        """(2,3) corners of a box around the body at all poses, without its deformation [m]."""
        assert self.poses is not None
        radius = np.linalg.norm(self.node - self.poses.centre, axis=1).max()
        return np.stack([self.poses.position.min(axis=0) - radius, self.poses.position.max(axis=0) + radius])

    def deformations(self, k: int) -> Array:
        """(V) displacements without those of the rigid modes at snapshot k [m]."""
        moved = self.shape @ np.where(self.rigid, 0, self.coordinates[k]).astype(self.shape.dtype)
        return np.asarray(np.linalg.norm(moved, axis=1))

    def deformation(self, k: int) -> float:
        """The largest of them [m]."""
        return float(self.deformations(k).max())

    def strain(self, k: int) -> float:
        """The largest displacement by elastic modes at snapshot k, relative to the size of the body"""
        return self.deformation(k) / (self.size or 1.0)

    def largest_strain(self, snapshots: NDArray[np.int64]) -> float:
        """The largest of the strains at some snapshots, computed for parts of the nodes to save memory."""
        elastic = np.flatnonzero(~self.rigid)
        amplitudes = self.coordinates[snapshots][:, elastic].T.astype("f4")
        parts = np.array_split(np.arange(len(self.node)), len(self.node) // 2000 + 1)
        largest = (
            np.linalg.norm(self.shape[some][:, :, elastic] @ amplitudes, axis=1).max() for some in parts
        )
        return float(max(largest)) / (self.size or 1.0)

    def outline(self, flat: Array) -> Array:
        """(·,2,2) end points of the edges of `rim`"""
        return np.asarray(flat[self.rim(flat)])

    def rim(self, flat: Array) -> NDArray[Any]:
        """(·,2) edges of the outline: between a triangle that faces the viewer and one that does not, or at
        the boundary of the surface. `flat`: (V,2) projected nodes."""
        e = self.element
        if e.shape[1] == 2:
            return e
        ab, ac = flat[e[:, 1]] - flat[e[:, 0]], flat[e[:, 2]] - flat[e[:, 0]]
        facing = np.tile(ab[:, 0] * ac[:, 1] > ab[:, 1] * ac[:, 0], 3)
        sides = np.concatenate([e[:, side] for side in ([0, 1], [1, 2], [2, 0])])
        sides.sort(axis=1)
        unique, which, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
        towards = np.bincount(which.ravel(), weights=facing, minlength=len(unique))
        return np.asarray(unique[(count == 1) | ((towards > 0) & (towards < count))])


def amplification(share: float) -> float:
    """The factor by which deformation is drawn larger, for a largest deformation relative to the size of the body: 1 if
    that is visible, otherwise a round number."""
    if not 1e-12 < share < STILL:
        return 1.0
    ten = 10.0 ** np.floor(np.log10(SHOWN / share))
    return float(ten * max(factor for factor in (1, 2, 5) if factor * ten <= SHOWN / share))


def largest_amplification(share: float) -> float:
    """The factor with which the largest deformation is drawn as a quarter of the size of the body."""
    return max(amplification(share), MOST / share if share > 1e-12 else 1.0, 2.0)


def moving_surfaces(
    result: LoadedResult, folder: Path, at_rest: bool = False
) -> tuple[dict[str, MovingSurface], Array] | str:
    """The surfaces by body and the times of their snapshots, or the reason why there are none. With `at_rest`, a result
    without snapshots has one at time 0, of bodies that have not moved."""
    f = result.file
    still = at_rest and not f.has("/snapshots/time")
    if not still and not f.has("/snapshots/time"):
        return "the result has no snapshots (set [output] snapshot_every)"
    time = np.zeros(1) if still else f.array("/snapshots/time", None)
    surfaces = {}
    for body in result.bodies:
        if not still and not f.has(f"/snapshots/{body}"):
            continue
        where = f"/bodies/{body}"
        name = f.text(where, "kernel")
        rotation, translation = (f.attribute(where, key) for key in ("rotation", "translation"))
        if not name or not are_finite(rotation, 9) or not are_finite(translation, 3):
            return f"the result does not hold the position of {body}"
        path = folder / Path(name).name
        if not is_there(path):
            return f"there is no kernel {path} (set --kernels)"
        kernel = File(path, "ricochet-kernel")
        if not kernel.has("/view/node"):
            return f"{path.name} has no visualisation surface (set [output] view = true)"
        if still:
            coordinates = np.zeros((1, len(kernel.array("/modes/angular_frequency", None))))
        else:
            coordinates = f.array(f"/snapshots/{body}", len(time), None)
        surfaces[body] = MovingSurface(
            kernel,
            np.reshape(rotation, (3, 3)),
            np.reshape(translation, 3),
            coordinates,
            static_part(f, kernel, body, len(time)),
            None if still else poses_of(f, kernel, body, len(time)),
        )
    return (surfaces, time) if surfaces else "the result has no snapshots of bodies"


def poses_of(result: File, kernel: File, body: str, count: int) -> Poses | None:
    """The poses of a body at the `count` snapshots; None without finite rotations."""
    group = f"/pose/{body}"
    if not result.has(f"{group}/attitude"):
        return None
    return read_poses(result, group, count, kernel.array("/body/centre", 3))


def read_poses(result: File, group: str, count: int, centre: Array) -> Poses:
    """The `count` poses of a group."""
    attitude = result.array(f"{group}/attitude", count, 4)
    if np.abs(np.linalg.norm(attitude, axis=1) - 1).max(initial=0) > 1e-6:
        raise InputError(
            f'{result.path}: dataset "{group}/attitude" holds other than unit quaternions. Compute it again.'
        )
    return Poses(result.array(f"{group}/position", count, 3), attitude, centre)
