# SPDX-License-Identifier: BSD-2-Clause
"""Solid models of CalculiX with the matrices that ccx has stored."""
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.body import Body, is_name
from ricochet.interchange.deck import Deck
from ricochet.interchange.elements import SOLIDS
from ricochet.interchange.numbers import Entries, both_triangles, entries_of, is_number, numbers

# Elements whose displacements are those of their nodes alone, and which are as stiff as their matrices.
KINDS = {f"C3D{kind}" for kind in ("4", "6", "8", "8R", "10", "15", "20", "20R")}
# A face of eight nodes has no node in its middle. It is split into four triangles at its corners and the
# quadrangle between them.
CORNERS_OF_EIGHT, MIDDLE_OF_EIGHT = [(0, 4, 7), (1, 5, 4), (2, 6, 5), (3, 7, 6)], (4, 5, 6, 7)


class Model(Deck):
    def __init__(self, path: Path) -> None:
        super().__init__(path)
        if other := [kind for kind in self.types if kind not in KINDS]:
            raise InputError(
                f"{self.path}: has elements of type {other[0]}: solids are read, C3D4, 6, 8, 8R, 10, 15, 20, 20R"
            )
        if not self.element:
            raise InputError(f"{path}: has no solid elements (*ELEMENT of a type C3D4, 6, 8, 10, 15 or 20)")
        self.number = {
            node: k for k, node in enumerate(sorted({n for nodes in self.element.values() for n in nodes}))
        }

    def faces(self, element: int) -> Iterator[list[int]]:
        """Yields the nodes of each face: corners, counter-clockwise seen from outside, then middle nodes."""
        nodes = self.element[element]
        corners, faces, edges, *_ = SOLIDS[len(nodes)]
        middle = {edge: corners + k for k, edge in enumerate(edges)} if len(nodes) > corners else {}
        position = np.array([self.position[node] for node in nodes])
        for face in faces:
            a, b, c = position[list(face[:3])]
            if np.dot(np.cross(b - a, c - a), a - position[:corners].mean(axis=0)) < 0:
                face = face[::-1]
            around = (
                [middle[min(pair), max(pair)] for pair in zip(face, face[1:] + face[:1])] if middle else []
            )
            yield [nodes[k] for k in [*face, *around]]

    def blocks(self, faces: Iterable[Sequence[int]]) -> list[Array]:
        """Arrays of facets, one for each number of nodes per facet, with the node numbers of the body
        file."""
        found: dict[int, list[list[int]]] = {}
        for face in faces:
            nodes = [self.number[node] for node in face]
            parts = [nodes]
            if len(nodes) == 8:
                parts = [[nodes[k] for k in part] for part in [*CORNERS_OF_EIGHT, MIDDLE_OF_EIGHT]]
            for part in parts:
                found.setdefault(len(part), []).append(part)
        return [np.array(facets) for facets in found.values()]

    def skin(self) -> list[list[int]]:
        """The faces that belong to a single element."""
        seen: dict[frozenset[int], list[list[int]]] = {}
        for element in self.element:
            for face in self.faces(element):
                seen.setdefault(frozenset(face), []).append(face)
        return [faces[0] for faces in seen.values() if len(faces) == 1]

    def surfaces(self) -> dict[str, list[Array]]:
        found = {}
        for name in self.surface_lines:
            if not is_name(name) or name == "skin":
                raise InputError(
                    f'{self.surface_place[name]}: surface "{name}" has the name of the whole surface (skin), or no name: '
                    "rename it"
                )
            faces = []
            for line, element, side in self.sides(name):
                if element not in self.element:
                    raise InputError(
                        f"{line.where}: surface {name} names element {element}, which is no solid of the model"
                    )
                known = {f"S{k}": face for k, face in enumerate(self.faces(element), 1)}
                if side not in known:
                    raise InputError(
                        f'{line.where}: surface {name} has "{side}" of element {element}: must be a face, '
                        f"S1 to S{len(known)}"
                    )
                faces.append(known[side])
            found[name] = self.blocks(faces)
        return found

    def nodes(self) -> Array:
        return np.array([self.position[node] for node in self.number])

    def supports(self) -> dict[str, Array]:
        sets = {
            self.names[name]: [self.number[n] for n in nodes if n in self.number]
            for name, nodes in self.node_sets.items()
        }
        if wrong := [name for name in sets if not is_name(name)]:
            raise InputError(f'{self.path}: node set "{wrong[0]}" can\'t be named in a scene: rename it')
        return {name: np.array(nodes) for name, nodes in sets.items() if nodes}

    def stored(self, suffix: str) -> Path:
        """The path of a file that ccx has written for the job."""
        path = self.path.with_suffix(suffix)
        if not path.is_file():
            raise InputError(
                f"{path}: no such file: run ccx on {self.path} with *FREQUENCY, SOLVER=MATRIXSTORAGE first"
            )
        return path

    def matrices(self) -> dict[str, Entries]:
        """Reads the files that SOLVER=MATRIXSTORAGE writes: one triangle of each matrix (.sti, .mas) and the
        degree of freedom of each row (.dof)."""
        dof = self.stored(".dof")
        listed: dict[int, bool] = {}  # in the order of the file
        for word in dof.read_text(errors="replace").split():
            node, _, direction = word.partition(".")
            if not is_number(node) or int(node) not in self.number or direction not in ("1", "2", "3"):
                raise InputError(
                    f"{dof}: has displacement {word[:40]} of no node of a solid in {self.path.name}: shells and beams, "
                    "which ccx expands, are not read"
                )
            row = 3 * self.number[int(node)] + int(direction) - 1
            if row in listed:
                raise InputError(f"{dof}: has displacement {word} twice: run ccx again")
            listed[row] = True
        rows = np.array(list(listed))
        found = {}
        for name, suffix in (("stiffness", ".sti"), ("mass", ".mas")):
            path = self.stored(suffix)
            values = numbers(path, path.read_bytes())
            if values.size % 3 or values.size == 0:
                raise InputError(
                    f"{path}: is not a matrix of the {rows.size} rows of {dof.name}: run ccx again"
                )
            i, j, value = both_triangles(path, *entries_of(path, values, rows.size, rows.size))
            found[name] = rows[i], rows[j], value
        return found


def read(job: Path) -> Body:
    """Reads a job whose matrices ccx has stored, in the units of the job. Raises InputError and OSError."""
    model = Model(job)
    skin = model.blocks(model.skin())
    triangles = [
        facets[:, corners]
        for facets in skin
        for corners in ([[0, 1, 2]] if facets.shape[1] in (3, 6) else [[0, 1, 2], [0, 2, 3]])
    ]
    surfaces = {"skin": skin} | model.surfaces()
    return Body(model.nodes(), model.matrices(), surfaces, model.supports(), np.concatenate(triangles))
