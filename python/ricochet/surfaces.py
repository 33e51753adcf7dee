# SPDX-License-Identifier: BSD-2-Clause
"""The surfaces of a drawing or mesh that gmsh can read: triangles, groups, a table and a picture."""
import multiprocessing
import os
import signal
import tempfile
from collections.abc import Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray

from ricochet.errors import InputError
from ricochet.files import save_picture

try:
    import gmsh
except ImportError:
    gmsh = None

Triangles = dict[int, NDArray[np.float64]]  # (T,3,3) corners, by number of the surface


def kinds(surface: int) -> Iterator[tuple[int, int, list[int]]]:
    """Yields the element type, the number of nodes of an element, and the corners of the triangles that
    represent it."""
    for kind in gmsh.model.mesh.getElements(2, surface)[0]:
        _, _, _, nodes, _, corners = gmsh.model.mesh.getElementProperties(kind)
        for corner in [[0, 1, 2]] if corners == 3 else [[0, 1, 2], [0, 2, 3]]:
            yield kind, nodes, corner


def triangles(surface: int) -> NDArray[np.float64]:
    """(T,3,3) corners of the triangles on a surface."""
    corners = []
    for kind, count, corner in kinds(surface):
        # A mesh of another program may have the nodes of a surface as nodes of the volume.
        _, xyz, _ = gmsh.model.mesh.getNodesByElementType(kind, surface, returnParametricCoord=False)
        corners.append(xyz.reshape(-1, count, 3)[:, corner])
    return np.concatenate(corners) if corners else np.empty((0, 3, 3))


def groups() -> dict[int, list[str]]:
    """Names of physical groups by surface."""
    found: dict[int, list[str]] = {}
    for dim, tag in gmsh.model.getPhysicalGroups(2):
        for surface in gmsh.model.getEntitiesForPhysicalGroup(dim, tag):
            found.setdefault(surface, []).append(gmsh.model.getPhysicalName(dim, tag) or str(tag))
    return found


def read_here(path: Path) -> tuple[Triangles, dict[int, list[str]]]:
    """`read` in this process. Raises whatever gmsh raises."""
    gmsh.initialize()
    gmsh.open(str(path))
    if not gmsh.model.mesh.getElements(2)[0].size:
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 24)  # fine enough for a picture
        gmsh.model.mesh.generate(2)
    return {tag: triangles(tag) for _, tag in gmsh.model.getEntities(2)}, groups()


def answer(path: Path, to: Connection, log: int) -> None:
    """Sends what `read_here` returns, or the message of its error. What gmsh prints goes to `log`."""
    os.dup2(log, 1), os.dup2(log, 2)
    try:
        to.send(read_here(path))
    except Exception as problem:  # gmsh raises Exception itself
        to.send(" ".join(str(problem).split()))
    to.close()
    os._exit(0)  # gmsh crashes when it deletes some models


def read(path: Path, seconds: float = 600) -> tuple[Triangles, dict[int, list[str]]]:
    """Reads triangles and names of groups, by surface. A drawing is meshed coarsely. gmsh runs in a process of
    its own, which may crash, end or take too long. Raises InputError."""
    if gmsh is None:
        raise InputError("needs the Debian package python3-gmsh: run scripts/setup")
    if not path.is_file():
        raise InputError(f"{path}: there is no such file: name a .step, .brep, .geo or .msh")
    context = multiprocessing.get_context("fork")
    with tempfile.TemporaryFile() as log:
        mine, its = context.Pipe(duplex=False)
        process = context.Process(target=answer, args=(path, its, log.fileno()), daemon=True)
        process.start()
        its.close()
        late = not mine.poll(seconds)
        if late:
            process.kill()
        try:
            found = mine.recv()
        except EOFError:
            found = None
        process.join()
        log.seek(0)
        lines = log.read().decode(errors="replace").split("\n")
    if isinstance(found, str):
        raise InputError(f"{path}: {found}")
    if found is None:
        ended = f"took more than {seconds:g} s" if late else "ended"
        if not late and process.exitcode and process.exitcode < 0:
            ended = f"crashed ({signal.Signals(-process.exitcode).name})"
        said = [line for line in lines if line.startswith("Error")] or [
            line for line in lines if line.strip()
        ]
        last = f"; its last message: {' '.join(said[-1].split())}" if said else ""
        raise InputError(f"{path}: gmsh {ended} before it had read the surfaces{last}: repair the drawing")
    surfaces, named = found
    if not any(len(corners) for corners in surfaces.values()):
        raise InputError(f"{path}: has no surfaces: name a drawing or mesh of a solid")
    return surfaces, named


def table(surfaces: Triangles, named: dict[int, list[str]]) -> str:
    """A line for each surface: number, groups, area and extent."""

    def row(numbers: NDArray[np.float64]) -> str:
        return "[" + ", ".join(f"{x:.4g}" for x in numbers) + "]"

    rows: list[tuple[str, ...]] = [("surface", "groups", "area", "from [x, y, z]", "to [x, y, z]")]
    for tag, corners in surfaces.items():
        area = np.linalg.norm(normals(corners), axis=1).sum() / 2
        points = np.round(corners.reshape(-1, 3), 9) + 0.0
        names = ", ".join(named.get(tag, [])) or "–"
        rows.append((str(tag), names, f"{area:.4g}", row(points.min(axis=0)), row(points.max(axis=0))))
    widths = [max(map(len, column)) for column in zip(*rows)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(line, widths)) for line in rows)
    return "\n".join(line.rstrip() for line in lines)


def normals(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """(T,3) normals of triangles. Their length is twice the area."""
    found: NDArray[np.float64] = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return found


def picture(surfaces: Triangles, path: Path, title: str) -> None:
    """Draws the surfaces from above and from below, each in its own colour, lighter where they face up.
    Raises OSError."""
    corners = np.concatenate(list(surfaces.values()))
    normal = normals(corners)
    up = abs(normal @ [0.3, -0.5, 0.8]) / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    palette = matplotlib.colormaps["tab20"]
    colours = {tag: np.array(palette(n % 20)[:3]) for n, tag in enumerate(surfaces)}
    colour: Any = np.concatenate([np.tile(colours[tag], (len(of), 1)) for tag, of in surfaces.items()])
    colour = colour * (0.5 + 0.5 * up[:, None])
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    middle, half = (low + high) / 2, np.ptp([low, high], axis=0).max() / 2
    figure = Figure(figsize=(10, 5.5))
    for k, height in enumerate((25, -35)):
        ax = figure.add_subplot(1, 2, k + 1, projection="3d", elev=height, azim=-60)
        ax.add_collection3d(Poly3DCollection(corners, facecolors=colour, edgecolors=colour, linewidths=0.3))
        for axis, m in zip("xyz", middle):
            ax.set(**{f"{axis}lim": (m - half, m + half), f"{axis}label": axis})
        ax.set_title(f"{title} from {'above' if height > 0 else 'below'}", loc="left")
    handles = [
        Line2D([], [], marker="s", linestyle="", color=colours[tag], label=str(tag)) for tag in surfaces
    ]
    figure.subplots_adjust(left=0, right=0.95, bottom=0.16, top=0.93, wspace=0.05)
    figure.legend(handles=handles, loc="lower center", ncol=min(len(handles), 16), title="surface")
    save_picture(figure, path, dpi=110)
