# SPDX-License-Identifier: BSD-2-Clause
"""Writes the mesh of another program as a .msh, or its stiffness and mass matrices as a body file. A scene names either as a mesh.

  ricochet import mesh PART.inp                     # or .bdf, .med, .vtu, …: writes PART.msh; for .inp and .bdf also PART.toml
  ricochet import calculix JOB.inp                  # with JOB.sti, JOB.mas, JOB.dof of *FREQUENCY, SOLVER=MATRIXSTORAGE
  ricochet import matrices K.mtx M.mtx NODES.txt --surface top=TOP.txt --support foot=FOOT.txt

docs/meshes.md describes meshes of other programs; docs/interchange.md describes body files and has examples.
"""
import argparse
import sys
from pathlib import Path

import numpy as np

from ricochet import files
from ricochet.cli.options import add_out, positive
from ricochet.errors import InputError
from ricochet.interchange import calculix, draft, foreign, matrices
from ricochet.interchange.body import Body, is_name


SHOWN = 20  # of the groups of a mesh


def named(text: str) -> tuple[str, Path]:
    name, equals, path = text.partition("=")
    if not (equals and path) or not is_name(name):
        raise argparse.ArgumentTypeError(f'{text!a}: must be NAME=FILE, the name without "/"')
    return name, Path(path)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    units, common = argparse.ArgumentParser(add_help=False), argparse.ArgumentParser(add_help=False)
    add_out(common, "the body file", "the first file with the suffix .h5", "BODY.h5")
    for option, metavar, text in (
        ("--length-unit", "M", "unit of length of the input, in metres (0.001: mm)"),
        ("--mass-unit", "KG", "unit of mass of the input, in kg (1000: tonnes)"),
    ):
        units.add_argument(option, type=positive, default=1, metavar=metavar, help=text)
    sources = parser.add_subparsers(title="sources", metavar="SOURCE", dest="source", required=True)
    purpose = "a mesh of another program, with its groups"
    mesh = sources.add_parser("mesh", parents=[units], help=purpose, description=f"Imports {purpose}.")
    mesh.add_argument("file", type=Path, metavar="FILE")
    add_out(mesh, "the mesh file", "FILE with the suffix .msh", "MESH.msh")
    mesh.add_argument(
        "--scene",
        type=Path,
        metavar="DRAFT.toml",
        help="draft of a scene with materials and supports of a .inp or .bdf (default: FILE with the suffix .toml, "
        "unless that file exists)",
    )
    mesh.add_argument(
        "--brief",
        action="store_true",
        help="for ricochet-kernel: print size, materials and warnings, one on a line each, and write no draft",
    )
    purpose = "a job of CalculiX whose matrices ccx has stored"
    job = sources.add_parser(
        "calculix", parents=[common, units], help=purpose, description=f"Imports {purpose}."
    )
    job.add_argument("job", type=Path, metavar="JOB.inp")
    purpose = "MatrixMarket files and lists"
    lists = sources.add_parser(
        "matrices", parents=[common, units], help=purpose, description=f"Imports {purpose}."
    )
    lists.add_argument("stiffness", type=Path, metavar="K.mtx")
    lists.add_argument("mass", type=Path, metavar="M.mtx")
    lists.add_argument("nodes", type=Path, metavar="NODES.txt", help="a row for each node: x y z")
    lists.add_argument(
        "--surface",
        type=named,
        action="append",
        default=[],
        metavar="NAME=FILE",
        help="a row for each facet: its nodes, numbered from 1, counter-clockwise seen from outside; repeatable",
    )
    lists.add_argument(
        "--support",
        type=named,
        action="append",
        default=[],
        dest="supports",
        metavar="NAME=FILE",
        help="nodes that a support may hold, numbered from 1; repeatable",
    )


def inputs(options: argparse.Namespace) -> list[Path]:
    """All files to read. The first one determines the name of the body file."""
    if options.source == "calculix":
        return [options.job, *(options.job.with_suffix(suffix) for suffix in (".sti", ".mas", ".dof"))]
    lists = [path for _, path in options.surface + options.supports]
    return [options.stiffness, options.mass, options.nodes, *lists]


def output(options: argparse.Namespace) -> Path:
    sources = inputs(options)
    out: Path = options.out or sources[0].parent / f"{sources[0].stem}.h5"
    if out.exists() and any(source.exists() and source.samefile(out) for source in sources):
        raise InputError(f"{out}: is one of the inputs: choose another --out")
    return out


def read(options: argparse.Namespace) -> Body:
    try:
        if options.source == "calculix":
            return calculix.read(options.job)
        return matrices.read(
            options.stiffness, options.mass, options.nodes, options.surface, options.supports
        )
    except OSError as error:
        raise unreadable(error) from None


def import_mesh(options: argparse.Namespace) -> None:
    source: Path = options.file
    out: Path = options.out or source.with_suffix(".msh")
    if out.suffix != ".msh":
        raise InputError(f"{out}: must end in .msh, by which a scene knows its kind: choose another --out")
    try:
        found = foreign.read(source, options.length_unit, options.mass_unit)
    except OSError as error:
        raise unreadable(error) from None
    with files.writing(out, "--out"):
        found.write(out)
    mesh, groups = found.mesh, found.groups
    size = f"{len(mesh.node)} nodes, {len(mesh.solid_number)} elements"
    if options.brief:
        materials = found.offer.materials if found.offer else {}
        print(f"size: {size}")
        print(*(f"material: {material.in_words()}" for material in materials.values()), sep="\n")
        print(*(f"warning: {warning}" for warning in mesh.warnings), sep="\n")
        return
    for warning in mesh.warnings:
        print(f"ricochet import: warning: {warning}", file=sys.stderr)
    print(f"{out}: {size}")
    for kind, names in (("volumes", groups.solids), ("faces", groups.faces), ("points", groups.points)):
        print(f"groups of {kind}: {listed(list(names))}")
    if found.offer:
        write_draft(options, out, found, found.offer)


def listed(names: list[str]) -> str:
    shown = names if len(names) <= SHOWN else [*names[: SHOWN - 1], f"… ({len(names)} in all)"]
    return ", ".join(shown) or "none"


def write_draft(options: argparse.Namespace, mesh: Path, found: foreign.Import, offer: draft.Offer) -> None:
    path: Path = options.scene or mesh.with_suffix(".toml")
    if path.exists() and not options.scene:
        print(f"{path}: exists and is left as it is; --scene FILE writes the draft to another one")
        return
    text = draft.scene(mesh, path, options.file, offer, found.groups, found.names)
    with files.writing(path, "--scene"):
        files.write(path, text.encode())
    print(f"{path}: draft of a scene with the materials and supports of {options.file.name}")


def unreadable(error: OSError) -> InputError:
    if isinstance(error, FileNotFoundError):
        return InputError(f"{error.filename}: there is no such file. Name an existing one")
    return InputError(f"{error.filename}: can't be read: {error.strerror}. Name another file")


def run(options: argparse.Namespace) -> None:
    if options.source == "mesh":
        return import_mesh(options)
    out = output(options)
    body = read(options)
    body.in_units(options.length_unit, options.mass_unit)
    with files.writing(out, "--out"):
        body.write(out)
    if not body.surfaces:
        body.warnings.append("no surface: the body can never touch another. Give --surface NAME=FILE")
    for warning in body.warnings:
        print(f"ricochet import: warning: {warning}", file=sys.stderr)
    supports = f"; nodes {', '.join(body.supports)}" if body.supports else ""
    print(f"{out}: {len(body.node)} nodes; surfaces {', '.join(body.surfaces) or 'none'}{supports}")
    if empty := 3 * len(body.node) - np.unique(body.matrices["stiffness"][0]).size:
        print(f"{empty} displacements have no row: they are fixed, and their share of the mass is missing")
