# SPDX-License-Identifier: BSD-2-Clause
"""Units of scene keys, from the reference printed by `ricochet-contact --keys`."""
import re


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


def unit(key: str, units: dict[str, str]) -> str:
    """The unit of a key of a study; empty if it has none."""
    name = re.sub(r"^(bodies|obstacles)\.[^.]+", r"\1.NAME", re.sub(r"\[\d+\]", "", key))
    found = units.get(name) or units.get(re.sub(r"\.material\.[^.]+\.", ".material.", name)) or ""
    return "" if found == "1" else found
