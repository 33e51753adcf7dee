# SPDX-License-Identifier: BSD-2-Clause
"""The mesh of a Nastran file, with what it states about materials and supports."""
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ricochet.errors import InputError
from ricochet.interchange.bulk import Entry, control_and_bulk, entries
from ricochet.interchange.cells import no_pyramids
from ricochet.interchange.draft import Material, Offer
from ricochet.interchange.elements import FACET_CORNERS, TOP_LAST
from ricochet.interchange.mesh import Mesh

# Numbers of nodes of elements: without and with middle nodes.
SOLIDS = {"CTETRA": (4, 10), "CPENTA": (6, 15), "CHEXA": (8, 20)}
SHELLS = {"CTRIA3": 3, "CTRIAR": 3, "CTRIA6": 6, "CQUAD4": 4, "CQUADR": 4, "CQUAD8": 8, "CQUAD": 9}
# What a scene needs no warning about: loads, output, parameters and properties.
SILENT = re.compile(
    "PARAM|PLOAD.*|FORCE.*|MOMENT.*|GRAV|LOAD|TEMP.*|EIGR|EIGC|SET.*|ASET.*|MDLPRM|PLOTEL|CORD.*|TABLE.*|"
    "FREQ.*|NLPARM|TSTEP.*|TLOAD.*|RLOAD.*|DLOAD|DAREA|SPOINT|ENDDATA|PBAR.*|PBEAM.*|PROD|PBUSH|PELAS"
)


class Bulk:
    """Numbers are those of the file, and so are units."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.position: dict[int, list[float]] = {}
        self.solids: dict[int, dict[int, list[int]]] = {}  # by number of nodes, by number: nodes
        self.place: dict[int, str] = {}  # where a solid is defined
        self.parts: dict[int, list[int]] = {}  # solids of each property
        self.shells: dict[int, list[list[int]]] = {}  # corners of the facets of each property
        self.material: dict[int, Material] = {}
        self.of_property: dict[int, int] = {}
        self.held: dict[int, dict[int, str]] = {}  # by set of SPC: digits of components by node
        self.sums: dict[int, list[int]] = {}  # SPCADD
        self.permanent: dict[int, str] = {}  # of GRID
        self.local: set[int] = set()  # nodes whose displacements have axes of their own
        self.groups: dict[str, list[tuple[str, str]]] = {}  # of SPC N: groups of nodes and components
        self.stiff_shells = False
        self.modes = 0
        self.warnings: dict[str, str] = {}
        readers: dict[str, Callable[[Entry], None]] = {
            "GRID": self.take_grid,
            "PSOLID": lambda entry: self.of_property.update({entry.whole(0): entry.whole(1, 0)}),
            "PSHELL": lambda _: setattr(self, "stiff_shells", True),
            "PCOMP": lambda _: setattr(self, "stiff_shells", True),
            "MAT1": self.take_material,
            "SPC": self.take_spc,
            "SPC1": self.take_spc1,
            "SPCADD": lambda entry: self.sums.update({entry.whole(0): entry.wholes(1)}),
            "EIGRL": lambda entry: setattr(self, "modes", entry.whole(3, 0)),
            **dict.fromkeys(SOLIDS, self.take_solid),
            **dict.fromkeys(SHELLS, self.take_shell),
        }
        self.control, lines = control_and_bulk(path)
        for entry in entries(lines):
            if entry.name in readers:
                readers[entry.name](entry)
            elif entry.name in ("CPYRAM", "CPYRA"):
                raise no_pyramids(entry.where)
            elif not SILENT.fullmatch(entry.name):
                self.warnings.setdefault(
                    entry.name, f"{entry.where}: {entry.name} is not read: the scene lacks it"
                )
        if not self.solids:
            raise InputError(
                f"{path}: has no solid elements (CTETRA, CPENTA or CHEXA): export the volume elements"
            )

    def take_grid(self, entry: Entry) -> None:
        number = entry.whole(0)
        if entry.whole(1, 0) != 0:
            raise InputError(
                f"{entry.where}: GRID {number} is given in coordinate system {entry.whole(1)}: export the mesh in the basic "
                "system, 0"
            )
        if number in self.position:
            raise InputError(f"{entry.where}: GRID {number} is there twice")
        self.position[number] = [entry.real(k, 0.0) or 0.0 for k in (2, 3, 4)]
        if entry.whole(5, 0) > 0:
            self.local.add(number)
        if entry.field(6):
            self.permanent[number] = entry.field(6)

    def take_solid(self, entry: Entry) -> None:
        number, nodes = entry.whole(0), [entry.whole(k, 0) for k in range(2, len(entry))]
        while nodes and nodes[-1] == 0:
            nodes.pop()
        if len(nodes) not in SOLIDS[entry.name] or 0 in nodes:
            few, many = SOLIDS[entry.name]
            raise InputError(
                f"{entry.where}: {entry.name} {number} has {len(nodes) - nodes.count(0)} nodes: must be {few} or {many}"
            )
        if number in self.place:
            raise InputError(f"{entry.where}: element {number} is there twice")
        self.place[number] = entry.where
        self.solids.setdefault(len(nodes), {})[number] = nodes
        if part := entry.whole(1, 0):
            self.parts.setdefault(part, []).append(number)

    def take_shell(self, entry: Entry) -> None:
        corners = [entry.whole(k) for k in range(2, 2 + FACET_CORNERS[SHELLS[entry.name]])]
        if part := entry.whole(1, 0):
            self.shells.setdefault(part, []).append(corners)

    def take_material(self, entry: Entry) -> None:
        young, shear, poisson = entry.real(1), entry.real(2), entry.real(3)
        # Two of the three values define the third one.
        if young is None and shear is not None and poisson is not None:
            young = 2 * shear * (1 + poisson)
        if poisson is None and young is not None and shear:
            poisson = young / (2 * shear) - 1
        number = entry.whole(0)
        self.material[number] = Material(f"MAT1 {number}", entry.real(4), young, poisson)

    def take_spc(self, entry: Entry) -> None:
        for k in range(1, len(entry), 3):
            if not entry.field(k):
                continue
            self.hold(entry, entry.whole(k), entry.field(k + 1))
            if entry.real(k + 2, 0.0):
                self.warnings.setdefault(
                    "SPC",
                    f"{entry.where}: SPC prescribes a displacement: the scene holds these nodes instead",
                )

    def take_spc1(self, entry: Entry) -> None:
        for number in entry.wholes(2):
            self.hold(entry, number, entry.field(1))

    def hold(self, entry: Entry, node: int, digits: str) -> None:
        held = self.held.setdefault(entry.whole(0), {})
        held[node] = held.get(node, "") + digits

    def nodes(self, numbers: list[int], where: str, index: dict[int, int]) -> list[int]:
        missing = [number for number in numbers if number not in index]
        if missing:
            raise InputError(f"{where}: names node {missing[0]}, which is not there")
        return [index[number] for number in numbers]

    def mesh(self) -> Mesh:
        numbers = sorted(self.position)
        index = {number: k for k, number in enumerate(numbers)}
        blocks = {
            size: np.array([self.nodes(nodes, self.place[n], index) for n, nodes in block.items()])
            for size, block in self.solids.items()
        }
        solid = [number for block in self.solids.values() for number in block]
        mesh = Mesh(
            self.path,
            np.array([self.position[n] for n in numbers], float),
            np.array(numbers),
            blocks,
            np.array(solid),
            edges=TOP_LAST,
        )
        place = {number: k for k, number in enumerate(solid)}
        for part, elements in sorted(self.parts.items()):
            mesh.solid_groups[str(part)] = np.array([place[number] for number in elements])
        for part, facets in sorted(self.shells.items()):
            rows = [
                (self.nodes(f, f"{self.path}: shells of property {part}", index) + [-1])[:4] for f in facets
            ]
            mesh.facet_groups[str(part)] = np.array(rows)
        if self.stiff_shells and self.shells:
            mesh.warn("shells give groups of faces, but no stiffness")
        mesh.warnings += self.warnings.values()
        self.add_supports(mesh, index)
        return mesh

    def add_supports(self, mesh: Mesh, index: dict[int, int]) -> None:
        """A group of nodes for each set of supports and the components that it holds."""
        sets = {f"SPC {number}": held for number, held in sorted(self.held.items())}
        for name, held in (sets | ({"GRID": self.permanent} if self.permanent else {})).items():
            found: dict[str, list[int]] = {}
            for node, digits in held.items():
                if components := "".join("xyz"[k - 1] for k in (1, 2, 3) if str(k) in digits):
                    found.setdefault(components, []).append(node)
            for components, nodes in found.items():
                group = name if len(found) == 1 else f"{name} {components}"
                mesh.node_groups[group] = np.array(self.nodes(nodes, f"{self.path}: {name}", index))
                self.groups.setdefault(name, []).append((group, components))
                if self.local.intersection(nodes):
                    mesh.warn(
                        f"{name} holds nodes in axes of their own (CD): the scene holds them in those of the mesh"
                    )

    def offer(self) -> Offer:
        offer = Offer(modes=self.modes)
        for part in sorted(self.parts):
            if (number := self.of_property.get(part, 0)) in self.material:
                offer.materials[str(part)] = self.material[number]
        for name in self.chosen():
            for group, components in self.groups.get(name, []):
                offer.hold(group, components)
        return offer

    def chosen(self) -> list[str]:
        """The sets of supports that the case control names, or all of them."""
        named = [
            int(found[1])
            for line in self.control
            if (found := re.match(r"\s*SPC\s*=\s*(\d+)", line, re.IGNORECASE))
        ]
        numbers = [one for number in named[:1] for one in self.sums.get(number, [number])] or list(self.held)
        return ["GRID", *(f"SPC {number}" for number in numbers)]


def read(path: Path) -> tuple[Mesh, Offer]:
    """The mesh of a file of bulk data in its units, and what it states for a scene. Raises InputError and OSError."""
    bulk = Bulk(path)
    mesh = bulk.mesh()
    return mesh, bulk.offer()
