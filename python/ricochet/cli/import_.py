# SPDX-License-Identifier: BSD-2-Clause
"""Writes a body file from the stiffness and mass matrices of another finite element program. A scene names this file as a mesh.

  ricochet import calculix JOB.inp                  # with JOB.sti, JOB.mas, JOB.dof of *FREQUENCY, SOLVER=MATRIXSTORAGE
  ricochet import matrices K.mtx M.mtx NODES.txt --surface top=TOP.txt --support foot=FOOT.txt

docs/interchange.md describes the layouts and has examples.
"""
import argparse
import sys
from pathlib import Path

import numpy as np

from ricochet import files
from ricochet.cli.options import add_out, positive
from ricochet.errors import InputError
from ricochet.interchange import calculix, matrices
from ricochet.interchange.body import Body, is_name


def named(text: str) -> tuple[str, Path]:
    name, equals, path = text.partition("=")
    if not (equals and path) or not is_name(name):
        raise argparse.ArgumentTypeError(f'{text!a}: must be NAME=FILE, the name without "/"')
    return name, Path(path)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    common = argparse.ArgumentParser(add_help=False)
    add_out(common, "the body file", "the first file with the suffix .h5", "BODY.h5")
    for option, metavar, text in (
        ("--length-unit", "M", "unit of length of the input, in metres (0.001: mm)"),
        ("--mass-unit", "KG", "unit of mass of the input, in kg (1000: tonnes)"),
    ):
        common.add_argument(option, type=positive, default=1, metavar=metavar, help=text)
    sources = parser.add_subparsers(title="sources", metavar="SOURCE", dest="source", required=True)
    purpose = "a job of CalculiX whose matrices ccx has stored"
    job = sources.add_parser("calculix", parents=[common], help=purpose, description=f"Imports {purpose}.")
    job.add_argument("job", type=Path, metavar="JOB.inp")
    purpose = "MatrixMarket files and lists"
    lists = sources.add_parser("matrices", parents=[common], help=purpose, description=f"Imports {purpose}.")
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
    except FileNotFoundError as error:
        raise InputError(f"{error.filename}: there is no such file. Name an existing one") from None
    except OSError as error:
        raise InputError(f"{error.filename}: can't be read: {error.strerror}. Name another file") from None


def run(options: argparse.Namespace) -> None:
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
