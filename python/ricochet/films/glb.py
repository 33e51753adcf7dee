# SPDX-License-Identifier: BSD-2-Clause
"""Binary glTF: the numbers of a file, their accessors, and its two chunks.

Source: Khronos Group, glTF 2.0 specification (ISO/IEC 12113:2022), sections 3.6 (accessors) and 4.4 (chunks).
"""
import json
import struct
from typing import Any

import numpy as np

from ricochet.arrays import Array

FLOAT, UINT16, UINT32 = 5126, 5123, 5125  # component types
VERTICES, INDICES = 34962, 34963  # targets of buffer views
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
ALIGNED = 4  # bytes: every part of a file starts at a multiple


class Buffer:
    """The numbers of a file. Each array becomes an accessor with a buffer view of its own; equal ones are stored once."""

    def __init__(self) -> None:
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, int]] = []
        self._blocks: list[bytes] = []
        self._size = 0
        self._known: dict[tuple[Any, ...], int] = {}

    def floats(self, values: Array, target: int | None = None, bounds: bool = False) -> int:
        """The accessor of an array (n), (n,3) or (n,4), stored in 32 bits.

        @param bounds  states the least and largest values, as times and positions need
        """
        return self._accessor(np.ascontiguousarray(values, "<f4"), FLOAT, target, bounds)

    def indices(self, values: Array, count: int) -> int:
        """The accessor of the indices (n) of `count` vertices. The largest number of 16 bits is no index."""
        kind = UINT16 if count < 65536 else UINT32
        stored = np.ascontiguousarray(values, "<u2" if kind == UINT16 else "<u4")
        return self._accessor(stored, kind, INDICES, False)

    def _accessor(self, values: Array, component: int, target: int | None, bounds: bool) -> int:
        content = values.tobytes()
        key = (content, component, values.shape, target, bounds)
        if key in self._known:
            return self._known[key]
        view = {"buffer": 0, "byteOffset": self._size, "byteLength": len(content)}
        self.views.append(view | ({"target": target} if target else {}))
        self._blocks.append(content + bytes(-len(content) % ALIGNED))
        self._size += len(self._blocks[-1])
        width = 1 if values.ndim == 1 else values.shape[1]
        made = {
            "bufferView": len(self.views) - 1,
            "componentType": component,
            "type": TYPES[width],
            "count": len(values),
        }
        if bounds:
            rows = values.reshape(len(values), width)
            made |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.accessors.append(made)
        self._known[key] = len(self.accessors) - 1
        return self._known[key]

    def file(self, document: dict[str, Any]) -> bytes:
        """The content of a .glb: the JSON `document`, completed by accessors, views and the buffer, and the numbers."""
        numbers = b"".join(self._blocks)
        whole = document | {
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(numbers)}],
        }
        text = json.dumps(whole, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
        chunks = chunk(b"JSON", text, b" ") + chunk(b"BIN\0", numbers, b"\0")
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def chunk(kind: bytes, content: bytes, padding: bytes) -> bytes:
    """A chunk of a file, padded to whole words."""
    content += padding * (-len(content) % ALIGNED)
    return struct.pack("<I4s", len(content), kind) + content
