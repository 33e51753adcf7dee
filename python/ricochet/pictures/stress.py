# SPDX-License-Identifier: BSD-2-Clause
"""The picture of the largest von Mises stress of a run on the surfaces of the bodies."""
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from ricochet.arrays import Array
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.modes import paint, upright
from ricochet.pictures.style import NORMAL, WIDTH, colour_of, prefixed
from ricochet.pictures.viewpoint import clearest
from ricochet.result_file import File, is_there

COLUMNS = 2


def stress_picture(result: LoadedResult, kernels: Path) -> Figure | str | None:
    """The envelopes of all bodies that have one; the reason if there is no picture; None if the run has no stress of
    surfaces.

    @param kernels  folder of the kernels
    """
    f = result.file
    bodies = [body for body in result.bodies if f.has(f"/stress/{body}/von_mises")]
    if not bodies:
        return None
    columns = min(COLUMNS, len(bodies))
    rows = -(-len(bodies) // columns)
    figure = Figure(figsize=(WIDTH, 3.4 * rows + 0.4), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for ax, body in zip(axes, bodies):
        path = kernels / Path(f.text(f"/bodies/{body}", "kernel") or "").name
        if not is_there(path):
            return f"there is no kernel {path} (set --kernels)"
        kernel = File(path, "ricochet-kernel")
        if not kernel.has("/view/node"):
            return f"{path.name} has no visualisation surface (set [output] stress = true)"
        node = kernel.array("/view/node", None, 3)
        largest, time = (
            f.array(f"/stress/{body}/{name}", len(node)) for name in ("von_mises", "von_mises_time")
        )
        factor, unit = prefixed(float(largest.max(initial=0)), "Pa")
        worst = int(np.argmax(largest))
        element = kernel.array("/view/element", None, None)
        if element.shape[1] == 2:
            draw_along(ax, node, largest * factor, unit, colour_of(result, body))
        else:
            draw_on_surface(ax, figure, node, element, largest * factor, unit)
        ms, seconds = prefixed(float(time[worst]), "s")
        when = "" if result.static else f", {time[worst] * ms:.3g} {seconds}"
        ax.set_title(f"{body}: {largest[worst] * factor:.3g} {unit}{when}", fontsize=9)
    for ax in axes[len(bodies) :]:
        ax.axis("off")
    figure.suptitle(
        "von Mises stress at rest" if result.static else "Largest von Mises stress of the run", fontsize=11
    )
    return figure


def draw_along(ax: Axes, node: Array, value: Array, unit: str, colour: str) -> None:
    """The stress of a rod over the position on it."""
    ends = node[[np.argmin(node.sum(axis=1)), np.argmax(node.sum(axis=1))]]
    axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    where = node @ axis
    order = np.argsort(where)
    ax.plot(where[order], value[order], color=colour)
    ax.set(xlabel="place (m)", ylabel=f"stress ({unit})", ylim=(0, None))


def draw_on_surface(ax: Axes, figure: Figure, node: Array, element: Array, value: Array, unit: str) -> None:
    """The stress as colour, and a ring around its largest value, seen from where this is least hidden."""
    worst = node[[int(np.argmax(value))]]
    view = clearest([(node, element)], worst, tilted=True, up=upright(node)).turn()
    top = float(value.max(initial=0)) or 1.0
    paint(ax, np.asarray(node @ view.T), element, np.asarray(value / top))
    right, up, _ = (worst @ view.T)[0]
    ax.plot(right, up, "o", markersize=9, markerfacecolor="none", markeredgecolor=NORMAL)
    scale = ScalarMappable(Normalize(0, top), "viridis")
    figure.colorbar(scale, ax=ax, label=f"stress ({unit})", shrink=0.8)
