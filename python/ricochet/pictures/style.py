# SPDX-License-Identifier: BSD-2-Clause
"""The style of pictures: colours, units, legends. Draw within matplotlib.rc_context(STYLE)."""
from collections.abc import Callable, Iterable
import functools
from typing import Any, ParamSpec, TypeVar

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

from ricochet.arrays import Array
from ricochet.pictures.loaded_result import LoadedResult


DPI = 150
WIDTH = 8.0  # inches; 1200 pixels, the width of a README
BODY = ["#2b6cb0", "#d2691e", "#3a8f5c", "#8a4fa3"]
GREY = "#555555"
NORMAL, FRICTION = "#b03a48", "#17708a"  # forces
STATE = ["#e8e8e8", "#39507f", "#efa500"]  # of a point: open, stick, slip; also distinct in shades of grey
SHADE = {"color": "#f2e7c9", "zorder": 0, "linewidth": 0}

# Settings of matplotlib.
STYLE = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "axes.grid": True,
    "grid.color": "#e4e4e4",
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "agg.path.chunksize": 20000,
}


Drawing = ParamSpec("Drawing")
Drawn = TypeVar("Drawn")


def in_style(draw: Callable[Drawing, Drawn]) -> Callable[Drawing, Drawn]:
    """A function that draws, in the style of all pictures."""

    @functools.wraps(draw)
    def drawn(*words: Drawing.args, **named: Drawing.kwargs) -> Drawn:
        with matplotlib.rc_context(STYLE):
            return draw(*words, **named)

    return drawn


def colour_of(result: LoadedResult, name: str) -> str:
    """The colour of a body in all pictures; grey for obstacles."""
    return BODY[list(result.bodies).index(name) % len(BODY)] if name in result.bodies else GREY


def prefixed(largest: float, unit: str) -> tuple[float, str]:
    """Returns a factor and the unit with an SI prefix, such that the factor times `largest` is between 1 and
    1000, or at least 0.1 without a prefix."""
    for power, prefix in [(9, "G"), (6, "M"), (3, "k"), (0, ""), (-3, "m"), (-6, "µ"), (-9, "n")]:
        factor = 10.0**-power
        if largest * factor >= (0.1 if power == 0 else 1):
            return factor, prefix + unit
    return (1, unit) if largest == 0 else (1e9, "n" + unit)


def with_unit(text: str, unit: str) -> str:
    """The label of an axis. `unit` as in files: m/s^2 is set as m/s², and 1 is none."""
    return text if unit == "1" else f"{text} ({unit.replace('^2', '²')})"


def largest_of(*arrays: Array) -> float:
    return max((float(np.nanmax(np.abs(a))) for a in arrays if np.size(a)), default=0.0)


def normals(corners: Array) -> Array:
    """(T,3) unit normals of triangles (T,3,3); 0 for a triangle without area."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300))


def fit(ax: Axes, low: Array, high: Array, margin: float) -> None:
    """Shows the rectangle from `low` to `high` with a margin, true to scale and without axes."""
    (left, right), (bottom, top) = zip(low - margin, high + margin)
    ax.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    ax.axis("off")


def legend_below(figure: Figure, handles: Iterable[Any], names: Iterable[str], columns: int = 4) -> None:
    """Draws a legend at the lower edge. Constrained layout keeps the panels above it."""
    names = list(names)
    rows = -(-len(names) // columns)
    room = (0.1 + 0.19 * rows) / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, room, 1, 1 - room))
    figure.legend(list(handles), names, loc="lower center", ncol=min(len(names), columns))


def shade_contact(result: LoadedResult, ax: Axes, scale: float) -> None:
    for start, end in result.spans():
        ax.axvspan(start * scale, end * scale, **SHADE)


def draw_force(
    result: LoadedResult, ax: Axes, scale: float, when: Array, values: Array, **style: Any
) -> None:
    """Draws a curve of `force_curve` over time times `scale`: as steps, or as points and lines between them."""
    form: dict[str, Any] = (
        {"drawstyle": "steps-pre"} if result.every == 1 else {"marker": ".", "markersize": 3}
    )
    ax.plot(when * scale, values, **form | style)
