# SPDX-License-Identifier: BSD-2-Clause
"""Lists the surfaces of a drawing or mesh with number, groups, kind, area and extent, and draws them.

    ricochet surfaces meshes/bell/bell.step

Reads the formats of gmsh: .step, .brep, .geo, .msh. Lengths are in the units of the file; areas and extents are those of the drawing,
not of a mesh. The picture <drawing>-surfaces.png is written beside the drawing, or in the working folder if the folder of the drawing
cannot be written. Its path is printed last.
"""
import argparse
import os
from pathlib import Path

from ricochet import file_kinds, files
from ricochet.cli.options import add_out


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("drawing", type=file_kinds.drawing, metavar="DRAWING")
    add_out(parser, "folder of the picture", "beside the drawing")


def run(options: argparse.Namespace) -> None:
    from ricochet import surfaces  # takes a second, and refusals of a wrong file come before
    from ricochet.pictures.surfaces import save_surfaces

    drawing: Path = options.drawing
    found = surfaces.read(drawing)
    print(surfaces.table(found))
    beside = drawing.parent
    folder = options.out or (beside if os.access(beside, os.W_OK) else Path("."))
    path = folder / f"{drawing.name}-surfaces.png"
    with files.writing(path, "--out"):
        folder.mkdir(parents=True, exist_ok=True)
        save_surfaces(found, path, drawing.name)
    print(path)
