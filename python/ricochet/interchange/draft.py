# SPDX-License-Identifier: BSD-2-Clause
"""The draft of a scene, with the materials and supports of a deck."""
import os
import re
from dataclasses import dataclass, field
from pathlib import Path

from ricochet.interchange.faces import Groups


@dataclass
class Material:
    """Values in the units of the deck, None where it has none."""

    name: str
    density: float | None = None
    young: float | None = None
    poisson: float | None = None

    def in_units(self, length: float, mass: float) -> "Material":
        """The same in SI units: E [mass/(length s²)], density [mass/length³]."""
        density, young = self.density, self.young
        return Material(
            self.name,
            None if density is None else density * mass / length**3,
            None if young is None else young * mass / length,
            self.poisson,
        )

    def in_words(self) -> str:
        """The name, and the values that the deck has."""
        values = {name: getattr(self, name) for name in UNITS}
        return f"{self.name} ({', '.join(f'{k} {v:g}' for k, v in values.items() if v is not None)})"


UNITS = {"density": "kg/m³", "young": "Pa", "poisson": ""}


@dataclass
class Offer:
    """What a deck states for a scene."""

    materials: dict[str, Material] = field(default_factory=dict)  # by set of elements
    supports: dict[str, str] = field(default_factory=dict)  # by set of nodes: some of "xyz"
    modes: int = 0  # that the deck asks for

    def hold(self, name: str, components: str) -> None:
        """Adds the components that a support holds."""
        self.supports[name] = "".join(sorted({*self.supports.get(name, ""), *components}))


def quoted(text: str) -> str:
    """A string of TOML. `text` is printable."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def key(text: str) -> str:
    return text if re.fullmatch("[A-Za-z0-9_-]+", text) else quoted(text)


def table(name: str, material: Material) -> list[str]:
    """The table of a material. A value that the deck lacks is left open."""
    lines = [f"[{name}]  # {material.name}"]
    for value, unit in UNITS.items():
        number = getattr(material, value)
        comment = f"  # {unit}" if unit else ""
        if number is None:
            lines.append(f"# {value} = …{comment}: not in the file")
        else:  # without the last digit, which conversions change
            lines.append(f"{value} = {float(f'{number:.15g}')!r}{comment}")
    return lines


def scene(mesh: Path, path: Path, source: Path, offer: Offer, groups: Groups, names: dict[str, str]) -> str:
    """The text of the scene at `path`. `names`: the group of each set of nodes."""
    body = re.sub("[^A-Za-z0-9_-]+", "-", mesh.stem).strip("-") or "body"
    lines = [
        f"# Materials and supports of {source.name}, by ricochet import mesh. Values are in SI units if those of the file",
        "# are, or if --length-unit and --mass-unit converted them.",
        f"[bodies.{body}]",
        f"mesh = {quoted(os.path.relpath(mesh, path.parent))}",
    ]
    if groups.faces:
        lines.append(
            f"# contact = {quoted(next(iter(groups.faces)))}  # faces: {', '.join(map(quoted, groups.faces))}"
        )
    held = {names[name]: components for name, components in offer.supports.items() if name in names}
    if held:
        lines += ["", f"[bodies.{body}.support]"]
        lines += [f"{key(name)} = {quoted(components)}" for name, components in held.items()]
    whole = len(offer.materials) == 1 and len(groups.solids) == 1
    for group, material in offer.materials.items():
        lines += ["", *table(f"bodies.{body}.material" + ("" if whole else f".{key(group)}"), material)]
    if not offer.materials:
        lines += ["", *table(f"bodies.{body}.material", Material("not in the file"))]
    lines += ["", "[modes]", f"count = {offer.modes or 20}", ""]
    return "\n".join(lines)
