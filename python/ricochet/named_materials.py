# SPDX-License-Identifier: BSD-2-Clause
"""The materials that scenes can name, with their ranges and sources."""
import difflib
import tomllib
from collections.abc import Mapping
from typing import Any

from ricochet import _core
from ricochet.errors import InputError

# Columns of the list: key, title, unit, and the unit in SI.
COLUMNS = [
    ("density", "density", "kg/m³", 1.0),
    ("young", "young", "GPa", 1e9),
    ("shear", "shear", "GPa", 1e9),
    ("poisson", "poisson", "", 1.0),
    ("yield", "yield", "MPa", 1e6),
    ("loss_factor", "loss factor", "", 1.0),
]


def materials() -> dict[str, dict[str, Any]]:
    """The materials that scenes can name, by name: `density` [kg/m³], `young` [Pa], `poisson` [1], `yield` [Pa] and
    `loss_factor` [1], the last two where they are known; `scatter`, ranges of these values; `source`; `what`, the
    grade; `also`, other names. Orthotropic ones have lists of three as `young`, `shear` [Pa] and `poisson`.
    """
    return tomllib.loads(_core.materials_toml())


def plain(name: str) -> str:
    """The name without what its spelling may vary in, as the reader of scenes compares names."""
    return name.lower().translate({ord(c): None for c in "-_ "})


def find(name: str) -> tuple[str, dict[str, Any]]:
    """A material by one of its names. Raises InputError."""
    own = {plain(word): key for key, one in materials().items() for word in (key, *one.get("also", []))}
    if found := own.get(plain(name)):
        return found, materials()[found]
    near = difflib.get_close_matches(plain(name), own, 3, 0.6)
    parts = [key for word, key in own.items() if len(name) > 2 and plain(name) in word]
    names = dict.fromkeys([*(own[word] for word in near), *parts])
    hint = f": did you mean {', '.join(names)}?" if names else ": ricochet materials lists them"
    raise InputError(f'there is no material "{name}"{hint}')


def value(one: Mapping[str, Any], key: str, unit: float) -> str:
    if key not in one:
        return "–"
    numbers = one[key] if isinstance(one[key], list) else [one[key]]
    return " ".join(f"{number / unit:.5g}" for number in numbers)


def table() -> str:
    """A line for each material. Shear moduli, which follow from the others unless a material is orthotropic, are left to
    its details."""
    columns = [column for column in COLUMNS if column[0] != "shear"]
    rows = [["name", *(title for _, title, _, _ in columns)], ["", *(unit for _, _, unit, _ in columns)]]
    rows += [
        [name, *(value(one, key, unit) for key, _, _, unit in columns)] for name, one in materials().items()
    ]
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return "\n".join(
        "  ".join(
            [row[0].ljust(widths[0]), *(text.rjust(width) for text, width in zip(row[1:], widths[1:]))]
        ).rstrip()
        for row in rows
    )


def details(name: str) -> str:
    """All about one material. Raises InputError if there is none of this name."""
    name, one = find(name)
    lines = [f"{name}: {one['what']}" if "what" in one else name]
    for key, title, unit, size in COLUMNS:
        if key in one:
            low, high = one.get("scatter", {}).get(key, (None, None))
            scatter = f" ({low / size:.4g} to {high / size:.4g})" if low is not None else ""
            lines.append(f"  {title:12} {value(one, key, size)}{scatter} {unit}".rstrip())
    if "also" in one:
        lines.append(f"  {'also':12} {', '.join(one['also'])}")
    lines.append(f"  {'source':12} {one['source']}")
    return "\n".join(lines)
