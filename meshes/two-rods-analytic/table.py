#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Writes the kernel of two equal free rods that meet end to end, in closed form, as a table.

    meshes/two-rods-analytic/table.py                 # out/rods.table.h5, for two-rods-analytic.toml
    meshes/two-rods-analytic/table.py --gap 0 --duration 60 other.h5

A wave of impedance Z = ρcA leaves the end that is struck and is back, doubled, after each T = 2L/c. So a unit impulse
moves that end by

    N(t) = [ Y(t) + 2 Σ_{k≥1} Y(t − kT) ] / Z,       Y the unit step

on average by t/(ρAL), the rigid motion. Both ends of a contact together have twice that. docs/formats/responses.md states
what the samples of a kernel that jumps are.
"""
import argparse
from pathlib import Path

import h5py
import numpy as np

parser = argparse.ArgumentParser(description="Writes the closed-form kernel of two equal rods as a table.")
parser.add_argument("file", nargs="?", type=Path, default=Path(__file__).parent / "out" / "rods.table.h5")
parser.add_argument("--density", type=float, default=1.0, help="kg/m³")
parser.add_argument("--young", type=float, default=1.0, help="Pa")
parser.add_argument("--area", type=float, default=1.0, help="m²")
parser.add_argument("--length", type=float, default=10.0, help="m")
parser.add_argument("--gap", type=float, default=1.0, help="m")
parser.add_argument("--speed", type=float, default=1.0, help="m/s, of the rod that moves")
parser.add_argument("--rate", type=float, default=100.0, help="Hz")
parser.add_argument("--duration", type=float, default=30.0, help="s")
o = parser.parse_args()

speed_of_sound = np.sqrt(o.young / o.density)
impedance = o.density * speed_of_sound * o.area
around = 2 * o.length / speed_of_sound * o.rate  # steps in T
steps = round(o.duration * o.rate)


def displacement(l):
    """Of both ends, just before the instant l; 1e-9 of a step is round-off of where the jump is."""
    returns = np.ceil(l / around - 1e-9) - 1
    return np.where(l > 0, 2 / impedance * (1 + 2 * returns), 0.0)


def primitive(l):
    """∫ N dt / Δ from 0 to the instant l."""
    returns = np.maximum(np.ceil(l / around - 1e-9) - 1, 0)
    return 2 / impedance * (l + 2 * (returns * l - around * returns * (returns + 1) / 2))


def put(name, values, unit=None):
    """Writes a dataset with a checksum: few values into its header, which has one, many into chunks."""
    values = np.asarray(values)
    header = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    header.set_layout(h5py.h5d.COMPACT)
    few = values.nbytes <= 8192
    dataset = f.create_dataset(name, data=values, **({"dcpl": header} if few else {"fletcher32": True}))
    if unit:
        dataset.attrs["unit"] = np.bytes_(unit)


l = np.arange(steps + 1)
N, after = displacement(l), displacement(l + 1)
mass = o.density * o.area * o.length
o.file.parent.mkdir(parents=True, exist_ok=True)
with h5py.File(o.file, "w", libver=("v110", "v110")) as f:
    f.attrs["format"], f.attrs["version"] = np.bytes_("ricochet-table"), 1
    for name, value, unit in [
        ("displacement", N, "m/(N s)"),
        ("velocity", (after - N) * o.rate, "1/kg"),
        ("flexibility", (primitive(l + 1) - primitive(l)) / o.rate, "m/N"),
    ]:
        put(f"table/{name}", value.reshape(-1, 1, 1), unit)
    put("table/step", 1 / o.rate)
    put("table/gap", [o.gap])
    put("table/area", [o.area])
    put("bodies/name", np.array([b"moving", b"resting"]))
    put("bodies/mass", [mass, mass])
    put("bodies/velocity", [[o.speed, 0.0, 0.0], [0.0, 0.0, 0.0]])
    put("bodies/gravity", np.zeros((2, 3)))
    put("bodies/push", [[[-1.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]]])
print(o.file)
