# SPDX-License-Identifier: BSD-2-Clause
"""Input files of Abaqus with parts and instances, as the flat files of CalculiX.

Each instance gets the nodes and elements of its part, with numbers of its own, at its place. The sets and surfaces of
an instance are called INSTANCE.SET, as the assembly calls them.
"""
from collections.abc import Iterable, Iterator

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.cards import Card, Line
from ricochet.interchange.numbers import is_number

# By keyword, the parameter that names or defines a set, a surface or a section.
NAMED = {
    **{"NODE": "NSET", "ELEMENT": "ELSET", "NSET": "NSET", "ELSET": "ELSET"},
    **{"SURFACE": "NAME", "SOLID SECTION": "ELSET"},
}


class Instance:
    """A copy of a part. `offset` is added to its numbers of nodes and elements."""

    def __init__(self, name: str, lines: list[Line], offset: int) -> None:
        self.name, self.offset = name, offset
        values = [[float(word) for word in line if word] for line in lines]
        self.shift = np.array(values[0]) if values else np.zeros(3)
        self.axis = values[1] if len(values) > 1 else []
        if self.shift.shape != (3,) or len(self.axis) not in (0, 7) or not np.isfinite(sum(values, [])).all():
            raise ValueError

    def placed(self, point: Array) -> Array:
        """Moves a point by the translation, and then turns it about the axis."""
        point = point + self.shift
        if not self.axis:
            return point
        start, end = np.array(self.axis[:3]), np.array(self.axis[3:6])
        k, angle = (end - start) / np.linalg.norm(end - start), np.radians(self.axis[6])
        arm = point - start
        turned = arm * np.cos(angle) + np.cross(k, arm) * np.sin(angle) + k * (k @ arm) * (1 - np.cos(angle))
        moved: Array = start + turned
        return moved

    def renamed(self, word: str) -> str:
        """A number or the name of a set of the part, as that of the instance."""
        if is_number(word):
            return str(int(word) + self.offset)
        return f"{self.name}.{word}" if word else word

    def line(self, keyword: str, parameters: dict[str, str], line: Line) -> Line:
        """A line of a card of the part, as that of the instance."""
        words = list(line)
        if keyword == "NODE":
            place = [float(x) for x in (words[1:4] + ["0"] * 3)[:3]]
            words = [self.renamed(words[0]), *(repr(float(x)) for x in self.placed(np.array(place)))]
        elif keyword in ("NSET", "ELSET") and "GENERATE" in parameters:
            words[:2] = [self.renamed(word) for word in words[:2]]
        elif keyword in ("ELEMENT", "NSET", "ELSET"):
            words = [self.renamed(word) for word in words]
        elif keyword in ("SURFACE", "BOUNDARY"):
            words[0] = self.renamed(words[0])
        return Line(words, line.where)

    def card(self, card: Card) -> Card:
        where, keyword, parameters, lines = card
        named = NAMED.get(keyword, "")
        if named in parameters:
            parameters = parameters | {named: self.renamed(parameters[named])}
        return where, keyword, parameters, [self.line(keyword, parameters, line) for line in lines]


def largest(cards: Iterable[Card]) -> int:
    """The largest number of a node or an element."""
    return max(
        (int(line[0]) for _, keyword, _, lines in cards for line in lines if keyword in ("NODE", "ELEMENT")),
        default=0,
    )


class Assembly:
    def __init__(self) -> None:
        self.parts: dict[str, list[Card]] = {}
        self.instances: dict[str, Instance] = {}
        self.open: list[Card] | None = None  # cards of the part or instance that is being read
        self.instance: Instance | None = None
        self.offset = 0

    def take(self, card: Card) -> Iterator[Card]:
        """Takes the next card of the file. Yields those of the flat file that it completes."""
        where, keyword, parameters, lines = card
        if keyword == "PART":
            self.open = self.declared(self.parts, "part", parameters["NAME"], where)
        elif keyword == "INSTANCE":
            self.start(where, parameters, lines)
        elif keyword == "END INSTANCE" and self.instance and self.open is not None:
            yield from map(self.instance.card, self.open)
            self.offset += largest(self.open)
            self.open = self.instance = None
        elif keyword in ("END PART", "ASSEMBLY", "END ASSEMBLY"):
            self.open = None
        elif self.open is not None:
            self.open.append(card)
        else:
            yield self.of_assembly(card)

    def declared(self, where_of: dict[str, list[Card]], what: str, name: str, place: str) -> list[Card]:
        if name.upper() in where_of:
            raise InputError(f"{place}: two {what}s are called {name}: rename one")
        return where_of.setdefault(name.upper(), [])

    def start(self, where: str, parameters: dict[str, str], lines: list[Line]) -> None:
        name, part = parameters["NAME"], parameters["PART"]
        if part.upper() not in self.parts:
            raise InputError(f"{where}: is an instance of the part {part}, which is not there")
        if name.upper() in self.instances:
            raise InputError(f"{where}: two instances are called {name}: rename one")
        self.instance = self.instances[name.upper()] = Instance(name, lines, self.offset)
        self.open = list(self.parts[part.upper()])

    def of_assembly(self, card: Card) -> Card:
        """A set of the assembly whose members are those of an instance."""
        where, keyword, parameters, lines = card
        if keyword not in ("NSET", "ELSET") or "INSTANCE" not in parameters:
            return card
        of = parameters["INSTANCE"]
        if of.upper() not in self.instances:
            raise InputError(f"{where}: names the instance {of}, which is not there")
        instance = self.instances[of.upper()]
        return where, keyword, parameters, [instance.line(keyword, parameters, line) for line in lines]

    def flattened(self, cards: Iterable[Card]) -> Iterator[Card]:
        """Yields the cards of a file without parts and instances. Raises InputError."""
        for card in cards:
            try:
                yield from self.take(card)
            except (ValueError, KeyError, IndexError):
                raise InputError(f"{card[0]}: can't be read as *{card[1]} of Abaqus") from None
        if self.open is not None:
            raise InputError(f"{card[0]}: the file ends inside a part or an instance: export it again")
