# SPDX-License-Identifier: BSD-2-Clause
"""A body of a film: its rigid motion as that of a node, and its deformation by a few shapes."""
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.films.basis import Basis, blocks, normalised
from ricochet.interchange.rotations import matrices_of, quaternion_of
from ricochet.pictures.moving_surfaces import MovingSurface
from ricochet.pictures.simplified import few_shapes, simplified

LEFT_OUT = 3e-4  # allowed relative root mean square error of the displacement as drawn, with fewer shapes than allowed


class FilmBody:
    """A body at the S snapshots of a film. Its node is at `translation` (S,3) and turned by `rotation`, unit quaternions w, x,
    y, z, (S,4) with finite rotations and otherwise (1,4). In the axes of the node, V vertices at `place` (V,3) and
    triangles `element` are moved by `shapes`, (r,V,3) fields and amplitudes.

    Without finite rotations, the node follows the centroid of the vertices in the motion by rigid modes. Small rotations by
    these modes are then a part of the shapes, and only the displacement by elastic modes and static response is magnified.
    """

    def __init__(
        self,
        surface: MovingSurface,
        chosen: NDArray[np.int64],
        share: float,
        body: dict[str, Any],
        magnify: float,
        most: int,
    ) -> None:
        """
        @param chosen   snapshots of the film
        @param share    share of this body in the triangles that all bodies may have
        @param body     keys of the body in the scene
        @param magnify  factor on the displacement by elastic modes
        @param most     number of shapes
        """
        self.surface, self.chosen = surface, chosen
        self.element, self.of, offset = simplified(surface, share, body)
        node = surface.node[self.of]
        self.pivot: Array = surface.poses.centre if surface.poses else node.mean(axis=0)
        self.place: Array = node + offset - self.pivot
        self._coordinates = surface.coordinates[chosen]
        rigid = surface.shape[self.of][:, :, surface.rigid].astype(float)
        self.rotation, self.translation = self._motion(rigid.mean(axis=0))
        self.shapes = self._shapes(rigid - rigid.mean(axis=0), magnify, most)

    def _motion(self, carried: Array) -> tuple[Array, Array]:
        """Rotation and translation of the node. `carried`: (3,r) displacement of the centroid by each rigid mode."""
        surface = self.surface
        if surface.poses:
            return continuous(surface.poses.attitude[self.chosen]), surface.poses.position[self.chosen]
        moved = self._coordinates[:, surface.rigid] @ carried.T
        start = surface.rotation @ self.pivot + surface.translation
        return quaternion_of(surface.rotation)[None], start + moved @ surface.rotation.T

    def _shapes(self, turning: Array, magnify: float, most: int) -> Basis:
        """The best shapes. `turning`: (V,3,r) displacement by each rigid mode relative to the centroid."""
        surface = self.surface
        fields = surface.shape[self.of] * surface.weights(magnify).astype("f4")
        fields[:, :, surface.rigid] = 0 if surface.poses else turning
        found, amplitudes = few_shapes(
            fields.reshape(3 * len(self.of), -1), self._coordinates, most, LEFT_OUT
        )
        basis = normalised(np.moveaxis(found.reshape(len(self.of), 3, -1), 2, 0), amplitudes)
        for some in blocks(len(self.of)):
            exact = fields[some].astype(float) @ self._coordinates.T
            drawn = np.moveaxis(basis.fields[:, some], 0, 2) @ basis.amplitudes.T
            basis.note(np.linalg.norm(exact - drawn, axis=1), np.linalg.norm(exact, axis=1))
        return basis

    def local(self, point: Array, k: int) -> Array:
        """(3) a point (3) of the world at snapshot k of the film, in the axes of the node; without finite rotations, a point
        at the start."""
        rotation, translation = self.surface.placement(int(self.chosen[k]))
        return np.asarray((point - translation) @ rotation - self.pivot)

    def deformation(self, vertex: int, keys: NDArray[np.int64]) -> Array:
        """(n,3) displacement of a vertex by all modes and static response at the snapshots `keys` of the film, in the axes of
        the node, not magnified [m]."""
        return np.asarray(self._coordinates[keys] @ self.surface.shape[self.of[vertex]].astype(float).T)

    def at(self, vertex: int, local: Array, keys: NDArray[np.int64]) -> Array:
        """(n,3) where a point near a vertex is drawn at the snapshots `keys` of the film; it moves with the vertex [m].

        @param local  (n,3) its place in the axes of the node, without deformation
        """
        moved = local + self.shapes.amplitudes[keys] @ self.shapes.fields[:, vertex]
        turns = np.broadcast_to(matrices_of(self.rotation), (len(self.chosen), 3, 3))[keys]
        return np.asarray(self.translation[keys] + np.einsum("sij,sj->si", turns, moved))


def continuous(quaternions: Array) -> Array:
    """The same rotations with the signs for which neighbours are near each other, as linear interpolation needs."""
    turns = np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0
    signs = np.append(1, np.cumprod(np.where(turns, -1, 1)))
    return quaternions * signs[:, None]
