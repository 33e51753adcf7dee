# SPDX-License-Identifier: BSD-2-Clause
"""Makes body files, which a scene names as a mesh, from stiffness and mass of another finite element program.

  ricochet import calculix JOB.inp                  # with JOB.sti, JOB.mas, JOB.dof of *FREQUENCY, SOLVER=MATRIXSTORAGE
  ricochet import matrices K.mtx M.mtx NODES.txt --surface top=TOP.txt --support foot=FOOT.txt

Layouts and examples: docs/interchange.md.
"""

import argparse
import sys
import warnings
from pathlib import Path

import numpy as np

from ricochet.interchange import calculix as calculix_model
from ricochet.interchange.body_file import Refused, clockwise, is_name, read_matrix_market, write_body
from ricochet.cli.command_line import Parser

FACETS = (3, 4, 6, 9, 10, 16)


def positive(text):
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError("must be positive")
    return value


def named(text):
    name, equals, path = text.partition("=")
    if not (equals and path) or not is_name(name):
        raise argparse.ArgumentTypeError(f"{text!a}: must be NAME=FILE, the name without \"/\"")
    return name, path


def options():
    parser = Parser(__doc__, "{calculix|matrices} FILE...")
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument("--out", metavar="BODY.h5", help="default: beside the first file, with the suffix .h5")
    common.add_argument("--length-unit", type=positive, default=1, metavar="M", help="of the input, in metres (0.001: mm)")
    common.add_argument("--mass-unit", type=positive, default=1, metavar="KG", help="of the input, in kg (1000: tonnes)")
    commands = parser.add_subparsers(dest="command", required=True, prog=parser.prog, parser_class=argparse.ArgumentParser)
    calculix = commands.add_parser("calculix", parents=[common], help="a job of CalculiX whose matrices ccx has stored")
    calculix.add_argument("job", metavar="JOB.inp")
    matrices = commands.add_parser("matrices", parents=[common], help="MatrixMarket files and lists")
    matrices.add_argument("stiffness", metavar="K.mtx")
    matrices.add_argument("mass", metavar="M.mtx")
    matrices.add_argument("nodes", metavar="NODES.txt", help="a row for each node: x y z")
    matrices.add_argument("--surface", type=named, action="append", default=[], metavar="NAME=FILE",
                          help="a row for each facet: its nodes, numbered from 1, counter-clockwise from outside; repeatable")
    matrices.add_argument("--support", type=named, action="append", default=[], dest="supports", metavar="NAME=FILE",
                          help="nodes that a support may hold, numbered from 1; repeatable")
    return parser.parse_args()


def table(path, rows):
    """`rows` says what a row is."""
    try:
        with open(path) as file, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of lists that are empty
            numbers = np.loadtxt(file, ndmin=2)
    except ValueError as error:
        raise Refused(f"{path}: {' '.join(str(error).split()).rstrip('.')}: each row must be {rows}") from None
    if not numbers.size:
        raise Refused(f"{path}: is empty: each row must be {rows}")
    if wrong := np.flatnonzero(~np.isfinite(numbers).all(axis=1)).tolist():
        raise Refused(f"{path}: row {wrong[0] + 1} has a number that is not finite")
    return numbers


def numbers_from_zero(path, nodes, rows):
    numbers = table(path, rows)
    wrong = numbers[(numbers < 1) | (numbers > nodes) | (numbers % 1 != 0)]
    if wrong.size:
        raise Refused(f"{path}: names node {wrong[0]:.17g}: nodes are numbered 1 to {nodes}")
    return numbers.astype(np.int64) - 1


def of_matrices(given):
    node = table(given.nodes, "x y z of a node")
    if node.shape[1] != 3:
        raise Refused(f"{given.nodes}: has {node.shape[1]} columns: give x y z of each node")
    matrices = {}
    for name in ("stiffness", "mass"):
        path = getattr(given, name)
        *matrices[name], shape = read_matrix_market(path)
        if shape != (3 * len(node), 3 * len(node)):
            raise Refused(f"{path}: is {shape[0]} x {shape[1]}: {len(node)} nodes have {3 * len(node)} displacements")
    surfaces, read = {}, []
    for name, path in given.surface:
        facets = numbers_from_zero(path, len(node), "the nodes of a facet, numbered from 1")
        if facets.shape[1] not in FACETS:
            raise Refused(f"{path}: has facets of {facets.shape[1]} nodes: read are {', '.join(map(str, FACETS))}")
        same = surfaces.setdefault(name, {})
        same[facets.shape[1]] = np.vstack([*([same[facets.shape[1]]] if facets.shape[1] in same else []), facets])
        read.append((path, facets))
    supports = {}
    for name, path in given.supports:
        supports[name] = np.union1d(supports.get(name, []), numbers_from_zero(path, len(node), "nodes, numbered from 1"))
    for path, facets in read:
        wrong = clockwise(node, facets, *matrices["stiffness"][:2])
        if wrong:
            warn(f"{path}: {wrong} of {len(facets)} facets run clockwise seen from outside, and what they face will not be found. "
                 "Reverse the order of their nodes")
    return node, {name: list(blocks.values()) for name, blocks in surfaces.items()}, matrices, supports, None


def of_calculix(given):
    model = calculix_model.Model(given.job)
    skin = model.blocks(model.skin())
    triangles = [facets[:, corners] for facets in skin
                 for corners in ([[0, 1, 2]] if facets.shape[1] in (3, 6) else [[0, 1, 2], [0, 2, 3]])]
    return (model.nodes(), {"skin": skin} | model.surfaces(), model.matrices(), model.supports(),
            np.concatenate(triangles))


def what_failed(error):
    """In one line, of an OSError of an input."""
    if isinstance(error, FileNotFoundError):
        return f"{error.filename}: there is no such file. Name one that is there"
    return f"{error.filename}: can't be read: {error.strerror}. Name another file"


def warn(what):
    print(f"import: warning: {what}", file=sys.stderr)


def inputs(given):
    """The first is the one that names the body file."""
    if given.command == "calculix":
        job = Path(given.job)
        return [job, *(job.parent / f"{job.stem}{suffix}" for suffix in (".sti", ".mas", ".dof"))]
    return [Path(path) for path in (given.stiffness, given.mass, given.nodes, *(path for _, path in given.surface + given.supports))]


def place_of(given):
    """Of the body file."""
    sources = inputs(given)
    out = Path(given.out) if given.out else sources[0].parent / f"{sources[0].stem}.h5"
    if out.exists() and any(source.exists() and source.samefile(out) for source in sources):
        raise Refused(f"{out}: is one of the inputs: choose another --out")
    return out


def main():
    given = options()
    try:
        out = place_of(given)
        node, surfaces, matrices, supports, skin = (of_calculix if given.command == "calculix" else of_matrices)(given)
        with np.errstate(over="ignore"):
            node = node * given.length_unit
            matrices = {name: (i, j, value * given.mass_unit) for name, (i, j, value) in matrices.items()}
        if not all(np.isfinite(values).all() for values in (node, *(value for _, _, value in matrices.values()))):
            raise Refused("--length-unit, --mass-unit: make numbers that are not finite")
        try:
            write_body(out, node, surfaces, matrices, supports, skin)
        except OSError as error:
            raise Refused(f"{out}: cannot be written ({error.strerror}). Choose another --out.") from None
    except (Refused, OSError) as refusal:
        why = what_failed(refusal) if isinstance(refusal, OSError) else str(refusal)
        print(f"import: {' '.join(why.split())}", file=sys.stderr)
        return 2
    if not surfaces:
        warn("no surface: the body can never touch another. Give --surface NAME=FILE")
    print(f"{out}: {len(node)} nodes; surfaces {', '.join(surfaces) or 'none'}"
          + (f"; nodes {', '.join(supports)}" if supports else ""))
    held = 3 * len(node) - np.unique(matrices["stiffness"][0]).size
    if held:
        print(f"{held} displacements have no row: they are held, and their share of the mass is missing")
    return 0
