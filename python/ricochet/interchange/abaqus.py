# SPDX-License-Identifier: BSD-2-Clause
"""The mesh of an input file of Abaqus or CalculiX, with what it states about materials and supports."""
from collections import Counter
from pathlib import Path

import numpy as np

from ricochet.arrays import Array
from ricochet.interchange.cards import set_of
from ricochet.interchange.deck import FACET, SOLID, Deck
from ricochet.interchange.draft import Offer
from ricochet.interchange.elements import FACET_CORNERS, SOLIDS
from ricochet.interchange.mesh import Mesh
from ricochet.interchange.numbers import is_number
from ricochet.errors import InputError


class Conversion:
    """From numbers of the deck to places in the mesh."""

    def __init__(self, deck: Deck) -> None:
        self.deck = deck
        numbers = sorted(deck.position)
        self.node = {number: k for k, number in enumerate(numbers)}
        blocks: dict[int, list[int]] = {}
        for number, nodes in deck.element.items():
            blocks.setdefault(len(nodes), []).append(number)
        self.solid = {number: k for k, number in enumerate(n for block in blocks.values() for n in block)}
        self.mesh = Mesh(
            deck.path,
            np.array([deck.position[number] for number in numbers], float),
            np.array(numbers),
            {size: self.nodes([deck.element[n] for n in block]) for size, block in blocks.items()},
            np.array(list(self.solid)),
            warnings=deck.warnings,
        )

    def nodes(self, rows: list[list[int]]) -> Array:
        return np.array([[self.node[number] for number in row] for row in rows], np.int64)

    def facets(self, rows: list[list[int]]) -> Array:
        corners = [(row[: FACET_CORNERS[len(row)]] + [-1])[:4] for row in rows]
        places = self.node | {-1: -1}
        return np.array([[places[number] for number in row] for row in corners], np.int64).reshape(-1, 4)

    def name(self, capitals: str, sets: dict[str, list[int]]) -> str:
        """The name of a set as the deck writes it, without that of its instance if there is only one."""
        name = self.deck.names.get(capitals, capitals)
        prefix = f"{self.deck.instances[0]}." if len(self.deck.instances) == 1 else ""
        bare = name[len(prefix) :]
        return bare if prefix and name.upper().startswith(prefix) and bare.upper() not in sets else name

    def add_sets(self) -> None:
        deck, mesh = self.deck, self.mesh
        for capitals, numbers in deck.element_sets.items():
            name = self.name(capitals, deck.element_sets)
            if solids := [self.solid[n] for n in numbers if n in self.solid]:
                mesh.solid_groups[name] = np.array(solids)
            if facets := [deck.facet[n] for n in numbers if n in deck.facet]:
                mesh.facet_groups[name] = self.facets(facets)
        for name in deck.surface_lines:
            self.add_surface(name)
        for capitals, numbers in deck.node_sets.items():
            nodes = [self.node[n] for n in numbers if n in self.node]
            mesh.node_groups[self.name(capitals, deck.node_sets)] = np.array(nodes, np.int64)

    def add_surface(self, name: str) -> None:
        deck, found, free = self.deck, [], []
        for line, element, side in deck.sides(name):
            if element in deck.facet:
                found.append(deck.facet[element])
                continue
            nodes = deck.element.get(element)
            faces = SOLIDS[len(nodes)].faces if nodes else []
            rows = [[nodes[corner] for corner in face] for face in faces] if nodes else []
            known = {f"S{k}": row for k, row in enumerate(rows, 1)}
            if nodes and not side:
                free += rows
            elif side in known:
                found.append(known[side])
            else:
                raise InputError(
                    f'{line.where}: surface {name} has "{side}" of element {element}: must be a face of a solid, '
                    f"S1 to S{len(known) or 6}"
                )
        count = Counter(frozenset(row) for row in free)
        found += [row for row in free if count[frozenset(row)] == 1]
        self.mesh.facet_groups[self.name(name.upper(), {})] = self.facets(found)

    def add_supports(self, offer: Offer) -> None:
        """Supports of sets, and groups of their own for nodes that the deck names one by one."""
        deck, single = self.deck, dict[int, str]()
        for support in deck.supports_given:
            if is_number(support.target):
                number = int(support.target)
                if number not in self.node:
                    raise InputError(f"{support.line.where}: names node {number}, which is not there")
                single[number] = "".join(sorted({*single.get(number, ""), *support.components}))
                continue
            set_of(deck.node_sets, support.target, support.line)
            name = self.name(support.target.upper(), deck.node_sets)
            offer.hold(name, support.components)
        for components in sorted(set(single.values())):
            nodes = [self.node[number] for number, held in single.items() if held == components]
            name = f"held in {components}"
            self.mesh.node_groups[name] = np.array(nodes)
            offer.hold(name, components)

    def add_materials(self, offer: Offer) -> None:
        for elements, material in self.deck.section.items():
            name = self.name(elements, self.deck.element_sets)
            if material not in self.deck.material:
                self.mesh.warn(f"*SOLID SECTION names the material {material}, which is not there")
            elif name in self.mesh.solid_groups:
                offer.materials[name] = self.deck.material[material]

    def judge_types(self) -> None:
        """Refuses solids that a body can't have, and warns of other elements that are left out."""
        for kind, where in self.deck.types.items():
            solid = SOLID.fullmatch(kind)
            if kind.startswith(("C3D", "SC", "CSS")) and not (solid and int(solid[1]) in SOLIDS):
                raise InputError(
                    f"{where}: has elements of type {kind}: solids of 4, 6, 8, 10, 15, 18, 20 or 27 nodes are read, C3D4 to "
                    "C3D27"
                )
            if solid or kind.startswith(("CPS", "CPE", "R3D", "SFM3D")):
                continue
            facet = FACET.match(kind)
            what = "give groups of faces, but no stiffness" if facet else "are not read"
            self.mesh.warnings.append(f"{where}: elements of type {kind} {what}")


def read(path: Path) -> tuple[Mesh, Offer]:
    """The mesh of a deck in its units, and what it states for a scene. Raises InputError and OSError."""
    conversion, offer = Conversion(Deck(path)), Offer()
    conversion.judge_types()
    conversion.add_sets()
    conversion.add_supports(offer)
    conversion.add_materials(offer)
    offer.modes = conversion.deck.modes
    return conversion.mesh, offer
