# SPDX-License-Identifier: BSD-2-Clause
"""Pictures of the records of a sweep: a quantity over time, with a line for each impact."""
from collections.abc import Sequence
from pathlib import Path

import h5py
import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.files import save_picture
from ricochet.pictures.style import DPI, WIDTH, in_style, prefixed, with_unit
from ricochet.studies import histories
from ricochet.studies.chart import LINES, axis, looks_logarithmic, text
from ricochet.studies.histories import Record
from ricochet.studies.labels import label
from ricochet.studies.table import Table

MOST = 400  # maximum number of impacts; of more, some at equal distances are drawn
WORDS = {
    "force": "contact force",
    "receivers": "velocity of",
    "acceleration": "acceleration of",
    "bodies": "velocity of",
    "energy": "energy,",
}

GAUGE_WORDS = {"von_mises": "von Mises stress", "strain": "strain"}


@in_style
def draw(table: Table, results: Path, name: str, against: str, path: Path, units: dict[str, str]) -> None:
    """Draws the record `name` of all finished impacts, from <title>.sweep.h5, as a PNG file. Lines have the
    colour of the value of the input `against`. Raises InputError if there is no such record."""
    with h5py.File(results, "r", locking=False) as file:
        kept = sorted(map(int, file.get("histories", {})))
        if not kept:
            raise InputError(f'no finished impact has a record "{name}": there is nothing to draw')
        rows = kept[:: -(-len(kept) // MOST)]
        lines = [histories.read(file, row, name) for row in rows]
    if names := histories.components_of(lines[0].values):
        each = ", ".join(f"{name}.{component}" for component in names)
        raise InputError(f'"{name}" has {len(names)} components: draw one of {each}')
    column = table.column(against)
    values, texts = axis([column[row] for row in rows])
    fig = Figure(figsize=(WIDTH, 5.2), layout="constrained")
    ax = fig.subplots()
    colour_lines(ax, lines, values, texts, label(against, units))
    some = f" ({len(rows)} of {len(kept)} impacts)" if len(rows) < len(kept) else ""
    ax.set(ylabel=with_unit(words(name), lines[0].unit), title=table.title + some)
    save_picture(fig, path, dpi=DPI)


def words(name: str) -> str:
    """The label of a record."""
    kind, _, rest = name.partition(".")
    base, _, component = rest.rpartition(".")
    if kind == "gauges":
        return words_of_gauge(base, component)
    return " ".join(filter(None, [WORDS[kind], f"{base}, {component}" if base else rest]))


def words_of_gauge(name: str, quantity: str) -> str:
    """The label of a record gauges.NAME.QUANTITY, where `quantity` may be a component of the stress."""
    if quantity in GAUGE_WORDS:
        return f"{GAUGE_WORDS[quantity]} of {name}"
    return f"stress of {name.removesuffix('.stress')}, {quantity}"


def colour_lines(
    ax: Axes, lines: Sequence[Record], values: Array, names: Sequence[str] | None, title: str
) -> None:
    """Draws the lines in the colours of their values. A legend explains few of them, a colour bar more."""
    scale, unit = prefixed(max((float(line.time[-1]) for line in lines if len(line.time)), default=1.0), "s")
    different = np.unique(values)
    few = len(different) <= LINES
    norm: Normalize = LogNorm() if looks_logarithmic(values) else Normalize()
    norm.autoscale(different)
    if few:  # equal steps of colour, without the pale end of the map
        values = np.searchsorted(different, values)
        norm = Normalize(0, max(len(different) - 1, 1) / 0.85)
    colours = matplotlib.cm.ScalarMappable(norm, "viridis")
    for line, value in zip(lines, values):
        width = 1.2 if len(lines) <= 40 else 0.6
        ax.plot(line.time * scale, line.values, lw=width, color=colours.to_rgba(value))
    ax.set_xlabel(f"time ({unit})")
    shown = [names[int(value)] if names else text(float(value)) for value in different]
    if few:
        handles = [Line2D([], [], color=colours.to_rgba(k), label=name) for k, name in enumerate(shown)]
        ax.legend(handles=handles, title=title, fontsize=8, title_fontsize=8)
    else:
        bar = ax.figure.colorbar(colours, ax=ax, label=title)
        if names:
            bar.set_ticks(list(different), labels=shown)
