# SPDX-License-Identifier: BSD-2-Clause
"""Visualisation surfaces (skins) of the bodies of a result, moved by its snapshots."""
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.pictures.history import History
from ricochet.pictures.static_part import static_part
from ricochet.result_file import File, are_finite, is_there


class Skin:
    """The visualisation surface of a body, moved by its modes and by the static response of the modes left out
    (`static`, fields and amplitudes, behind the modes in `shape` (V,3,N+r) and `coordinates` (s,N+r))."""

    def __init__(
        self,
        kernel: File,
        rotation: Array,
        translation: Array,
        coordinates: Array,
        static: tuple[Array, Array] | None = None,
    ) -> None:
        self.rotation, self.translation = rotation, translation
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
        rigid = kernel.array("/modes/angular_frequency", coordinates.shape[1]) == 0
        self.rigid = np.append(rigid, np.zeros(amplitudes.shape[1], bool))
        self.coordinates = np.concatenate([coordinates, amplitudes], axis=1)

    def at(self, k: int, start: int | None = None, amplify: float = 1.0) -> Array:
        """(V,3) node positions at snapshot k [m]. `amplify` multiplies the motion since snapshot `start`."""
        now = self.coordinates[k]
        if start is not None:
            now = self.coordinates[start] + amplify * (now - self.coordinates[start])
        return np.asarray((self.node + self.shape @ now) @ self.rotation.T + self.translation)

    def deformation(self, k: int) -> float:
        """The largest displacement without that of the rigid modes at snapshot k [m]."""
        moved = self.shape[:, :, ~self.rigid] @ self.coordinates[k, ~self.rigid]
        return float(np.linalg.norm(moved, axis=1).max())

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
        sides = np.sort(np.concatenate([e[:, [0, 1]], e[:, [1, 2]], e[:, [2, 0]]]), axis=1)
        unique, which, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
        towards = np.bincount(which.ravel(), weights=facing, minlength=len(unique))
        return np.asarray(unique[(count == 1) | ((towards > 0) & (towards < count))])


def skins_of(result: History, folder: Path) -> tuple[dict[str, Skin], Array] | str:
    """The skins by body and the times of their snapshots, or the reason why there are none."""
    f = result.file
    if not f.has("/snapshots/time"):
        return "the result has no snapshots (set [output] snapshot_every)"
    time = f.array("/snapshots/time", None)
    skins = {}
    for body in result.bodies:
        if not f.has(f"/snapshots/{body}"):
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
        coordinates = f.array(f"/snapshots/{body}", len(time), None)
        skins[body] = Skin(
            kernel,
            np.reshape(rotation, (3, 3)),
            np.reshape(translation, 3),
            coordinates,
            static_part(f, kernel, body, len(time)),
        )
    return (skins, time) if skins else "the result has no snapshots of bodies"
