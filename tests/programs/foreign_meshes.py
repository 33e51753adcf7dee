# SPDX-License-Identifier: BSD-2-Clause
"""A small block of tetrahedra, bricks or wedges, and its files of gmsh and of other programs.

gmsh's own tables of local coordinates number the nodes of the elements. The orders of the other formats are written out from
their manuals, as lists of places in gmsh's element, and share nothing with the importer.
"""

import base64
import itertools
import zlib

import gmsh
import h5py
import numpy as np

SIZE, CELLS = np.array((1.0, 0.7, 0.5)), (2, 2, 2)
NAMES = {"tetrahedron": "tetrahedron", "brick": "hexahedron", "wedge": "prism"}
CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
# Corners of the elements that fill a cube.
FILL = {
    "brick": [range(8)],
    "wedge": [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)],
    "tetrahedron": [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)],
}
# For each node of an element in a file, its place in gmsh's element.
T10, W15, B20 = list(range(4)), list(range(6)), list(range(8))
ABAQUS = {
    10: T10 + [4, 5, 6, 7, 9, 8],
    15: W15 + [6, 9, 7, 12, 14, 13, 8, 10, 11],
    20: B20 + [8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15],
    27: B20 + [8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 26, 20, 25, 21, 23, 24, 22],
}
NASTRAN = {
    10: ABAQUS[10],
    15: W15 + [6, 9, 7, 8, 10, 11, 12, 14, 13],
    20: B20 + [8, 11, 13, 9, 10, 12, 14, 15, 16, 18, 19, 17],
}
VTK = {
    10: ABAQUS[10],
    15: ABAQUS[15],
    18: ABAQUS[15] + [15, 17, 16],
    20: ABAQUS[20],
    27: ABAQUS[20] + [22, 23, 21, 24, 20, 25, 26],
}
MED = {
    4: [0, 2, 1, 3],
    6: [0, 2, 1, 3, 5, 4],
    8: [0, 3, 2, 1, 4, 7, 6, 5],
    10: [0, 2, 1, 3, 6, 5, 4, 7, 8, 9],
    15: [0, 2, 1, 3, 5, 4, 7, 9, 6, 13, 14, 12, 8, 11, 10],
    20: [0, 3, 2, 1, 4, 7, 6, 5, 9, 13, 11, 8, 17, 19, 18, 16, 10, 15, 14, 12],
}
UNV = {
    6: [0, 3, 1, 4, 2, 5],
    8: [0, 4, 1, 5, 2, 6, 3, 7],
    10: [0, 4, 1, 5, 2, 6, 7, 9, 8, 3],
    15: [0, 6, 1, 9, 2, 7, 8, 10, 11, 3, 12, 4, 14, 5, 13],
    20: [0, 8, 1, 11, 2, 13, 3, 9, 10, 12, 14, 15, 4, 16, 5, 18, 6, 19, 7, 17],
}
CGNS = NASTRAN | {18: NASTRAN[15] + [15, 17, 16], 27: NASTRAN[20] + [20, 21, 23, 24, 22, 25, 26]}
UNV_TYPES = {4: 111, 6: 112, 8: 115, 10: 118, 15: 113, 20: 116}
UNV_FACETS = {3: 91, 6: 92, 4: 94, 8: 95}
CGNS_TYPES = {4: 10, 6: 14, 8: 17, 10: 11, 15: 15, 18: 16, 20: 18, 27: 19}
CGNS_FACETS = {3: 5, 4: 7, 6: 6, 8: 8, 9: 9}
VTK_TYPES = {4: 10, 6: 13, 8: 12, 10: 24, 15: 26, 18: 32, 20: 25, 27: 29}
VTK_FACETS = {3: 5, 4: 9, 6: 22, 8: 23, 9: 28}
MED_TYPES = {4: "TE4", 6: "PE6", 8: "HE8", 10: "T10", 15: "P15", 20: "H20"}
MED_FACETS = {3: "TR3", 4: "QU4", 6: "TR6", 8: "QU8"}
NASTRAN_TYPES = {4: "CTETRA", 6: "CPENTA", 8: "CHEXA", 10: "CTETRA", 15: "CPENTA", 20: "CHEXA"}
NASTRAN_FACETS = {3: "CTRIA3", 4: "CQUAD4", 6: "CTRIA6", 8: "CQUAD8"}


def local_shape(kind, at):
    """(n,c) weights of the corners at local coordinates (n,3) of gmsh."""
    u, v, w = at.T
    if kind == "tetrahedron":
        return np.stack([1 - u - v - w, u, v, w], axis=1)
    if kind == "wedge":
        plane = np.stack([1 - u - v, u, v], axis=1)
        return np.hstack([plane * (1 - w[:, None]) / 2, plane * (1 + w[:, None]) / 2])
    return np.prod([(1 + (2 * np.array(CUBE).T[d] - 1) * at[:, d, None]) / 2 for d in range(3)], axis=0)


def bent(place):
    """Moves the nodes by a map of order 2, which every element of order 2 follows exactly."""
    x, y, z = (place * SIZE).T
    return np.stack(
        [x + 0.1 * y * z - 0.05 * x * x, y + 0.08 * x * z, z + 0.06 * x * y + 0.05 * y * y], axis=1
    )


class Sample:
    """`node` (n,3), `solid` (T,k) and `facet` by group, in gmsh's order and counted from 0. Solids are parts 1 and 2, facets of the
    foot and the top are parts 3 and 4, and `edge` holds nodes."""

    def __init__(self, kind, order, place=bent):
        self.kind, self.order = kind, order
        number, size = {}, 2 * np.array(CELLS)

        def of(at):
            return number.setdefault(tuple(np.round(2 * np.asarray(at)).astype(int)), len(number))

        self.type = gmsh.model.mesh.getElementType(NAMES[kind], order)
        *_, local, _ = gmsh.model.mesh.getElementProperties(self.type)
        shape = local_shape(kind, np.array(local).reshape(-1, 3))
        solid, part = [], []
        for cell in itertools.product(*map(range, CELLS)):
            for fill in FILL[kind]:
                corners = np.array([CUBE[k] for k in fill]) + cell
                solid.append([of(at) for at in shape @ corners])
                part.append(1 if cell[0] == 0 else 2)
        self.solid, self.part = np.array(solid), np.array(part)
        lattice = np.array(list(number))
        self.node = place(lattice / size)
        self.facet = {3: self.facets(lattice, 0, of), 4: self.facets(lattice, size[2], of)}
        self.edge = np.flatnonzero((lattice[:, 0] == 0) & (lattice[:, 2] == 0))

    def facets(self, lattice, level, of):
        """(F,k) facets at one level of the lattice: corners, middles of edges, centre."""
        rows = []
        corners = {"tetrahedron": 4, "wedge": 6, "brick": 8}[self.kind]
        for nodes in self.solid[:, :corners]:
            face = [node for node in nodes if lattice[node, 2] == level]
            if len(face) < 3:
                continue
            place = lattice[face] / 2
            around = (place + np.roll(place, -1, axis=0)) / 2
            centre = [place.mean(axis=0)] if len(face) == 4 else []
            rows.append(face + [of(at) for at in (*around, *centre)] if self.order == 2 else face)
        return np.array(rows)

    def incomplete(self):
        """The same without nodes in the middle of quadrangles: solids of 15 or 20 nodes, facets of 8."""
        size = {27: 20, 18: 15}.get(self.solid.shape[1], self.solid.shape[1])
        return self.solid[:, :size], {p: rows[:, :8] for p, rows in self.facet.items()}

    def write_msh(self, path):
        """Writes the reference by gmsh's own interface."""
        gmsh.model.add("sample")
        for part in (1, 2):
            gmsh.model.addDiscreteEntity(3, part)
            gmsh.model.addPhysicalGroup(3, [part], part)
        gmsh.model.mesh.addNodes(3, 1, 1 + np.arange(len(self.node)), self.node.ravel())
        for part in (1, 2):
            here = np.flatnonzero(self.part == part)
            gmsh.model.mesh.addElementsByType(part, self.type, 1 + here, 1 + self.solid[here].ravel())
        last = len(self.solid)
        for part, rows in self.facet.items():
            gmsh.model.addDiscreteEntity(2, part)
            gmsh.model.addPhysicalGroup(2, [part], part)
            family = "triangle" if rows.shape[1] in (3, 6) else "quadrangle"
            kind = gmsh.model.mesh.getElementType(family, self.order)
            gmsh.model.mesh.addElementsByType(part, kind, last + 1 + np.arange(len(rows)), 1 + rows.ravel())
            last += len(rows)
        gmsh.option.setNumber("Mesh.Binary", 0)
        gmsh.write(str(path))
        gmsh.model.remove()

    # ---- other programs ----

    def write_inp(self, path):
        full = self.kind == "brick" and self.order == 2
        solid, facet = (self.solid, self.facet) if full else self.incomplete()
        order = ABAQUS.get(solid.shape[1], range(solid.shape[1]))
        lines = ["*NODE", *(f"{k}, " + ", ".join(map(repr, x)) for k, x in enumerate(self.node.tolist(), 1))]
        lines += [f"*ELEMENT, TYPE=C3D{solid.shape[1]}", *wrapped(enumerate(1 + solid[:, order], 1))]
        last = len(solid)
        for part, rows in facet.items():
            lines += [
                f"*ELEMENT, TYPE=CPS{rows.shape[1]}, ELSET={part}",
                *wrapped(enumerate(1 + rows, last + 1)),
            ]
            last += len(rows)
        for part in (1, 2):
            lines += [f"*ELSET, ELSET={part}", *(f"{k}," for k in 1 + np.flatnonzero(self.part == part))]
        lines += ["*NSET, NSET=edge", *(f"{k}," for k in 1 + self.edge)]
        path.write_text("\n".join(lines) + "\n")

    def write_bdf(self, path, form="large"):
        solid, facet = self.incomplete()
        order = NASTRAN.get(solid.shape[1], range(solid.shape[1]))
        lines = ["SOL 103", "BEGIN BULK"]
        for k, x in enumerate(self.node.tolist(), 1):
            # 16 columns hold 12 digits; a field of free format holds all.
            words = ["GRID", k, "", *map(repr, x)]
            lines.append(",".join(map(str, words)))
        last = 0
        for parts, rows, name in [(self.part, 1 + solid[:, order], NASTRAN_TYPES[solid.shape[1]])] + [
            ([part] * len(rows), 1 + rows, NASTRAN_FACETS[rows.shape[1]]) for part, rows in facet.items()
        ]:
            for number, (part, nodes) in enumerate(zip(parts, rows), last + 1):
                lines += bulk_lines(name, [number, part, *nodes], form)
            last += len(rows)
        lines += bulk_lines("SPC1", [7, 13, *(1 + self.edge)], form)
        path.write_text("\n".join([*lines, "ENDDATA", ""]))

    def write_vtu(self, path, form="ascii", full=True):
        solid, facet = (self.solid, self.facet) if full else self.incomplete()
        order = VTK.get(solid.shape[1], range(solid.shape[1]))
        rows = [solid[:, order], *facet.values()]
        types = [VTK_TYPES[solid.shape[1]], *(VTK_FACETS[r.shape[1]] for r in facet.values())]
        parts = [self.part, *(np.full(len(r), part) for part, r in facet.items())]
        arrays = {
            "Points": [("Points", self.node, 3)],
            "Cells": [
                ("connectivity", np.concatenate([r.ravel() for r in rows]), 1),
                ("offsets", np.cumsum(np.concatenate([np.full(len(r), r.shape[1]) for r in rows])), 1),
                ("types", np.concatenate([np.full(len(r), t, np.uint8) for r, t in zip(rows, types)]), 1),
            ],
            "CellData": [("CellEntityIds", np.concatenate(parts).astype(np.int32), 1)],
        }
        compressor = ' compressor="vtkZLibDataCompressor"' if form == "compressed" else ""
        cells = sum(len(r) for r in rows)
        text = f'<VTKFile type="UnstructuredGrid" version="1.0" header_type="UInt64" byte_order="LittleEndian"{compressor}>\n'
        text += f'<UnstructuredGrid><Piece NumberOfPoints="{len(self.node)}" NumberOfCells="{cells}">\n'
        tail = b""
        for section, listed in arrays.items():
            text += f"<{section}>"
            for name, values, components in listed:
                body, attributes = vtu_array(values, form, len(tail))
                text += f'<DataArray Name="{name}" NumberOfComponents="{components}" {attributes}>{body}</DataArray>\n'
                if form == "raw":
                    tail += np.uint64(values.nbytes).tobytes() + values.tobytes()
            text += f"</{section}>\n"
        text += "</Piece></UnstructuredGrid>\n"
        appended = (
            b'<AppendedData encoding="raw">\n_' + tail + b"\n</AppendedData>\n" if form == "raw" else b""
        )
        path.write_bytes(text.encode() + appended + b"</VTKFile>\n")

    def write_vtk(self, path, binary=False):
        """The older format of VTK, in version 3."""
        order = VTK.get(self.solid.shape[1], range(self.solid.shape[1]))
        rows = [self.solid[:, order], *self.facet.values()]
        types = [VTK_TYPES[self.solid.shape[1]], *(VTK_FACETS[r.shape[1]] for r in self.facet.values())]
        cells = np.concatenate([np.column_stack([np.full(len(r), r.shape[1]), r]).ravel() for r in rows])
        kinds = np.concatenate([np.full(len(r), t) for r, t in zip(rows, types)])
        parts = np.concatenate([self.part, *(np.full(len(r), part) for part, r in self.facet.items())])
        chunks = [
            f"# vtk DataFile Version 3.0\nblock\n{'BINARY' if binary else 'ASCII'}\nDATASET UNSTRUCTURED_GRID\n"
        ]
        for head, values, number in (
            (f"POINTS {len(self.node)} double\n", self.node.ravel(), ">f8"),
            (f"CELLS {len(kinds)} {len(cells)}\n", cells, ">i4"),
            (f"CELL_TYPES {len(kinds)}\n", kinds, ">i4"),
            (f"CELL_DATA {len(kinds)}\nSCALARS CellEntityIds int 1\nLOOKUP_TABLE default\n", parts, ">i4"),
        ):
            chunks += [
                head,
                values.astype(number).tobytes() if binary else " ".join(map(repr, values.tolist())),
                "\n",
            ]
        path.write_bytes(b"".join(chunk if isinstance(chunk, bytes) else chunk.encode() for chunk in chunks))

    def write_unv(self, path):
        solid, facet = self.incomplete()
        order = UNV[solid.shape[1]] if self.order == 2 else range(solid.shape[1])
        lines = ["    -1", "  2411"]
        for k, x in enumerate(self.node.tolist(), 1):
            lines += [
                f"{k:10}{1:10}{1:10}{11:10}",
                "".join(f"{value:25.16E}".replace("E", "D") for value in x),
            ]
        lines += ["    -1", "    -1", "  2412"]
        blocks = [(UNV_TYPES[solid.shape[1]], solid[:, order])]
        for rows in facet.values():
            turn = UNV[rows.shape[1]] if self.order == 2 else range(rows.shape[1])
            blocks.append((UNV_FACETS[rows.shape[1]], rows[:, turn]))
        number = 0
        for kind, rows in blocks:
            for nodes in rows:
                number += 1
                lines.append("".join(f"{word:10}" for word in (number, kind, 1, 1, 7, len(nodes))))
                lines += [
                    "".join(f"{node + 1:10}" for node in nodes[k : k + 8]) for k in range(0, len(nodes), 8)
                ]
        lines += ["    -1", "    -1", "  2467"]
        last = len(solid)
        groups = {str(part): [(8, k) for k in 1 + np.flatnonzero(self.part == part)] for part in (1, 2)}
        for part, rows in facet.items():
            groups[str(part)] = [(8, last + k) for k in range(1, len(rows) + 1)]
            last += len(rows)
        groups["edge"] = [(7, node) for node in 1 + self.edge]
        for k, (name, listed) in enumerate(groups.items(), 1):
            lines += ["".join(f"{word:10}" for word in (k, 0, 0, 0, 0, 0, 0, len(listed))), name]
            words = [f"{kind:10}{member:10}{0:10}{0:10}" for kind, member in listed]
            lines += ["".join(words[at : at + 2]) for at in range(0, len(words), 2)]
        path.write_text("\n".join([*lines, "    -1", ""]))

    def write_cgns(self, path, mixed=False):
        """Parts 1 to 3 are sections; part 4 is a boundary condition, and so is the edge."""
        order = CGNS.get(self.solid.shape[1], range(self.solid.shape[1]))
        sections = {str(part): self.solid[self.part == part][:, order] for part in (1, 2)}
        sections |= {"3": self.facet[3], "rest": self.facet[4]}
        with h5py.File(path, "w") as file:
            base = labelled_node(file, "Base", "CGNSBase_t", np.array([3, 3], np.int32))
            zone = labelled_node(base, "block", "Zone_t", np.array([[len(self.node)], [0], [0]], np.int32))
            labelled_node(zone, "ZoneType", "ZoneType_t", letters("Unstructured"))
            grid = labelled_node(zone, "GridCoordinates", "GridCoordinates_t")
            for axis, values in zip("XYZ", self.node.T):
                labelled_node(grid, f"Coordinate{axis}", "DataArray_t", values)
            first = 1
            for name, rows in sections.items():
                kind = (CGNS_TYPES if rows.shape[1] == self.solid.shape[1] else CGNS_FACETS)[rows.shape[1]]
                nodes = 1 + rows
                if mixed:
                    nodes, kind = np.column_stack([np.full(len(rows), kind), nodes]), 20
                section = labelled_node(zone, name, "Elements_t", np.array([kind, 0], np.int32))
                last = first + len(rows) - 1
                labelled_node(section, "ElementRange", "IndexRange_t", np.array([first, last], np.int32))
                labelled_node(section, "ElementConnectivity", "DataArray_t", nodes.ravel().astype(np.int32))
                top, first = np.arange(first, last + 1), last + 1
            conditions = labelled_node(zone, "ZoneBC", "ZoneBC_t")
            for name, place, numbers in (("4", "FaceCenter", top), ("edge", "Vertex", 1 + self.edge)):
                condition = labelled_node(conditions, name, "BC_t", letters("BCWall"))
                labelled_node(condition, "GridLocation", "GridLocation_t", letters(place))
                labelled_node(condition, "PointList", "IndexArray_t", numbers[None].astype(np.int32))

    def write_med(self, path):
        solid, facet = self.incomplete()
        order = MED.get(solid.shape[1], range(solid.shape[1]))
        names = {-1: "1", -2: "2", -3: "3", -4: "4", 5: "edge"}
        with h5py.File(path, "w") as file:
            file.create_group("INFOS_GENERALES").attrs.update(MAJ=4, MIN=0, REL=0)
            step = file.create_group("ENS_MAA/block/-0000000000000000001-0000000000000000001")
            step["NOE/COO"] = self.node.T.ravel()
            family = np.zeros(len(self.node), np.int64)
            family[self.edge] = 5
            step["NOE/FAM"] = family
            write_block(step, MED_TYPES[solid.shape[1]], solid[:, order], -self.part)
            rows, parts = np.concatenate(list(facet.values())), np.repeat(
                [-3, -4], [len(r) for r in facet.values()]
            )
            write_block(step, MED_FACETS[rows.shape[1]], rows, parts)
            for number, name in names.items():
                kind = "NOEUD" if number > 0 else "ELEME"
                group = file.create_group(f"FAS/block/{kind}/FAM_{number}_{name}")
                group.attrs["NUM"] = number
                letters = np.zeros((1, 80), np.int8)
                letters[0, : len(name)] = list(name.encode())
                group["GRO/NOM"] = letters


def letters(text):
    return np.array(list(text.encode()), np.int8)


def labelled_node(parent, name, label, values=None):
    """A node of CGNS in HDF5."""
    node = parent.create_group(name)
    node.attrs["label"] = np.bytes_(label)
    if values is not None:
        node[" data"] = values
    return node


def write_block(step, kind, rows, family):
    step[f"MAI/{kind}/NOD"] = 1 + rows.T.ravel()
    step[f"MAI/{kind}/FAM"] = family


def wrapped(rows):
    """Lines of elements of at most 16 words, of which all but the last end in a comma."""
    for number, nodes in rows:
        words = [str(number), *map(str, nodes)]
        for k in range(0, len(words), 16):
            yield ", ".join(words[k : k + 16]) + ("," if k + 16 < len(words) else "")


def bulk_lines(name, words, form):
    """An entry of Nastran in free, small or large fields, with continuation lines."""
    if form == "free":
        return [
            ",".join(map(str, [name if k == 0 else "+", *words[k : k + 8]])) for k in range(0, len(words), 8)
        ]
    step, width, star = (4, 16, "*") if form == "large" else (8, 8, "")
    head = [(name + star if k == 0 else star or "+").ljust(8) for k in range(0, len(words), step)]
    return [
        start + "".join(str(word).ljust(width) for word in words[k : k + step])
        for start, k in zip(head, range(0, len(words), step))
    ]


def vtu_array(values, form, offset):
    """The text of an array in a .vtu, and its attributes."""
    kind = {"f": "Float", "i": "Int", "u": "UInt"}[values.dtype.kind] + str(8 * values.itemsize)
    data = values.tobytes()
    if form == "raw":
        return "", f'type="{kind}" format="appended" offset="{offset}"'
    if form == "ascii":
        return " ".join(map(repr, values.ravel().tolist())), f'type="{kind}" format="ascii"'
    if form == "binary":  # header and data are padded one by one, as VTK does
        head = np.uint64(len(data)).tobytes()
    else:
        half = len(data) // 2
        packed = [zlib.compress(data[:half]), zlib.compress(data[half:])]
        head = np.array([2, half, len(data) - half, *map(len, packed)], np.uint64).tobytes()
        data = b"".join(packed)
    return (base64.b64encode(head) + base64.b64encode(data)).decode(), f'type="{kind}" format="binary"'
