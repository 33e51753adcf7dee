# SPDX-License-Identifier: BSD-2-Clause
"""The picture of the energy ledger of a result."""
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import LogLocator

from ricochet.pictures.style import GREY, SHADE, WIDTH, largest_of, legend_below, prefixed, shade_contact
from ricochet.pictures.loaded_result import LoadedResult


def energy_picture(result: LoadedResult) -> Figure:
    """All terms of the energy ledger with their sum, and the deviation of the sum from its first value."""
    terms, ledger = result.terms, result.ledger
    scale_name, reference = "first sum", abs(ledger[0])
    if reference <= 1e-12 * largest_of(*terms.values()):  # bodies at rest have no energy at first
        scale_name, reference = "largest term", largest_of(*terms.values())
    ms, time_unit = prefixed(result.time[-1], "s")
    mj, energy_unit = prefixed(largest_of(ledger, *terms.values()), "J")
    t = result.time * ms

    figure = Figure(figsize=(WIDTH, 6.2), layout="constrained")
    top, low = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
    colours = ["#2b6cb0", "#d2691e", "#3a8f5c", "#8a4fa3", "#8c6d1f", "#b03a48", "#12a3b4"]
    for (name, values), colour in zip(terms.items(), colours):
        width, note = (1.6, "") if np.any(values) else (1, " (0)")
        top.plot(t, values * mj, color=colour, linewidth=width, label=result.LABELS[name] + note)
    top.plot(t, ledger * mj, color="black", linewidth=1.8, linestyle=(0, (4, 1.5)), label="sum of all")
    top.set(ylabel=f"energy ({energy_unit})", title="Where the energy is")
    stray = np.abs(ledger - ledger[0]) / (reference or 1)
    if np.any(stray):  # a logarithmic axis cannot show zeros
        low.semilogy(t[stray > 0], stray[stray > 0], ".", color="black", markersize=2)
        first, last = np.floor(np.log10(stray[stray > 0].min())), np.ceil(np.log10(stray.max()))
        low.set_ylim(10.0**first, 10.0 ** max(last, first + 1))
        low.yaxis.set_major_locator(LogLocator(numticks=6))
    else:
        low.text(0.5, 0.5, "nothing: the sum never changes", transform=low.transAxes, ha="center", color=GREY)
    low.set(
        ylabel=f"change of the sum,\nrelative to {scale_name}",
        title="What the ledger fails to account for",
        xlabel=f"time ({time_unit})",
        xlim=(t[0], t[-1]),
    )
    for ax in (top, low):
        shade_contact(result, ax, ms)
    handles, names = top.get_legend_handles_labels()
    legend_below(figure, [*handles, Rectangle((0, 0), 1, 1, **SHADE)], [*names, "in contact"])
    figure.suptitle(f"{result.title}: energy", fontsize=11)
    return figure
