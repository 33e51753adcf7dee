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


def modes_picture(file: File, count: int) -> Figure:
    """The first `count` elastic modes of a kernel file at their largest deflection. Rods show the
    displacement along their axis.

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
    rows = max(1, -(-len(chosen) // COLUMNS))
    figure = Figure(figsize=(WIDTH, 2.3 * rows + 0.5), layout="constrained")
    axes = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for ax, n in zip(axes, chosen):
        if element.shape[1] == 2:
            draw_rod(ax, node, shape[:, :, n])
        else:
            draw_surface(ax, node, element, shape[:, :, n])
        ax.set_title(f"mode {n + 1}: {omega[n] / (2 * np.pi):.5g} Hz", fontsize=9)
    for ax in axes[len(chosen) :]:
        ax.axis("off")
    figure.suptitle(f"{file.text('/', 'body') or 'body'}: elastic modes", fontsize=11)
    return figure


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
    view = clearest([(node, element)], np.empty((0, 3)), tilted=True).turn()
    at_rest = (node @ view.T)[element]
    deflected = ((node + AMPLITUDE * size / moved.max() * shape) @ view.T)[element]
    normal = normals(deflected)
    colour = matplotlib.colormaps["viridis"](moved[element].mean(axis=1) / moved.max())
    colour[:, :3] *= (0.65 + 0.35 * np.abs(normal[:, 2]))[:, None]
    order = np.argsort(deflected[:, :, 2].mean(axis=1), kind="stable")
    for patches, tint in ((at_rest, "#e8e8e8"), (deflected[order], colour[order])):
        flat = PolyCollection(patches[:, :, :2], facecolors=tint, edgecolors=tint, linewidths=0.3)
        ax.add_collection(flat)
    everything = np.concatenate([at_rest, deflected]).reshape(-1, 3)[:, :2]
    low, high = everything.min(axis=0), everything.max(axis=0)
    fit(ax, low, high, 0.03 * (high - low).max())
