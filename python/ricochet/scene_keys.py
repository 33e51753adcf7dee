# SPDX-License-Identifier: BSD-2-Clause
"""Keys of scenes, by the reference that `ricochet-contact --keys` prints from what reads them."""
import re


def units(reference: str) -> dict[str, str]:
    """Unit of each key by its dotted name, with NAME for a body or an obstacle."""
    found, within = {}, ""
    for line in reference.splitlines():
        if line.startswith("## "):
            table = re.search(r"\[([a-zA-Z._]+)\]", line)
            within = table[1] + "." if table else ""
        elif row := re.match(r"\| `([^`]+)` \| [^|]* \| ([^|]*) \|", line):
            found[within + row[1]] = row[2].strip()
    return found


def unit(key: str, units: dict[str, str]) -> str:
    """Of a key as studies name it; "" where it has none."""
    name = re.sub(r"^(bodies|obstacles)\.[^.]+", r"\1.NAME", re.sub(r"\[\d+\]", "", key))
    found = units.get(name) or units.get(re.sub(r"\.material\.[^.]+\.", ".material.", name)) or ""
    return "" if found == "1" else found
