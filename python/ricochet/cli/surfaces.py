# SPDX-License-Identifier: BSD-2-Clause
"""Lists the surfaces of a drawing or mesh with number, groups, kind, area and extent, and shows them on a page.

    ricochet surfaces meshes/bell/bell.step

Reads the formats of gmsh: .step, .brep, .geo, .msh. The table has the units of the file; areas and extents are those of the drawing,
not of a mesh. The page <drawing>-surfaces.html and the picture <drawing>-surfaces.png are written beside the drawing, or in the
working folder if the folder of the drawing cannot be written. Their paths are printed last. On the page, surfaces have their numbers
and are picked for the line that a scene needs. From a terminal with a display, a browser opens it.
"""
import argparse
import os
from pathlib import Path

from ricochet import file_kinds, files
from ricochet.cli.options import add_open, add_out, open_page, positive

MILLIMETRES = (".step", ".stp", ".iges", ".igs")  # OpenCASCADE converts these to millimetres


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("drawing", type=file_kinds.drawing, metavar="DRAWING")
    parser.add_argument(
        "--scale",
        type=positive,
        metavar="X",
        help="metres per unit of the drawing, as scale in the scene (default: 0.001 for .step and .iges, otherwise 1)",
    )
    add_out(parser, "folder of page and picture", "beside the drawing")
    add_open(parser)


def folder_of(options: argparse.Namespace) -> Path:
    beside: Path = options.drawing.parent
    return options.out or (beside if os.access(beside, os.W_OK) else Path("."))


def run(options: argparse.Namespace) -> None:
    from ricochet import surfaces  # takes a second, and refusals of a wrong file come before
    from ricochet.pages.surfaces import write_surfaces_page
    from ricochet.pictures.surfaces import save_surfaces

    drawing: Path = options.drawing
    found = surfaces.read(drawing)
    print(surfaces.table(found))
    millimetres = drawing.suffix.lower() in MILLIMETRES
    scale = options.scale or (1e-3 if millimetres else 1.0)
    value = f"scale = {scale:g}" if options.scale or millimetres else "scale"
    print(f"lengths in units of the drawing: {value} of the body in a scene makes them metres")
    folder = folder_of(options)
    picture, page = (folder / f"{drawing.name}-surfaces{ending}" for ending in (".png", ".html"))
    with files.writing(picture, "--out"):
        folder.mkdir(parents=True, exist_ok=True)
        save_surfaces(found, picture, drawing.name)
    write_surfaces_page(found, drawing.name, scale, page)
    print(picture, page, sep="\n")
    open_page(page, options.open)
