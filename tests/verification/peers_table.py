# SPDX-License-Identifier: BSD-2-Clause
"""Impacts by Ricochet and by other codes: results side by side, and times.

    scripts/verify --peers                          # every comparison; about 40 minutes of processor time
    scripts/verify --peers oblique --figures DIR    # this one; also draws it

The other code is CalculiX on the same meshes, at equal accuracy; for `boxes`, MuJoCo. scripts/setup --peers installs both.
Finished runs of CalculiX are kept in DIR (default out/peers) and are not repeated if their input and the machine are the
same. Each code is compared with its own finest result and with that of the other code. Prints Markdown.
"""
import importlib
from pathlib import Path

import calculix_contact
from benchmarks import calculix
from ricochet import errors

# Modules of peers/ with TITLE, run(folder, cache, figure) and, unless CalculiX is the peer, need().
COMPARISONS = ("oblique", "plate", "bracket", "disks", "boxes", "stress")


def add_arguments(parser):
    parser.add_argument("name", nargs="*", help=f"comparisons: {', '.join(COMPARISONS)} (default: all)")
    parser.add_argument("--out", type=Path, default=Path("out/peers"), metavar="DIR", help="of all files")
    parser.add_argument("--figures", type=Path, metavar="DIR", help="draws peers-NAME.png in it")


def run(options):
    if unknown := [name for name in options.name if name not in COMPARISONS]:
        raise errors.InputError(f"{unknown[0]}: no such comparison: {', '.join(COMPARISONS)}")
    comparisons = {name: importlib.import_module(f"peers.{name}") for name in options.name or COMPARISONS}
    for comparison in comparisons.values():
        getattr(comparison, "need", calculix_contact.need)()
    options.out.mkdir(parents=True, exist_ok=True)
    cache = calculix.Cache(options.out / "calculix.json")
    for name, comparison in comparisons.items():
        print(f"## {comparison.TITLE}\n")
        folder = (options.out / name).resolve()
        folder.mkdir(exist_ok=True)
        comparison.run(folder, cache, options.figures and options.figures / f"peers-{name}.png")
    return 0
