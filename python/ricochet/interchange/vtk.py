# SPDX-License-Identifier: BSD-2-Clause
"""Unstructured grids of ParaView and VTK: .vtu and the older .vtk.

Source: "VTK file formats", docs.vtk.org. Cells of order 2 have the node order of Abaqus; the places of the nodes show
that of Lagrange cells.
"""
import base64
import lzma
import re
import xml.etree.ElementTree as xml
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.cells import FACET, SOLID, Cells, labelled, mesh_of, no_pyramids
from ricochet.interchange.elements import SIZES
from ricochet.interchange.mesh import Mesh

# Dimension by type of cell. Lagrange cells (69 to 73) have their order by their number of nodes.
KINDS = {
    **dict.fromkeys((10, 11, 12, 13, 24, 25, 26, 29, 32, 71, 72, 73), SOLID),
    **dict.fromkeys((5, 8, 9, 22, 23, 28, 34, 69, 70), FACET),
}
WITHOUT = {0, 1, 2, 3, 4, 21, 35, 68}  # points and lines, which are left out in silence
VOXEL, PIXEL = 11, 8  # their nodes run along x first
# Cell data that number the groups of their cells, the first one that the file has.
LABELS = (
    *(
        "gmsh:physical",
        "CellEntityIds",
        "GroupID",
        "group",
        "medit:ref",
        "cell_tags",
        "MaterialIds",
        "material",
    ),
    *("PartId", "ObjectId", "ElementBlockIds", "RegionId", "subdomain", "attribute"),
)
NUMBERS = {
    **{f"{kind}{8 * size}": f"{kind[0].lower()}{size}" for kind in ("Int", "UInt") for size in (1, 2, 4, 8)},
    **{"Float32": "f4", "Float64": "f8"},
    **{
        "char": "i1",
        "unsigned_char": "u1",
        "short": "i2",
        "unsigned_short": "u2",
        "int": "i4",
        "unsigned_int": "u4",
    },
    **{
        "long": "i8",
        "unsigned_long": "u8",
        "vtktypeint64": "i8",
        "vtkIdType": "i8",
        "float": "f4",
        "double": "f8",
    },
}
DECOMPRESS: dict[str, Callable[[bytes], bytes]] = {
    "vtkZLibDataCompressor": zlib.decompress,
    "vtkLZMADataCompressor": lzma.decompress,
}
BROKEN = (
    KeyError,
    ValueError,
    IndexError,
    TypeError,
    AttributeError,
    xml.ParseError,
    OverflowError,
    MemoryError,
    zlib.error,
    lzma.LZMAError,
)


def blocks_of(path: Path, types: Array, start: Array, nodes: Array, data: dict[str, Array]) -> list[Cells]:
    """Cells by type. `start` (T+1): where the nodes of each cell begin."""
    label = next((name for name in LABELS if name in data and data[name].size == types.size), None)
    blocks = []
    for kind in sorted(set(np.unique(types).tolist()) - WITHOUT):
        dim = KINDS.get(kind)
        if dim is None:
            raise no_pyramids(path)
        for size in np.unique(np.diff(start)[types == kind]).tolist():
            here = np.flatnonzero((types == kind) & (np.diff(start) == size))
            if size not in SIZES[dim]:
                raise InputError(
                    f"{path}: has cells of type {kind} with {size} nodes: mesh with elements of order 1 or 2"
                )
            rows = nodes[start[here][:, None] + np.arange(size)]
            if kind in (VOXEL, PIXEL):
                rows = rows[:, [0, 1, 3, 2, 4, 5, 7, 6][:size]]
            groups = dict(labelled(data[label].ravel()[here])) if label else {}
            blocks.append(Cells(dim, rows.astype(np.int64), groups))
    return blocks


class Vtu:
    """A file of XML with arrays as text, as base64, or in a section at its end."""

    def __init__(self, content: bytes) -> None:
        self.appended = b""
        if (at := content.find(b"<AppendedData")) >= 0:
            begin = content.index(b"_", content.index(b">", at)) + 1
            end = content.rindex(b"</AppendedData>")
            self.appended, self.raw = content[begin:end], b'"raw"' in content[at:begin]
            content = content[:at] + content[end + len(b"</AppendedData>") :]
        self.root = xml.fromstring(content)
        self.order = "<" if self.root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
        self.size = self.order + NUMBERS[self.root.get("header_type", "UInt32")]
        self.compressor = self.root.get("compressor")

    def array(self, element: xml.Element) -> Array:
        """The values of a DataArray, flat."""
        number = np.dtype(self.order + NUMBERS[element.attrib["type"]])
        if element.get("format") == "ascii":
            return np.array((element.text or "").split(), number)
        if element.get("format") == "appended":
            packed = self.appended[int(element.attrib["offset"]) :]
            return np.frombuffer(self.unpacked(packed if self.raw else decoded(packed)), number)
        return np.frombuffer(self.unpacked(decoded((element.text or "").encode())), number)

    def unpacked(self, packed: bytes) -> bytes:
        """The bytes of an array: its size or the sizes of its compressed blocks, and then the bytes themselves."""
        step = np.dtype(self.size).itemsize
        head = int(np.frombuffer(packed, self.size, 1)[0])
        if not self.compressor:
            if len(packed) < step + head:
                raise ValueError("an array is cut off")
            return packed[step : step + head]
        sizes = np.frombuffer(packed, self.size, head, 3 * step).astype(int)
        ends = (3 + head) * step + np.cumsum(sizes)
        return b"".join(DECOMPRESS[self.compressor](packed[end - n : end]) for end, n in zip(ends, sizes))


def decoded(text: bytes) -> bytes:
    """The bytes of base64, which is padded after the header and at the end of an array. What follows it in the section
    at the end of a file is another array."""
    return b"".join(
        base64.b64decode(part) for part in re.findall(rb"[A-Za-z0-9+/]+=*", b"".join(text.split()))
    )


def read_vtu(path: Path) -> Mesh:
    file = Vtu(path.read_bytes())
    if file.compressor and file.compressor not in DECOMPRESS:
        raise InputError(
            f"{path}: is compressed by {file.compressor}: save it with ZLib, or without compression"
        )
    pieces = file.root.findall("UnstructuredGrid/Piece")
    if len(pieces) != 1:
        raise InputError(
            f"{path}: has {len(pieces)} pieces of an unstructured grid: save it as one from ParaView"
        )
    piece = pieces[0]
    cells = {str(one.get("Name")): file.array(one) for one in piece.findall("Cells/DataArray")}
    wanted = [one for one in piece.findall("CellData/DataArray") if one.get("Name") in LABELS]
    data = {str(one.get("Name")): file.array(one) for one in wanted}
    node = file.array(piece.findall("Points/DataArray")[0]).reshape(-1, 3).astype(float)
    start = np.concatenate([[0], cells["offsets"]]).astype(np.int64)
    blocks = blocks_of(path, cells["types"].astype(int), start, cells["connectivity"].astype(np.int64), data)
    return mesh_of(path, node, blocks, {})


class Vtk:
    """The words of the older format, and its arrays as text or as bytes, the highest one first."""

    def __init__(self, content: bytes) -> None:
        lines = content.split(b"\n", 3)
        if not lines[0].startswith(b"# vtk DataFile") or len(lines) < 4:
            raise ValueError("it does not begin with # vtk DataFile")
        self.version = float(lines[0].split()[-1])
        self.binary = lines[2].strip().upper() == b"BINARY"
        self.rest, self.at = lines[3], 0

    def line(self) -> list[str]:
        """The words of the next line that is not blank; none at the end."""
        while self.at < len(self.rest):
            end = self.rest.find(b"\n", self.at)
            end = len(self.rest) if end < 0 else end
            words = self.rest[self.at : end].decode("latin-1").split()
            self.at = end + 1
            if words:
                return words
        return []

    def array(self, count: int, kind: str) -> Array:
        number = np.dtype(NUMBERS[kind])
        if self.binary:
            values = np.frombuffer(self.rest, number.newbyteorder(">"), count, self.at)
            self.at += values.nbytes
            return values.astype(number)
        found = re.compile(rb"\s*(?:\S+\s+){%d}\S+" % (count - 1) if count else b"").match(self.rest, self.at)
        if not found:
            raise ValueError("an array is cut off")
        self.at = found.end()
        return np.array(found[0].split()[:count], number)


def read_vtk(path: Path) -> Mesh:
    file = Vtk(path.read_bytes())
    parts: dict[str, Array] = {}
    data: dict[str, Array] = {}
    of_cells, count = False, 0
    while words := file.line():
        key = words[0].upper()
        if key == "DATASET" and words[1].upper() != "UNSTRUCTURED_GRID":
            raise InputError(f"{path}: is a {words[1]}: save an unstructured grid")
        if key == "POINTS":
            parts["node"] = file.array(3 * int(words[1]), words[2]).reshape(-1, 3).astype(float)
        elif key == "CELLS":
            parts["start"], parts["nodes"] = cells_of(file, int(words[1]), int(words[2]))
        elif key == "CELL_TYPES":
            parts["types"] = file.array(int(words[1]), "int")
        elif key in ("CELL_DATA", "POINT_DATA"):
            of_cells, count = key == "CELL_DATA", int(words[1])
        elif key == "SCALARS":
            size = int(words[3]) if len(words) > 3 else 1
            table = file.line()
            if table[:1] != ["LOOKUP_TABLE"]:
                raise ValueError("SCALARS has no LOOKUP_TABLE")
            values = file.array(size * count, words[2])
            if of_cells and size == 1:
                data[words[1]] = values
        elif key == "FIELD":
            for _ in range(int(words[2])):
                name, components, rows, kind = file.line()
                values = file.array(int(components) * int(rows), kind)
                if of_cells and int(components) == 1:
                    data[name] = values
        elif key in ("VECTORS", "NORMALS"):
            file.array(3 * count, words[2])
        elif key == "METADATA":
            skip_metadata(file)
    blocks = blocks_of(path, parts["types"], parts["start"], parts["nodes"], data)
    return mesh_of(path, parts["node"], blocks, {})


def skip_metadata(file: Vtk) -> None:
    """Metadata end at a blank line."""
    end = file.rest.find(b"\n\n", file.at)
    file.at = len(file.rest) if end < 0 else end


def cells_of(file: Vtk, count: int, size: int) -> tuple[Array, Array]:
    """Where the nodes of each cell begin, and the nodes. Before version 5, each cell begins with their number."""
    if file.version >= 5:
        kind = file.line()[1]
        start = file.array(count, kind).astype(np.int64)
        return start, file.array(size, file.line()[1]).astype(np.int64)
    values = file.array(size, "int").astype(np.int64)
    heads, at = np.empty(count + 1, np.int64), 0
    for cell in range(count):
        heads[cell] = at
        at += int(values[at]) + 1
    heads[count] = at
    keep = np.ones(size, bool)
    keep[heads[:-1]] = False
    return heads - np.arange(count + 1), values[keep]


def read(path: Path) -> Mesh:
    """The mesh of a .vtu or .vtk in its units. Raises InputError and OSError."""
    try:
        return read_vtu(path) if path.suffix.lower() == ".vtu" else read_vtk(path)
    except BROKEN as error:
        what = " ".join(str(error).split())[:80]
        raise InputError(f"{path}: is no complete grid of VTK ({what}): save it again") from None
