# SPDX-License-Identifier: BSD-2-Clause
"""Pictures of a sweep: an output over one input, with a line for each value of the others, or over two inputs
as cells."""
from collections.abc import Callable, Sequence
import functools
import json
import math
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.files import save_picture
from ricochet.pictures.style import DPI, WIDTH, in_style
from ricochet.studies.labels import label, of_magnitude
from ricochet.studies.table import Table, is_number

FEW = 12  # maximum number of ticks on an axis
LINES = 8  # maximum number of lines
WRITTEN = 64  # maximum number of cells that show their value as text

#: quantity whose estimated error is that of an output, and a factor: both bodies may rebound
ERRORS = {
    "peak_force_n": ("peak_force", 1.0),
    "impulse_ns": ("impulse", 1.0),
    "restitution": ("rebound", math.sqrt(2)),
}


def errors_of(table: Table, output: str, values: Array) -> Array | None:
    """The estimated errors of an output, in its unit: those of peak force and impulse are relative to
    themselves, those of the rebound to the speed of approach. None if there are none."""
    quantity, factor = ERRORS.get(output, ("", 1.0))
    columns = getattr(table, "outputs", {})
    if (name := f"error_estimate.quantities.{quantity}.total") not in columns:
        return None
    relative = factor * np.array(columns[name], dtype=float)
    return relative if quantity == "rebound" else relative * np.abs(values)


def axis(values: Sequence[Any]) -> tuple[Array, list[str] | None]:
    """The positions of values on an axis, and labels if the values are not numbers."""
    if all(map(is_number, values)):
        return np.array(values, dtype=float), None
    labels = [text(value) for value in values]
    names = list(dict.fromkeys(labels))
    return np.array([names.index(label) for label in labels], dtype=float), names


def text(value: Any) -> str:
    if is_number(value):
        return f"{value:.6g}"
    return value if isinstance(value, str) else json.dumps(value)


def looks_logarithmic(values: Array) -> bool:
    """Whether values are positive, span more than a decade, and are spaced by ratio rather than by
    difference."""
    values = np.unique(values[np.isfinite(values)])
    return (
        len(values) > 2
        and values[0] > 0
        and values[-1] > 12 * values[0]
        and np.median(values) < 0.3 * (values[0] + values[-1])
    )


def is_even(values: Array) -> bool:
    """Whether ascending values have equal differences or ratios, so that cells of equal width can represent
    them."""
    by_ratio = np.log(values) if values[0] > 0 else values
    return any(np.ptp(np.diff(v)) <= 1e-3 * np.abs(np.diff(v)).max() for v in (values, by_ratio))


def others(
    table: Table, against: Sequence[str], label: Callable[[str], str]
) -> tuple[str | None, list[str] | None, bool]:
    """Returns the title of the lines, the name of the line to which each setting belongs (None if there are
    too many), and whether all other inputs are constant along a line."""
    columns = {
        key: [text(value) for value in column]
        for key, column in table.inputs.items()
        if key not in map(of_magnitude, against)
    }
    columns = {key: column for key, column in columns.items() if len(set(column)) > 1}
    settings = list(zip(*columns.values()))
    for key, column in columns.items():  # an input that determines all others, as in [list]
        if len(set(column)) == len(set(settings)) <= LINES:
            return label(key), column, True
    if columns and len(set(settings)) <= LINES:
        return ", ".join(map(label, columns)), [", ".join(setting) for setting in settings], True
    few = [key for key in columns if len(set(columns[key])) <= LINES]
    return (label(few[0]), columns[few[0]], False) if few else (None, None, not columns)


@in_style
def draw(table: Table, output: str, against: Sequence[str], path: Path, units: dict[str, str]) -> None:
    """Draws the column `output` over one or two columns as a PNG file. Raises InputError if it has no finite
    value."""
    labelled = functools.partial(label, units=units)
    z, _ = axis(table.column(output))
    places = [axis(table.column(name)) for name in against]
    there = np.isfinite(z)
    if not there.any():
        raise InputError(f'no finished impact has a value of "{output}": there is nothing to draw')
    fig = Figure(figsize=(WIDTH, 5.2), layout="constrained")
    ax = fig.subplots()
    if len(places) == 1:
        lines(ax, z, there, places[0][0], *others(table, against, labelled), errors_of(table, output, z))
        ax.set_ylabel(labelled(output))
    elif all(len(np.unique(p)) <= FEW or names or is_even(np.unique(p)) for p, names in places) and len(
        np.unique(places[0][0])
    ) * len(np.unique(places[1][0])) <= 4 * len(z):
        cells(fig, ax, z, there, places, labelled(output))
    else:
        fig.colorbar(
            ax.scatter(places[0][0][there], places[1][0][there], c=z[there], s=14), label=labelled(output)
        )
    if len(places) == 1 or not ax.images:
        for (values, names), set_scale, set_ticks in zip(
            places, (ax.set_xscale, ax.set_yscale), (ax.set_xticks, ax.set_yticks)
        ):
            scale(set_scale, set_ticks, values, names)
    if len(places) == 2:
        ax.set_ylabel(labelled(against[1]))
    ax.set(xlabel=labelled(against[0]), title=table.title)
    save_picture(fig, path, dpi=DPI)


def lines(
    ax: Axes,
    z: Array,
    there: NDArray[np.bool_],
    x: Array,
    what: str | None,
    names: Any,
    joined: bool,
    errors: Array | None = None,
) -> None:
    """Draws a line for each name, or only points if other inputs vary along it, with bars of their errors."""
    names = np.array(names if names else [""] * len(z))
    found = list(dict.fromkeys(names))
    colours = matplotlib.colormaps["viridis"](np.linspace(0, 0.85, len(found)))
    for name, colour in zip(found, colours):
        of = np.flatnonzero(there & (names == name))
        of = of[np.argsort(x[of], kind="stable")]
        form, alpha = ("o-", 1.0) if joined else (".", 0.7)
        ax.plot(x[of], z[of], form, ms=4, lw=1, color=colour, alpha=alpha, label=name)
        if errors is not None:
            ax.errorbar(
                x[of], z[of], errors[of], fmt="none", color=colour, alpha=alpha, elinewidth=0.8, capsize=2
            )
    if what:
        ax.legend(title=what, fontsize=8, title_fontsize=8)


def cells(
    fig: Figure,
    ax: Axes,
    z: Array,
    there: NDArray[np.bool_],
    places: Sequence[tuple[Array, list[str] | None]],
    what: str,
) -> None:
    """Draws a cell for each pair of values, with the mean over all other inputs."""
    values = [np.unique(place) for place, _ in places]
    at = tuple(np.searchsorted(v, place[there]) for v, (place, _) in zip(values[::-1], places[::-1]))
    total, count = np.zeros((2, len(values[1]), len(values[0])))
    np.add.at(total, at, z[there])
    np.add.at(count, at, 1)
    mean = np.divide(total, count, out=np.full_like(total, np.nan), where=count > 0)
    ax.grid(False)
    image = ax.imshow(mean, origin="lower", aspect="auto", interpolation="nearest")
    fig.colorbar(image, label=f"mean of {what}" if count.max() > 1 else what)
    for set_ticks, v, (_, names) in zip((ax.set_xticks, ax.set_yticks), values, places):
        shown = np.arange(0, len(v), -(-len(v) // FEW))
        set_ticks(shown, [names[k] if names else text(float(v[k])) for k in shown])
    if mean.size <= WRITTEN:
        for (row, column), value in np.ndenumerate(mean):
            if np.isfinite(value):
                text_of, colour = (
                    f"{float(f'{value:.3g}'):g}",
                    "black" if image.norm(value) > 0.6 else "white",
                )
                ax.text(column, row, text_of, ha="center", va="center", fontsize=8, color=colour)


def scale(
    set_scale: Callable[[str], Any], set_ticks: Callable[..., Any], values: Array, labels: list[str] | None
) -> None:
    if labels:
        set_ticks(range(len(labels)), labels)
    elif looks_logarithmic(values):
        set_scale("log")
