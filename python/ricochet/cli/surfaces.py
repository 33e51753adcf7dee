# SPDX-License-Identifier: BSD-2-Clause
"""Tells the surfaces of a drawing or mesh apart: number, physical groups, area and extent of each, and a picture of them all.

    ricochet surfaces meshes/bell/bell.step [--out DIR]

Takes what gmsh reads: .step, .brep, .geo, .msh. Lengths are those of the file. The picture is <drawing>-surfaces.png beside the
drawing, or in the working folder where that one can't be written; its path is printed last.
"""
import os
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

try:
    import gmsh
except ImportError:
    sys.exit("surfaces: needs the Debian package python3-gmsh: run scripts/setup")

from ricochet.cli.command_line import Parser
from ricochet.files import save_picture

TRIANGLE = 2


def triangles(surface):
    """(T,3,3) corners of a coarse mesh of the surface."""
    tags, xyz, _ = gmsh.model.mesh.getNodes(2, surface, includeBoundary=True)
    place = dict(zip(tags, xyz.reshape(-1, 3)))
    corners = [gmsh.model.mesh.getElementsByType(kind, surface)[1].reshape(-1, count)[:, corner]
               for kind, count, corner in all_kinds(surface)]
    return np.array([[place[tag] for tag in element] for element in np.concatenate(corners)]) if corners else np.empty((0, 3, 3))


def all_kinds(surface):
    """Element type, nodes of an element, and the corners of the triangles that it is drawn as."""
    for kind in gmsh.model.mesh.getElements(2, surface)[0]:
        name, _, _, nodes, _, corners = gmsh.model.mesh.getElementProperties(kind)
        for corner in [[0, 1, 2]] if corners == 3 else [[0, 1, 2], [0, 2, 3]]:
            yield kind, nodes, corner


def groups():
    """Names of physical groups by surface."""
    found = {}
    for dim, tag in gmsh.model.getPhysicalGroups(2):
        for surface in gmsh.model.getEntitiesForPhysicalGroup(dim, tag):
            found.setdefault(surface, []).append(gmsh.model.getPhysicalName(dim, tag) or str(tag))
    return found


def read(path):
    """Corners of triangles by surface."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(str(path))
    if not gmsh.model.mesh.getElements(2)[0].size:
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 24)  # round enough for the eye, whatever its own mesh will be
        gmsh.model.mesh.generate(2)
    return {tag: triangles(tag) for _, tag in gmsh.model.getEntities(2)}


def table(surfaces, named):
    def row(numbers):
        return "[" + ", ".join(f"{x:.4g}" for x in numbers) + "]"

    rows = []
    for tag, corners in surfaces.items():
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
        points = np.round(corners.reshape(-1, 3), 9) + 0.0
        rows.append((str(tag), ", ".join(named.get(tag, [])) or "–", f"{area:.4g}", row(points.min(axis=0)), row(points.max(axis=0))))
    titles = ("surface", "groups", "area", "from [x, y, z]", "to [x, y, z]")
    widths = [max(len(line[k]) for line in [titles, *rows]) for k in range(len(titles))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in [titles, *rows])


def picture(surfaces, path, title):
    """From above and from below, each surface in a colour of its own, lighter where it faces up."""
    corners = np.concatenate(list(surfaces.values()))
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    up = abs(normal @ [0.3, -0.5, 0.8]) / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    colours = {tag: np.array(plt.cm.tab20(n % 20)[:3]) for n, tag in enumerate(surfaces)}
    colour = np.concatenate([np.tile(colours[tag], (len(of), 1)) for tag, of in surfaces.items()]) * (0.5 + 0.5 * up[:, None])
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    middle, half = (low + high) / 2, np.ptp([low, high], axis=0).max() / 2
    figure = plt.figure(figsize=(10, 5.5))
    for k, height in enumerate((25, -35)):
        ax = figure.add_subplot(1, 2, k + 1, projection="3d", elev=height, azim=-60)
        ax.add_collection3d(Poly3DCollection(corners, facecolors=colour, edgecolors=colour, linewidths=0.3))
        for axis, m in zip("xyz", middle):
            ax.set(**{f"{axis}lim": (m - half, m + half), f"{axis}label": axis})
        ax.set_title(f"{title} from {'above' if height > 0 else 'below'}", loc="left")
    handles = [plt.Line2D([], [], marker="s", linestyle="", color=colours[tag], label=str(tag)) for tag in surfaces]
    figure.subplots_adjust(left=0, right=0.95, bottom=0.16, top=0.93, wspace=0.05)
    figure.legend(handles=handles, loc="lower center", ncol=min(len(handles), 16), title="surface")
    save_picture(figure, path, dpi=110)


def main():
    parser = Parser(__doc__, "DRAWING")
    parser.add_argument("drawing", type=Path)
    parser.add_argument("--out", type=Path, help="folder of the picture (default: beside the drawing)")
    options = parser.parse_args()
    try:
        if not options.drawing.is_file():
            raise ValueError("there is no such file: name a .step, .brep, .geo or .msh")
        surfaces = read(options.drawing)
        if not any(len(corners) for corners in surfaces.values()):
            raise ValueError("has no surfaces: name a drawing or mesh of a solid")
    except Exception as problem:  # gmsh throws these themselves
        print(f"surfaces: {options.drawing}: {' '.join(str(problem).split())}", file=sys.stderr)
        return 2
    print(table(surfaces, groups()))
    beside = options.drawing.parent
    folder = options.out or (beside if os.access(beside, os.W_OK) else Path("."))
    path = folder / f"{options.drawing.name}-surfaces.png"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        picture(surfaces, path, options.drawing.name)
    except OSError as error:
        print(f"surfaces: {path}: cannot be written ({error.strerror}). Choose another --out.", file=sys.stderr)
        return 2
    print(path)
    return 0
