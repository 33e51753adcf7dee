# SPDX-License-Identifier: BSD-2-Clause
"""Input files of Abaqus and CalculiX: nodes, elements, sets, surfaces, materials and supports.

Sources: Abaqus, "Keywords guide"; CalculiX CrunchiX user's manual.
"""
import math
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from ricochet.errors import InputError
from ricochet.interchange.assembly import Assembly
from ricochet.interchange.cards import Line, cards, members, set_of
from ricochet.interchange.draft import Material
from ricochet.interchange.elements import SOLIDS
from ricochet.interchange.numbers import is_number

# Shells, membranes, rigid facets and plane elements: their nodes are those of a facet.
FACET = re.compile(r"(?:S|STRI|M3D|R3D|SFM3D|DS|CPS|CPE)([34689])(?![0-9])")
SOLID = re.compile(r"C3D([0-9]+)([A-Z]*)")
# What a scene can't have, although the modes depend on it.
CONSTRAINTS = {
    *(
        "EQUATION",
        "MPC",
        "TIE",
        "RIGID BODY",
        "COUPLING",
        "KINEMATIC COUPLING",
        "EMBEDDED ELEMENT",
        "CYCLIC SYMMETRY MODEL",
    ),
    *(
        "SPRING",
        "DASHPOT",
        "MASS",
        "ROTARY INERTIA",
        "GAP",
        "CONTACT PAIR",
        "TRANSFORM",
        "ORIENTATION",
        "DAMPING",
    ),
    *(
        "INITIAL CONDITIONS",
        "PRE-TENSION SECTION",
        "CONNECTOR SECTION",
        "NONSTRUCTURAL MASS",
        "SHELL TO SOLID COUPLING",
    ),
}
# What would change or make nodes and elements.
GENERATORS = {"NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SYMMETRIC MODEL GENERATION"}
# The displacements that the named supports of Abaqus hold.
NAMED_SUPPORTS = {
    **{"ENCASTRE": "xyz", "PINNED": "xyz", "XSYMM": "x", "YSYMM": "y", "ZSYMM": "z"},
    **{"XASYMM": "yz", "YASYMM": "xz", "ZASYMM": "xy"},
}


class Support(NamedTuple):
    target: str  # a set or a number of a node
    components: str  # some of "xyz"
    line: Line


class Deck:
    """Numbers are those of the file, and so are units. Sets are found by their names in capitals."""

    def __init__(self, path: Path) -> None:
        self.path = Path(path)
        self.position: dict[int, list[float]] = {}
        self.element: dict[int, list[int]] = {}  # solids
        self.facet: dict[int, list[int]] = {}
        self.types: dict[str, str] = {}  # of all elements: the place of the first one
        self.node_sets: dict[str, list[int]] = {}
        self.element_sets: dict[str, list[int]] = {}
        self.names: dict[str, str] = {}
        self.surface_lines: dict[str, list[Line]] = {}
        self.surface_place: dict[str, str] = {}
        self.material: dict[str, Material] = {}
        self.current: Material | None = None
        self.section: dict[str, str] = {}  # the material of a set of elements
        self.supports_given: list[Support] = []
        self.modes = 0  # requested by *FREQUENCY
        self.warnings: list[str] = []
        if not self.path.is_file():
            raise InputError(f"{path}: there is no such file. Name the input file of a job")
        assembly = Assembly()
        for where, keyword, parameters, lines in assembly.flattened(cards(path)):
            try:
                self.where = where
                self.take(keyword, parameters, lines)
            except (ValueError, KeyError, IndexError, ZeroDivisionError):
                raise InputError(f"{self.where}: can't be read as *{keyword} of CalculiX") from None
        self.instances = list(assembly.instances)

    def take(self, keyword: str, parameters: dict[str, str], lines: list[Line]) -> None:
        if keyword == "NODE":
            self.take_nodes(parameters, lines)
        elif keyword == "ELEMENT":
            self.take_elements(parameters, lines)
        elif keyword in ("NSET", "ELSET"):
            sets = self.node_sets if keyword == "NSET" else self.element_sets
            self.add(sets, parameters[keyword], members(self.each(lines), parameters, sets))
            if keyword == "NSET" and "ELSET" in parameters:
                self.add(sets, parameters["NSET"], self.nodes_of(parameters["ELSET"]))
        elif keyword == "SURFACE":
            self.take_surface(parameters, lines)
        elif keyword == "MATERIAL":
            self.material[parameters["NAME"].upper()] = self.current = Material(parameters["NAME"])
        elif keyword in ("ELASTIC", "DENSITY"):
            self.take_property(keyword, parameters, lines)
        elif keyword == "SOLID SECTION":
            self.section[parameters["ELSET"].upper()] = parameters["MATERIAL"].upper()
        elif keyword == "BOUNDARY":
            self.take_supports(lines)
        elif keyword == "FREQUENCY" and lines:
            self.modes = int(lines[0][0])
        elif keyword in GENERATORS:
            raise InputError(
                f"{self.where}: *{keyword} is not read: write out the nodes and elements that it makes"
            )
        elif keyword in CONSTRAINTS:
            self.warn_once(f"*{keyword} is not read: the scene lacks it")

    def warn_once(self, text: str) -> None:
        if not any(warning.endswith(text) for warning in self.warnings):
            self.warnings.append(f"{self.where}: {text}")

    def each(self, lines: Iterable[Line]) -> Iterator[Line]:
        """Yields the lines and records the place of each, for error messages."""
        for line in lines:
            self.where = line.where
            yield line

    def take_nodes(self, parameters: dict[str, str], lines: list[Line]) -> None:
        if parameters.get("SYSTEM", "R").upper() != "R":
            raise InputError(f"{self.where}: nodes in polar coordinates are not read: give x, y, z")
        for line in self.each(lines):
            place = [float(x) for x in (line[1:4] + ["0"] * 3)[:3]]
            if not all(map(math.isfinite, place)):
                raise InputError(f"{line.where}: node {line[0]} has a coordinate that is not finite")
            self.position[int(line[0])] = place
        self.add(self.node_sets, parameters.get("NSET"), (int(line[0]) for line in lines))

    def take_elements(self, parameters: dict[str, str], lines: Iterable[Line]) -> None:
        kind = parameters["TYPE"].upper()
        self.types.setdefault(kind, self.where)
        if found := SOLID.fullmatch(kind):
            target, size = self.element, int(found[1])
        elif found := FACET.match(kind):
            target, size = self.facet, int(found[1])
        if not found or (target is self.element and size not in SOLIDS):
            numbers = [int(line[0]) for line in self.each(lines)]
            self.add(self.element_sets, parameters.get("ELSET"), numbers)
            return
        numbers, words = [], list[int]()
        for line in self.each(lines):
            words += [int(word) for word in line if word]
            if len(words) > size + 1:
                raise InputError(f"{self.where}: element {words[0]} has more nodes than the {size} of {kind}")
            if len(words) == size + 1:
                self.take_element(target, words)
                numbers.append(words[0])
                words = []
        if words:
            raise InputError(f"{self.where}: element {words[0]} lacks nodes: {kind} has {size}")
        self.add(self.element_sets, parameters.get("ELSET"), numbers)

    def take_element(self, target: dict[int, list[int]], words: list[int]) -> None:
        number, *nodes = words
        if missing := [node for node in nodes if node not in self.position]:
            raise InputError(f"{self.where}: element {number} names node {missing[0]}, which is not there")
        if number in self.element or number in self.facet:
            raise InputError(f"{self.where}: element {number} is there twice")
        target[number] = nodes

    def add(self, sets: dict[str, list[int]], name: str | None, numbers: Iterable[int]) -> None:
        if name is not None:
            self.names.setdefault(name.upper(), name)
            new = list(numbers)  # which may be those of the set itself
            sets.setdefault(name.upper(), []).extend(new)

    def nodes_of(self, elements: str) -> set[int]:
        """The nodes of a set of elements."""
        if elements.upper() not in self.element_sets:
            raise InputError(f"{self.where}: names the set {elements}, which is not there")
        found = self.element_sets[elements.upper()]
        both = self.element | self.facet
        return {node for element in found for node in both.get(element, ())}

    def take_surface(self, parameters: dict[str, str], lines: list[Line]) -> None:
        name = parameters["NAME"]
        if parameters.get("TYPE", "ELEMENT").upper() == "NODE":
            self.add(self.node_sets, name, members(self.each(lines), {}, self.node_sets))
        elif name in self.surface_lines:
            raise InputError(f'{self.where}: surface "{name}" has the name of another one: rename it')
        else:
            self.names.setdefault(name.upper(), name)
            self.surface_lines[name] = lines
            self.surface_place[name] = self.where

    def take_property(self, keyword: str, parameters: dict[str, str], lines: list[Line]) -> None:
        if self.current is None:
            raise InputError(f"{self.where}: *{keyword} belongs to no *MATERIAL: put it below one")
        kind = parameters.get("TYPE", "ISO").upper()
        if not kind.startswith("ISO") and keyword == "ELASTIC":
            self.warn_once(f"*ELASTIC, TYPE={kind} is not isotropic and is not read: the scene lacks it")
            return
        if len(lines) > 1:
            self.warn_once(
                f"*{keyword} has {len(lines)} lines, of which the first is read: give one temperature"
            )
        self.where = lines[0].where
        values = [float(word) for word in lines[0] if word]
        if keyword == "DENSITY":
            self.current.density = values[0]
        else:
            self.current.young, self.current.poisson = values[:2] if len(values) > 1 else (values[0], 0.0)

    def take_supports(self, lines: list[Line]) -> None:
        for line in self.each(lines):
            if not line[0]:
                continue
            named = line[1].upper() if len(line) > 1 else ""
            if named in NAMED_SUPPORTS:
                self.supports_given.append(Support(line[0], NAMED_SUPPORTS[named], line))
                continue
            first = int(line[1])
            last = int(line[2]) if len(line) > 2 and line[2] else first
            if len(line) > 3 and line[3] and float(line[3]) != 0:
                self.warn_once("*BOUNDARY prescribes a displacement: the scene holds these nodes instead")
            components = "".join("xyz"[k - 1] for k in range(first, last + 1) if 1 <= k <= 3)
            if components:
                self.supports_given.append(Support(line[0], components, line))

    def sides(self, surface: str) -> Iterator[tuple[Line, int, str]]:
        """Yields the line, the element and the side (S1, …, or "" for the free ones) of each face of a surface."""
        for line in self.surface_lines[surface]:
            of, side = (line + [""])[:2]
            for element in [int(of)] if is_number(of) else set_of(self.element_sets, of, line):
                yield line, element, side.upper()
