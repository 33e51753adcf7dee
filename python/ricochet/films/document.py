# SPDX-License-Identifier: BSD-2-Clause
"""The parts of a glTF document: nodes, meshes, materials, and an animation of their motion."""
from typing import Any

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from ricochet._core import __version__
from ricochet.arrays import Array
from ricochet.films.glb import VERTICES, Buffer


def linear(colour: str) -> list[float]:
    """A colour of pictures, in sRGB, as the linear red, green and blue of materials (IEC 61966-2-1)."""
    coded = np.array(to_rgb(colour))
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4).tolist()


class Document:
    """A scene whose nodes are children of one root.

    @param seconds   (S) times of the snapshots in the film [s]
    @param rotation  (4) unit quaternion w, x, y, z from the axes of the world to those of glTF, whose y axis points up
    """

    def __init__(self, title: str, seconds: Array, rotation: Array) -> None:
        self.buffer = Buffer()
        self.seconds = seconds
        self.nodes: list[dict[str, Any]] = [
            {"name": title, "rotation": xyzw(rotation).tolist(), "children": []}
        ]
        self.meshes: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self._samplers: list[dict[str, Any]] = []
        self._channels: list[dict[str, Any]] = []

    def material(self, name: str, colour: str, opacity: float = 1.0, both: bool = True) -> int:
        """Adds a dull material and returns its number. @param both  whether both sides of triangles are seen"""
        made: dict[str, Any] = {
            "name": name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [*linear(colour), opacity],
                "metallicFactor": 0.0,
                "roughnessFactor": 0.8,
            },
            "doubleSided": both,
        }
        self.materials.append(made | ({"alphaMode": "BLEND"} if opacity < 1 else {}))
        return len(self.materials) - 1

    def mesh(
        self,
        name: str,
        place: Array,
        element: Array,
        material: int,
        colour: Array | None = None,
        shapes: Array | None = None,
        tints: Array | None = None,
    ) -> int:
        """Adds a mesh of triangles (T,3) between vertices (V,3) and returns its number. Without normals, viewers make those of
        each triangle, also of deformed ones.

        @param colour  (V,3) linear red, green and blue
        @param shapes  (r,V,3) morph targets of the places
        @param tints   (c,V,3) further targets, of the colours
        """
        attributes = {"POSITION": self.buffer.floats(place, VERTICES, bounds=True)}
        if colour is not None:
            attributes["COLOR_0"] = self.buffer.floats(colour, VERTICES)
        none = np.zeros((0, *place.shape))
        moved = [("POSITION", field) for field in (none if shapes is None else shapes)]
        moved += [("COLOR_0", field) for field in (none if tints is None else tints)]
        targets = []
        for kind, field in moved:
            # Each target has all attributes, because some viewers take the mesh's own for missing ones.
            all_fields = dict.fromkeys(attributes, np.zeros_like(place)) | {kind: field}
            targets.append(
                {name: self.buffer.floats(one, VERTICES, bounds=True) for name, one in all_fields.items()}
            )
        made: dict[str, Any] = {
            "attributes": attributes,
            "indices": self.buffer.indices(element.ravel(), len(place)),
            "material": material,
        }
        self.meshes.append({"name": name, "primitives": [made | ({"targets": targets} if targets else {})]})
        return len(self.meshes) - 1

    def weigh(self, mesh: int, weights: Array, shapes: int) -> None:
        """Gives the targets of a mesh weights (r), of viewers that show no motion, and names. The first ones
        are `shapes`, the others colours."""
        if len(weights):
            names = [
                f"shape {k + 1}" if k < shapes else f"colour {k - shapes + 1}" for k in range(len(weights))
            ]
            self.meshes[mesh] |= {"weights": weights.tolist(), "extras": {"targetNames": names}}

    def node(self, name: str, mesh: int, **placed: Any) -> int:
        """Adds a node below the root and returns its number. `placed`: translation, rotation x, y, z, w, and scale."""
        self.nodes.append({"name": name, "mesh": mesh} | {key: list(value) for key, value in placed.items()})
        self.nodes[0]["children"].append(len(self.nodes) - 1)
        return len(self.nodes) - 1

    def animate(self, node: int, path: str, values: Array, keys: NDArray[np.int64] | None = None) -> None:
        """Moves a property of a node in straight lines between snapshots. Constant ones need no animation.

        @param values  (n,…) at the snapshots `keys` (n), by default all
        """
        values = values.astype("f4")
        if len(values) < 2 or not np.ptp(values, axis=0).any():
            return
        seconds = self.seconds if keys is None else self.seconds[keys]
        flat = values.ravel() if path == "weights" else values
        sampler = {
            "input": self.buffer.floats(seconds, bounds=True),
            "interpolation": "LINEAR",
            "output": self.buffer.floats(flat),
        }
        self._samplers.append(sampler)
        self._channels.append({"sampler": len(self._samplers) - 1, "target": {"node": node, "path": path}})

    def file(self, extras: dict[str, Any]) -> bytes:
        """The content of the file. `extras` describe the scene."""
        moves = [{"name": "film", "channels": self._channels, "samplers": self._samplers}]
        return self.buffer.file(
            {
                "asset": {"version": "2.0", "generator": f"Ricochet {__version__}"},
                "scene": 0,
                "scenes": [{"name": self.nodes[0]["name"], "nodes": [0], "extras": extras}],
                "nodes": self.nodes,
                "meshes": self.meshes,
                "materials": self.materials,
            }
            | ({"animations": moves} if self._channels else {})
        )


def xyzw(quaternion: Array) -> Array:
    """Quaternions (…,4) w, x, y, z in the order of glTF."""
    return np.asarray(quaternion[..., [1, 2, 3, 0]])
