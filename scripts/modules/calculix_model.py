"""Solid models of CalculiX: nodes, elements, sets and surfaces of an input file, and the matrices that ccx stores."""

from pathlib import Path

import numpy as np

from body_file import Refused, both_triangles, numbers

# Corner nodes of the faces S1, S2, …, and edges in the order of the middle nodes; numbered from 0.
TETRAHEDRON = ([(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)], [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)])
WEDGE = ([(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)],
         [(0, 1), (1, 2), (0, 2), (3, 4), (4, 5), (3, 5), (0, 3), (1, 4), (2, 5)])
BRICK = ([(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
         [(0, 1), (1, 2), (2, 3), (0, 3), (4, 5), (5, 6), (6, 7), (4, 7), (0, 4), (1, 5), (2, 6), (3, 7)])
KINDS = {4: TETRAHEDRON, 10: TETRAHEDRON, 6: WEDGE, 15: WEDGE, 8: BRICK, 20: BRICK}
# Of a face of eight nodes, which has no node in its middle: four triangles at its corners and what is between.
CORNERS_OF_EIGHT, MIDDLE_OF_EIGHT = [(0, 4, 7), (1, 5, 4), (2, 6, 5), (3, 7, 6)], (4, 5, 6, 7)


def cards(path):
    """Keyword, its parameters, and its lines of data, one card after the other; includes are followed."""
    card = None
    for line in Path(path).read_text(errors="replace").splitlines():
        if line.startswith("**") or not line.strip():
            continue
        if not line.startswith("*"):
            if card:
                card[2].append([word.strip() for word in line.rstrip().rstrip(",").split(",")])
            continue
        if card:
            yield card
        words = [word.strip() for word in line[1:].split(",")]
        parameters = {}
        for word in words[1:]:
            key, _, value = word.partition("=")
            parameters[key.strip().upper()] = value.strip().strip('"')
        card = (words[0].upper(), parameters, [])
        if "INPUT" in parameters:
            inner = Path(path).parent / parameters["INPUT"]
            if not inner.is_file():
                raise Refused(f"{path}: includes {inner}: no such file")
            if card[0] == "INCLUDE":
                card = None
                yield from cards(inner)
            else:
                card[2].extend([w.strip() for w in text.split(",")] for text in inner.read_text().splitlines() if text.strip())
    if card:
        yield card


def members(lines, parameters, sets):
    """Numbers of a set's lines, with other sets and ranges."""
    if "GENERATE" in parameters:
        for line in lines:
            first, last, step = [int(word) for word in line[:2]] + [int(line[2]) if len(line) > 2 else 1]
            yield from range(first, last + 1, step)
        return
    for word in (word for line in lines for word in line if word):
        yield from [int(word)] if word.lstrip("-").isdigit() else sets[word.upper()]


class Model:
    def __init__(self, path):
        self.path = Path(path)
        self.position, self.element = {}, {}
        self.node_sets, self.element_sets, self.names, self.surface_lines = {}, {}, {}, {}
        if not self.path.is_file():
            raise Refused(f"{path}: there is no such file. Name the input file of a job")
        try:
            for keyword, parameters, lines in cards(path):
                self.take(keyword, parameters, lines)
        except (ValueError, KeyError, IndexError) as error:
            raise Refused(f"{path}: can't be read as an input file of CalculiX ({type(error).__name__}: {error})") from None
        if not self.element:
            raise Refused(f"{path}: has no solid elements (*ELEMENT of a type C3D4, 6, 8, 10, 15 or 20)")
        self.number = {node: k for k, node in enumerate(sorted({n for nodes in self.element.values() for n in nodes}))}

    def take(self, keyword, parameters, lines):
        if keyword == "NODE":
            for line in lines:
                self.position[int(line[0])] = [float(x) for x in (line[1:4] + ["0"] * 3)[:3]]
            self.add(self.node_sets, parameters.get("NSET"), (int(line[0]) for line in lines))
        elif keyword == "ELEMENT":
            self.take_elements(parameters, lines)
        elif keyword in ("NSET", "ELSET"):
            sets = self.node_sets if keyword == "NSET" else self.element_sets
            self.add(sets, parameters[keyword], members(lines, parameters, sets))
        elif keyword == "SURFACE" and parameters.get("TYPE", "ELEMENT").upper() == "ELEMENT":
            self.surface_lines[parameters["NAME"]] = lines

    def take_elements(self, parameters, lines):
        kind = parameters["TYPE"].upper().rstrip("R")
        size = int(kind[3:]) if kind.startswith("C3D") and kind[3:].isdigit() else 0
        if size not in KINDS:
            raise Refused(f"{self.path}: has elements of type {parameters['TYPE']}: solids are read, C3D4, 6, 8, 8R, 10, 15, 20, 20R")
        words = [int(word) for line in lines for word in line if word]
        for start in range(0, len(words), size + 1):
            nodes = words[start + 1:start + size + 1]
            if len(nodes) < size or any(node not in self.position for node in nodes):
                raise Refused(f"{self.path}: element {words[start]} lacks nodes, or names one that is not there")
            self.element[words[start]] = nodes
        self.add(self.element_sets, parameters.get("ELSET"), words[::size + 1])

    def add(self, sets, name, numbers):
        if name is not None:
            self.names.setdefault(name.upper(), name)
            sets.setdefault(name.upper(), []).extend(numbers)

    def faces(self, element):
        """Nodes of each face, corners first, then middles; corners run counter-clockwise seen from outside."""
        nodes = self.element[element]
        faces, edges = KINDS[len(nodes)]
        corners = len({corner for face in faces for corner in face})
        middle = {edge: corners + k for k, edge in enumerate(edges)} if len(nodes) > corners else {}
        position = np.array([self.position[node] for node in nodes])
        for face in faces:
            a, b, c = position[list(face[:3])]
            if np.dot(np.cross(b - a, c - a), a - position[:corners].mean(axis=0)) < 0:
                face = face[::-1]
            around = [middle[tuple(sorted(pair))] for pair in zip(face, face[1:] + face[:1])] if middle else []
            yield [nodes[k] for k in [*face, *around]]

    def blocks(self, faces):
        """Facets by their number of nodes, numbered as in the body file."""
        found = {}
        for face in faces:
            face = [self.number[node] for node in face]
            parts = [face]
            if len(face) == 8:
                parts = [[face[k] for k in part] for part in [*CORNERS_OF_EIGHT, MIDDLE_OF_EIGHT]]
            for part in parts:
                found.setdefault(len(part), []).append(part)
        return [np.array(facets) for facets in found.values()]

    def skin(self):
        """Faces of one element only."""
        seen = {}
        for element in self.element:
            for face in self.faces(element):
                seen.setdefault(frozenset(face), []).append(face)
        return [faces[0] for faces in seen.values() if len(faces) == 1]

    def surfaces(self):
        found = {}
        for name, lines in self.surface_lines.items():
            faces = []
            for where, side in (line[:2] for line in lines):
                if not (side.upper().startswith("S") and side[1:].isdigit()):
                    raise Refused(f"{self.path}: surface {name} has \"{side}\": must be a face of a solid, S1 to S6")
                elements = [int(where)] if where.isdigit() else self.element_sets[where.upper()]
                faces += [list(self.faces(element))[int(side[1:]) - 1] for element in elements]
            found[name] = self.blocks(faces)
        return found

    def nodes(self):
        return np.array([self.position[node] for node in self.number])

    def supports(self):
        sets = {self.names[name]: [self.number[n] for n in nodes if n in self.number] for name, nodes in self.node_sets.items()}
        return {name: nodes for name, nodes in sets.items() if nodes}

    def matrices(self):
        """Of job.sti, job.mas and job.dof, which SOLVER=MATRIXSTORAGE writes: one triangle, rows as listed."""
        dof = self.path.with_suffix(".dof")
        if not dof.is_file():
            raise Refused(f"{dof}: no such file: run ccx on {self.path} with *FREQUENCY, SOLVER=MATRIXSTORAGE first")
        rows = []
        for word in dof.read_text().split():
            node, _, direction = word.partition(".")
            if not node.isdigit() or int(node) not in self.number or direction not in ("1", "2", "3"):
                raise Refused(f"{dof}: has displacement {word} of no node of a solid in {self.path.name}: shells and beams, "
                              "which ccx expands, are not read")
            rows.append(3 * self.number[int(node)] + int(direction) - 1)
        rows = np.array(rows)
        found = {}
        for name, suffix in (("stiffness", ".sti"), ("mass", ".mas")):
            path = self.path.with_suffix(suffix)
            if not path.is_file():
                raise Refused(f"{path}: no such file: run ccx on {self.path} with *FREQUENCY, SOLVER=MATRIXSTORAGE first")
            values = numbers(path.read_bytes())
            i, j = values[0::3].astype(np.int64) - 1, values[1::3].astype(np.int64) - 1
            if values.size % 3 or values.size == 0 or min(i.min(), j.min()) < 0 or max(i.max(), j.max()) >= rows.size:
                raise Refused(f"{path}: is not a matrix of the {rows.size} rows of {dof.name}: run ccx again")
            found[name] = both_triangles(rows[i], rows[j], values[2::3], True)
        return found
