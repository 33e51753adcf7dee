# SPDX-License-Identifier: BSD-2-Clause
"""The picture of mode shapes on the visualisation surface of a kernel."""
import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from ricochet.arrays import Floats
from ricochet.errors import InputError
from ricochet.pictures.style import BODY, WIDTH, fit, normals
from ricochet.pictures.viewpoint import clearest
from ricochet.result_file import File

AMPLITUDE = 0.08  # largest displacement in the picture, relative to the size of the body
COLUMNS = 3
FACETS = 8000  # triangles are divided until there are so many, because each has one colour
SLENDER = 0.3  # ratio of extents below which a body is a plate or a beam


def modes_picture(file: File, count: int) -> Figure | None:
    """The first `count` elastic modes of a kernel file at their largest deflection. Rods show the
    displacement along their axis. Returns None if there are no elastic modes.

    Raises InputError if the kernel has no visualisation surface.
    """
    if not file.has("/view/node"):
        raise InputError(
            f"{file.path}: has no visualisation surface: set output.view = true and compute it again"
        )
    omega = file.array("/modes/angular_frequency", None)
    node, element = file.array("/view/node", None, 3), file.array("/view/element", None, None)
    shape = file.array("/view/shape", len(node), 3, len(omega)).astype(float)
    chosen = np.flatnonzero(omega > 0)[:count]
    if len(chosen) == 0:
        return None
    rows = -(-len(chosen) // COLUMNS)
    ritz = file.text("/modes", "basis") == "contact"
    name, names = ("vector", "contact-adapted basis") if ritz else ("mode", "elastic modes")
    figure = Figure(figsize=(WIDTH, 2.3 * rows + 0.5), layout="constrained")
    axes = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for ax, n in zip(axes, chosen):
        if element.shape[1] == 2:
            draw_rod(ax, node, shape[:, :, n])
        else:
            draw_surface(ax, node, element, shape[:, :, n])
        ax.set_title(f"{name} {n + 1}: {omega[n] / (2 * np.pi):.5g} Hz", fontsize=9)
    for ax in axes[len(chosen) :]:
        ax.axis("off")
    shown = "along the rod" if element.shape[1] == 2 else "as colour, over the shape at rest in grey"
    title = f"{file.text('/', 'body') or 'body'}: {names}, displacement {shown}"
    figure.suptitle(title, fontsize=11)
    return figure


def upright(node: Floats) -> Floats:
    """The axis that points up: that across a plate, y for a beam along z, otherwise z."""
    extent = np.ptp(node, axis=0)
    if extent.min() < SLENDER * np.median(extent):
        return np.eye(3)[np.argmin(extent)]
    return np.eye(3)[1 if extent[2] > np.delete(extent, 2).max() / SLENDER else 2]


def finer(corner: Floats) -> Floats:
    """Divides triangles (T,3,k) into four each until there are at least FACETS."""
    while len(corner) < FACETS:
        middle = (corner + np.roll(corner, -1, axis=1)) / 2  # of the edges 01, 12, 20
        ends = [np.stack([corner[:, i], middle[:, i], middle[:, i - 1]], axis=1) for i in range(3)]
        corner = np.concatenate([*ends, middle])
    return corner


def draw_rod(ax: Axes, node: Floats, shape: Floats) -> None:
    """The displacement along the rod over the position on it."""
    ends = node[[np.argmin(node.sum(axis=1)), np.argmax(node.sum(axis=1))]]
    axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    where, value = node @ axis, shape @ axis
    order = np.argsort(where)
    ax.plot(where[order], value[order] / np.abs(value).max(), color=BODY[0])
    ax.set(xlabel="place (m)", ylim=(-1.1, 1.1), yticks=[-1, 0, 1])


def draw_surface(ax: Axes, node: Floats, element: Floats, shape: Floats) -> None:
    """The deflected surface over the outline at rest. Its colour shows the magnitude of the displacement."""
    size = np.linalg.norm(np.ptp(node, axis=0))
    moved = np.linalg.norm(shape, axis=1)
    view = clearest([(node, element)], np.empty((0, 3)), tilted=True, up=upright(node)).turn()
    deflected = (node + AMPLITUDE * size / moved.max() * shape) @ view.T
    paint(ax, deflected, element, moved / moved.max(), behind=node @ view.T)


def paint(ax: Axes, place: Floats, element: Floats, share: Floats, behind: Floats | None = None) -> None:
    """Draws triangles in the colours of their corners.

    @param place   (V,3) right, up, towards the eye
    @param share   (V) from 0 to 1
    @param behind  (V,3) places of the same triangles in grey behind them
    """
    corner = finer(np.column_stack([place, share])[element])
    colour = matplotlib.colormaps["viridis"](corner[:, :, 3].mean(axis=1))
    colour[:, :3] *= (0.65 + 0.35 * np.abs(normals(corner[:, :, :3])[:, 2]))[:, None]
    order = np.argsort(corner[:, :, 2].mean(axis=1), kind="stable")
    layers = [(behind[element], "#e8e8e8")] if behind is not None else []
    for patches, tint in [*layers, (corner[order], colour[order])]:
        flat = PolyCollection(patches[:, :, :2], facecolors=tint, edgecolors=tint, linewidths=0.3)
        ax.add_collection(flat)
    everything = np.concatenate([place] + ([behind] if behind is not None else []))[:, :2]
    low, high = everything.min(axis=0), everything.max(axis=0)
    fit(ax, low, high, 0.03 * (high - low).max())
