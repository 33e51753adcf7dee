# SPDX-License-Identifier: BSD-2-Clause
"""The picture of the stress and the strain at the gauges of a run."""

import matplotlib
from matplotlib.figure import Figure

from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.style import WIDTH, largest_of, legend_below, prefixed, shade_contact
from ricochet.stress import von_mises


def gauges_picture(result: LoadedResult) -> Figure | None:
    """The von Mises stress of each gauge over time, and below it the strain of those with a direction. None without gauges,
    and for bodies at rest under constant loads."""
    gauges = result.gauges
    if not gauges or len(result.gauge_time) < 2:
        return None
    strains = {name: gauge.strain for name, gauge in gauges.items() if gauge.strain is not None}
    stresses = {name: von_mises(gauge.stress) for name, gauge in gauges.items()}
    panels = [("von Mises stress", stresses, "Pa")] + [("strain", strains, "")] * bool(strains)
    colours = dict(zip(gauges, matplotlib.colormaps["tab10"].colors * len(gauges)))
    ms, seconds = prefixed(float(result.gauge_time[-1]), "s")
    figure = Figure(figsize=(WIDTH, 0.9 + 2.8 * len(panels)), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for ax, (what, values, base) in zip(axes, panels):
        factor, unit = prefixed(largest_of(*values.values()), base) if base else (1e6, "10⁻⁶")
        for name, curve in values.items():
            ax.plot(result.gauge_time * ms, curve * factor, color=colours[name], linewidth=1.2, label=name)
        ax.set(ylabel=f"{what} ({unit})", xlim=(result.gauge_time[0] * ms, result.gauge_time[-1] * ms))
        shade_contact(result, ax, ms)
    axes[-1].set_xlabel(f"time ({seconds})")
    legend_below(figure, *axes[0].get_legend_handles_labels())
    figure.suptitle(f"{result.title}: gauges", fontsize=11)
    return figure
