# SPDX-License-Identifier: BSD-2-Clause
"""Solid models of CalculiX: nodes, elements, sets and surfaces of an input file, and the matrices that ccx
has stored."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.body import Body, is_name
from ricochet.interchange.numbers import Entries, both_triangles, entries_of, is_number, numbers

Corners = list[tuple[int, ...]]
# Corner nodes of the faces S1, S2, …, and edges in the order of their middle nodes. Nodes are numbered from
# 0.
TETRAHEDRON: tuple[Corners, Corners] = (
    [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
    [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)],
)
WEDGE: tuple[Corners, Corners] = (
    [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)],
    [(0, 1), (1, 2), (0, 2), (3, 4), (4, 5), (3, 5), (0, 3), (1, 4), (2, 5)],
)
BRICK: tuple[Corners, Corners] = (
    [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
    [(0, 1), (1, 2), (2, 3), (0, 3), (4, 5), (5, 6), (6, 7), (4, 7), (0, 4), (1, 5), (2, 6), (3, 7)],
)
# Element types by number of nodes.
KINDS = {4: TETRAHEDRON, 10: TETRAHEDRON, 6: WEDGE, 15: WEDGE, 8: BRICK, 20: BRICK}
# A face of eight nodes has no node in its middle. It is split into four triangles at its corners and the
# quadrangle between them.
CORNERS_OF_EIGHT, MIDDLE_OF_EIGHT = [(0, 4, 7), (1, 5, 4), (2, 6, 5), (3, 7, 6)], (4, 5, 6, 7)
Card = tuple[str, str, dict[str, str], list["Line"]]  # place, keyword, parameters, lines of data
MOST = 10**8  # largest number of members of a generated set


class Line(list[str]):
    """The words of a line and its position in the file."""

    def __init__(self, text: str, path: Path, number: int) -> None:
        super().__init__(word.strip() for word in text.rstrip().rstrip(",").split(","))
        self.where = f"{path}: line {number}"


def lines_of(path: Path) -> list[tuple[int, str]]:
    """The lines of a file with their numbers, without comments and blank lines."""
    text = Path(path).read_text(errors="replace")
    return [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.startswith("**")
    ]


def cards(path: Path, outer: tuple[Path, ...] = ()) -> Iterator[Card]:
    """Yields the cards of an input file and its includes: place, keyword, parameters and lines of data of
    each."""
    card: Card | None = None
    outer = (*outer, Path(path).resolve())
    for number, line in lines_of(path):
        if not line.startswith("*"):
            if card:
                card[3].append(Line(line, path, number))
            continue
        if card:
            yield card
        words = [word.strip() for word in line[1:].split(",")]
        parameters = {}
        for word in words[1:]:
            key, _, value = word.partition("=")
            parameters[key.strip().upper()] = value.strip().strip('"')
        card = (f"{path}: line {number}", words[0].upper(), parameters, [])
        if "INPUT" in parameters:
            inner = Path(path).parent / parameters["INPUT"]
            if not inner.is_file():
                raise InputError(f"{card[0]}: includes {inner}: no such file")
            if card[1] == "INCLUDE":
                if inner.resolve() in outer:
                    raise InputError(f"{card[0]}: includes {inner}, which is being read already")
                card = None
                yield from cards(inner, outer)
            else:
                card[3].extend(Line(text, inner, k) for k, text in lines_of(inner))
    if card:
        yield card


def members(lines: Iterable[Line], parameters: dict[str, str], sets: dict[str, list[int]]) -> Iterator[int]:
    """Yields the members of a set. Its lines may contain names of other sets or define a range."""
    if "GENERATE" in parameters:
        for line in lines:
            first, last, step = [int(word) for word in line[:2]] + [int(line[2]) if len(line) > 2 else 1]
            if (last - first) / step > MOST:
                raise InputError(f"{line.where}: a range of more than {MOST} numbers")
            yield from range(first, last + 1, step)
        return
    for line in lines:
        for word in filter(None, line):
            yield from [int(word)] if is_number(word.lstrip("-")) else set_of(sets, word, line)


def set_of(sets: dict[str, list[int]], name: str, line: Line) -> list[int]:
    if name.upper() not in sets:
        raise InputError(f"{line.where}: names the set {name}, which is not there")
    return sets[name.upper()]


class Model:
    def __init__(self, path: Path) -> None:
        self.path = Path(path)
        self.position: dict[int, list[float]] = {}
        self.element: dict[int, list[int]] = {}
        self.node_sets: dict[str, list[int]] = {}
        self.element_sets: dict[str, list[int]] = {}
        self.names: dict[str, str] = {}
        self.surface_lines: dict[str, list[Line]] = {}
        if not self.path.is_file():
            raise InputError(f"{path}: there is no such file. Name the input file of a job")
        for where, keyword, parameters, lines in cards(path):
            try:
                self.where = where
                self.take(keyword, parameters, lines)
            except (ValueError, KeyError, IndexError, ZeroDivisionError):
                raise InputError(f"{self.where}: can't be read as *{keyword} of CalculiX") from None
        if not self.element:
            raise InputError(f"{path}: has no solid elements (*ELEMENT of a type C3D4, 6, 8, 10, 15 or 20)")
        self.number = {
            node: k for k, node in enumerate(sorted({n for nodes in self.element.values() for n in nodes}))
        }

    def take(self, keyword: str, parameters: dict[str, str], lines: list[Line]) -> None:
        if keyword == "NODE":
            for line in self.each(lines):
                place = [float(x) for x in (line[1:4] + ["0"] * 3)[:3]]
                if not np.isfinite(place).all():
                    raise InputError(f"{line.where}: node {line[0]} has a coordinate that is not finite")
                self.position[int(line[0])] = place
            self.add(self.node_sets, parameters.get("NSET"), (int(line[0]) for line in lines))
        elif keyword == "ELEMENT":
            self.take_elements(parameters, lines)
        elif keyword in ("NSET", "ELSET"):
            sets = self.node_sets if keyword == "NSET" else self.element_sets
            self.add(sets, parameters[keyword], members(self.each(lines), parameters, sets))
        elif keyword == "SURFACE" and parameters.get("TYPE", "ELEMENT").upper() == "ELEMENT":
            name = parameters["NAME"]
            if not is_name(name) or name == "skin" or name in self.surface_lines:
                raise InputError(
                    f'{self.where}: surface "{name}" has the name of another one, or of the whole surface (skin), or no '
                    "name: rename it"
                )
            self.surface_lines[name] = lines

    def each(self, lines: Iterable[Line]) -> Iterator[Line]:
        """Yields the lines and records the place of each, for error messages."""
        for line in lines:
            self.where = line.where
            yield line

    def take_elements(self, parameters: dict[str, str], lines: Iterable[Line]) -> None:
        kind = parameters["TYPE"].upper().rstrip("R")
        size = int(kind[3:]) if kind.startswith("C3D") and kind[3:].isdigit() else 0
        if size not in KINDS:
            raise InputError(
                f"{self.path}: has elements of type {parameters['TYPE']}: solids are read, C3D4, 6, 8, 8R, 10, 15, 20, 20R"
            )
        words = [int(word) for line in self.each(lines) for word in line if word]
        for start in range(0, len(words), size + 1):
            nodes = words[start + 1 : start + size + 1]
            if len(nodes) < size or any(node not in self.position for node in nodes):
                raise InputError(
                    f"{self.path}: element {words[start]} lacks nodes, or names one that is not there"
                )
            if words[start] in self.element:
                raise InputError(f"{self.path}: element {words[start]} is there twice")
            self.element[words[start]] = nodes
        self.add(self.element_sets, parameters.get("ELSET"), words[:: size + 1])

    def add(self, sets: dict[str, list[int]], name: str | None, numbers: Iterable[int]) -> None:
        if name is not None:
            self.names.setdefault(name.upper(), name)
            sets.setdefault(name.upper(), []).extend(numbers)

    def faces(self, element: int) -> Iterator[list[int]]:
        """Yields the nodes of each face: corners, counter-clockwise seen from outside, then middle nodes."""
        nodes = self.element[element]
        faces, edges = KINDS[len(nodes)]
        corners = len({corner for face in faces for corner in face})
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
        for name, lines in self.surface_lines.items():
            faces = []
            for line in lines:
                of, side = (line + [""])[:2]
                for element in [int(of)] if is_number(of) else set_of(self.element_sets, of, line):
                    if element not in self.element:
                        raise InputError(
                            f"{line.where}: surface {name} names element {element}, which is no solid of the model"
                        )
                    known = {f"S{k}": face for k, face in enumerate(self.faces(element), 1)}
                    if side.upper() not in known:
                        raise InputError(
                            f'{line.where}: surface {name} has "{side}" of element {element}: must be a face, '
                            f"S1 to S{len(known)}"
                        )
                    faces.append(known[side.upper()])
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
