# SPDX-License-Identifier: BSD-2-Clause
"""Reads binary glTF with struct, json and NumPy, and checks it against the specification."""

import json
import struct
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

SIZES = {5123: 2, 5125: 4, 5126: 4}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
KINDS = {5123: "<u2", 5125: "<u4", 5126: "<f4"}


class Glb:
    """A binary glTF file, checked against the specification (sections 3.6 and 4.4) while it is read."""

    def __init__(self, path):
        content = Path(path).read_bytes()
        magic, version, length = struct.unpack_from("<4sII", content)
        assert (magic, version, length) == (b"glTF", 2, len(content))
        chunks, at = [], 12
        while at < length:
            size, kind = struct.unpack_from("<I4s", content, at)
            assert size % 4 == 0 and at + 8 + size <= length
            chunks.append((kind, content[at + 8 : at + 8 + size]))
            at += 8 + size
        (first, text), (second, self.numbers) = chunks
        assert (first, second) == (b"JSON", b"BIN\0")
        self.json = json.loads(text)
        self.nodes, self.meshes = self.json["nodes"], self.json["meshes"]
        assert self.json["asset"]["version"] == "2.0"
        (buffer,) = self.json["buffers"]
        assert 0 <= len(self.numbers) - buffer["byteLength"] < 4
        self.check_accessors()
        self.check_meshes()
        self.check_nodes()
        self.check_animations()

    def array(self, number):
        made = self.json["accessors"][number]
        width, count = WIDTHS[made["type"]], made["count"]
        view = self.json["bufferViews"][made["bufferView"]]
        size = SIZES[made["componentType"]] * width * count
        assert size <= view["byteLength"] and view["byteOffset"] % 4 == 0 and made.get("byteOffset", 0) == 0
        assert view["byteOffset"] + view["byteLength"] <= self.json["buffers"][0]["byteLength"]
        values = np.frombuffer(self.numbers, KINDS[made["componentType"]], width * count, view["byteOffset"])
        return values if width == 1 else values.reshape(count, width)

    def check_accessors(self):
        for number, made in enumerate(self.json["accessors"]):
            values = self.array(number)
            assert made["count"] > 0 and np.isfinite(values).all()
            if "min" in made:
                rows = values.reshape(made["count"], -1)
                np.testing.assert_array_equal(made["min"], rows.min(axis=0))
                np.testing.assert_array_equal(made["max"], rows.max(axis=0))
        used = {made["bufferView"] for made in self.json["accessors"]}
        assert used == set(range(len(self.json["bufferViews"])))

    def check_meshes(self):
        for mesh in self.meshes:
            (part,) = mesh["primitives"]
            accessors = self.json["accessors"]
            count = accessors[part["attributes"]["POSITION"]]["count"]
            indices = self.array(part["indices"])
            assert (
                len(indices) % 3 == 0
                and indices.max() < count
                and part["material"] < len(self.json["materials"])
            )
            if accessors[part["indices"]]["componentType"] == 5123:
                assert indices.max() < 65535
            for attributes in [part["attributes"], *part.get("targets", [])]:
                assert set(attributes) == set(part["attributes"])
                assert all(accessors[number]["count"] == count for number in attributes.values())
                assert "min" in accessors[attributes["POSITION"]]
            if "COLOR_0" in part["attributes"]:
                colour = self.array(part["attributes"]["COLOR_0"])
                assert colour.min() >= 0 and colour.max() <= 1
            if "targets" in part:
                assert len(mesh["weights"]) == len(part["targets"]) == len(mesh["extras"]["targetNames"])

    def check_nodes(self):
        (root,) = self.json["scenes"][self.json["scene"]]["nodes"]
        assert sorted(self.nodes[root]["children"]) == [k for k in range(len(self.nodes)) if k != root]
        for node in self.nodes:
            assert abs(np.linalg.norm(node.get("rotation", [0, 0, 0, 1])) - 1) < 1e-6
            assert node.get("mesh", 0) < len(self.meshes)

    def check_animations(self):
        self.samplers = {}
        for animation in self.json.get("animations", []):
            for channel in animation["channels"]:
                target, sampler = channel["target"], animation["samplers"][channel["sampler"]]
                key = target["node"], target["path"]
                assert key not in self.samplers and sampler["interpolation"] == "LINEAR"
                time, values = self.array(sampler["input"]), self.array(sampler["output"])
                assert "min" in self.json["accessors"][sampler["input"]]
                assert time[0] >= 0 and (np.diff(time) > 0).all()
                if target["path"] == "weights":
                    values = values.reshape(len(time), -1)
                    assert values.shape[1] == len(self.meshes[self.nodes[target["node"]]["mesh"]]["weights"])
                assert len(values) == len(time)
                if target["path"] == "rotation":
                    assert np.abs(np.linalg.norm(values, axis=1) - 1).max() < 1e-6
                    assert (np.sum(values[1:] * values[:-1], axis=1) >= 0).all()
                self.samplers[key] = time, values.astype(float)

    def number(self, name):
        (found,) = [k for k, node in enumerate(self.nodes) if node["name"] == name]
        return found

    def at(self, number, path, times, default):
        """Values of a property of a node at these times of the film."""
        if (number, path) not in self.samplers:
            return np.tile(np.asarray(self.nodes[number].get(path, default), float), (len(times), 1))
        time, values = self.samplers[number, path]
        return np.stack([np.interp(times, time, column) for column in values.T], axis=1)

    def fields(self, number, attribute, times):
        """(S,V,3) an attribute of the mesh of a node, moved by its morph targets."""
        mesh = self.meshes[self.nodes[number]["mesh"]]
        (part,) = mesh["primitives"]
        base = self.array(part["attributes"][attribute]).astype(float)
        targets = np.stack([self.array(target[attribute]) for target in part["targets"]]).astype(float)
        return base + np.einsum(
            "sr,rvc->svc", self.at(number, "weights", times, mesh.get("weights")), targets
        )

    def places(self, name, times):
        """(S,V,3) the vertices of a body in the axes of the world of the run."""
        number = self.number(name)
        local = self.fields(number, "POSITION", times)
        turn = Rotation.from_quat(self.at(number, "rotation", times, [0, 0, 0, 1])).as_matrix()
        shift = self.at(number, "translation", times, [0, 0, 0])
        return np.einsum("sij,svj->svi", turn, local) + shift[:, None]

    @property
    def extras(self):
        return self.json["scenes"][0]["extras"]
