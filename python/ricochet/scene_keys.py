# SPDX-License-Identifier: BSD-2-Clause
"""Units of scene keys, from the reference printed by `ricochet-contact --keys`, and keys in words."""
import re

from ricochet import programs


def units(reference: str) -> dict[str, str]:
    """The unit of each key, by its dotted name with NAME in place of a body or an obstacle."""
    found, within = {}, ""
    for line in reference.splitlines():
        if line.startswith("## "):
            table = re.search(r"\[([a-zA-Z._]+)\]", line)
            within = table[1] + "." if table else ""
        elif row := re.match(r"\| `([^`]+)` \| [^|]* \| ([^|]*) \|", line):
            found[within + row[1]] = row[2].strip()
    return found


def all_units() -> dict[str, str]:
    """As `units`, of the reference of the program."""
    return units(programs.call([programs.BIN / "ricochet-contact", "--keys"], capture=True))


def unit(key: str, units: dict[str, str]) -> str:
    """The unit of a key of a study; empty if it has none."""
    name = re.sub(r"^(bodies|obstacles)\.[^.]+", r"\1.NAME", re.sub(r"\[\d+\]", "", key))
    found = units.get(name) or units.get(re.sub(r"\.material\.[^.]+\.", ".material.", name)) or ""
    return "" if found == "1" else found


#: keys whose words differ from their names
WORDS = {
    "young": "Young's modulus",
    "poisson": "Poisson's ratio",
    "yield": "yield stress",
    "translate": "place",
    "rotate_deg": "rotation",
    "up_to_hz": "highest frequency of modes",
    "rate_hz": "output rate",
    "contact_rate_hz": "rate of contact steps",
}
_SAID = {"material", "geometry"}  # parts that the key beside them makes plain


def words(key: str) -> str:
    """A scene key in words: "velocity of upper, y" for bodies.upper.velocity[1], without its unit."""
    path = re.sub(r"\[\d+\](?=\.)", "", key).split(".")
    counted = [f"{name} {int(number) + 1}" for name, number in re.findall(r"(\w+)\[(\d+)\]\.", key)]
    last, _, index = path[-1].partition("[")
    owner = path[1:2] if path[0] in ("bodies", "obstacles") else counted
    between = [] if path[0] not in ("bodies", "obstacles") else path[2:-1][:1]
    parts = [last, *(part for part in between if part not in _SAID), *owner]
    text = " of ".join(WORDS.get(part, part.replace("_", " ")) for part in parts)
    component = index.rstrip("]")
    return f"{text}, {'xyz'[int(component)] if component in '012' else component}" if component else text
