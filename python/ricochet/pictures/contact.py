# SPDX-License-Identifier: BSD-2-Clause
"""Pictures of a contact over time: gap or place, velocity and force at the point that takes the largest impulse."""
from matplotlib.axes import Axes
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ricochet.pictures.style import (
    GREY,
    SHADE,
    WIDTH,
    colour_of,
    largest_of,
    legend_below,
    prefixed,
    shade_contact,
)
from ricochet.pictures.history import History


def force_panel(result: History, ax: Axes, i: int) -> None:
    """The force at point i and the sum over all points, as steps over time; the area below them is the impulse."""
    start, end = result.window()
    ms, time_unit = prefixed(end, "s")
    when, here = result.held(result.force[:, i])
    _, total = result.held(result.force.sum(axis=1))
    scale, shown_unit = prefixed(largest_of(total), "N")
    ax.fill_between(when * ms, here * scale, step="pre", color="#b03a48", alpha=0.25, linewidth=0)
    ax.plot(
        when * ms,
        here * scale,
        drawstyle="steps-pre",
        color="#b03a48",
        linewidth=1.4,
        label="force at the point",
    )
    if len(result.initial_gap) > 1:
        ax.plot(
            when * ms,
            total * scale,
            ":",
            drawstyle="steps-pre",
            color=GREY,
            linewidth=1.5,
            label=f"sum over {len(result.initial_gap)} points",
        )
    ax.set(
        ylabel=f"contact force ({shown_unit})",
        title="Contact force",
        xlabel=f"time ({time_unit})",
        xlim=(start * ms, end * ms),
    )
    if not result.episodes:
        ax.text(0.5, 0.5, "nothing touched", transform=ax.transAxes, ha="center", color=GREY)


def table_picture(result: History) -> Figure:
    """A run with table kernels: gap and force at the point with the largest impulse, and velocities of free bodies."""
    i = int(np.argmax(result.impulse())) if result.episodes else 0
    ms, _ = prefixed(result.window()[1], "s")
    figure = Figure(figsize=(WIDTH, 8.2), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True)
    when, gap = result.broken(result.gap[:, i])
    scale, unit = prefixed(largest_of(gap), "m")
    axes[0].plot(when * ms, gap * scale, color=GREY, label="gap while touching")
    axes[0].set(ylabel=f"gap ({unit})", title="Gap at the point (negative: penetration)")
    changes = [np.ptp(v, axis=0) for v in result.velocity.values()]
    axis = int(np.argmax(np.max(changes, axis=0))) if changes else 0
    scale, unit = prefixed(largest_of(*(v[:, axis] for v in result.velocity.values())), "m/s")
    for body, v in result.velocity.items():
        axes[1].plot(
            result.time * ms,
            v[:, axis] * scale,
            color=colour_of(result, body),
            label=f"{body}, mean of its mass",
        )
    axes[1].set(ylabel=f"{'xyz'[axis]}-velocity ({unit})", title="Velocity")
    force_panel(result, axes[2], i)
    handles: dict[str, Any] = {}
    for ax in axes:
        shade_contact(result, ax, ms)
        handles |= dict(zip(*reversed(ax.get_legend_handles_labels())))
    handles["in contact"] = Rectangle((0, 0), 1, 1, **SHADE)
    legend_below(figure, handles.values(), handles.keys())
    figure.suptitle(f"{result.title}: contact at point {i + 1} of {len(result.initial_gap)}", fontsize=11)
    return figure


def contact_picture(result: History) -> Figure:
    """Position and velocity of both sides at the point with the largest impulse, and the force there, over time."""
    i = int(np.argmax(result.impulse())) if result.episodes else 0
    points = len(result.initial_gap)
    start, end = result.window()
    shown = (result.time >= start) & (result.time <= end)
    t = result.time[shown]
    ms, time_unit = prefixed(end, "s")
    place, speed, *means = result.along_normal(i)
    mean_place, mean_speed = ({body: values[shown] for body, (_, values) in mean.items()} for mean in means)

    figure = Figure(figsize=(WIDTH, 8.2), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True)
    panels = [
        (
            axes[0],
            "m",
            "place along normal",
            "Place of the two surfaces, from where the second one was (they touch where the lines meet)",
            place,
            mean_place,
        ),
        (axes[1], "m/s", "velocity along normal", "Velocity", speed, mean_speed),
    ]
    for ax, unit, label, title, at_point, mean in panels:
        scale, shown_unit = prefixed(largest_of(*(v for _, v in at_point.values()), *mean.values()), unit)
        for name, (when, values) in at_point.items():
            # An obstacle is drawn behind, broad and pale, as the other side lies on it.
            style = (
                {"linewidth": 1.8} if name in result.bodies else {"linewidth": 5, "alpha": 0.3, "zorder": 1.4}
            )
            ax.plot(
                when * ms,
                values * scale,
                color=colour_of(result, name),
                label=f"{name}, contact point",
                **style,
            )
            padded = np.concatenate([[np.nan], values, [np.nan]])
            alone = np.isnan(padded[:-2]) & np.isnan(padded[2:])  # an episode of one step
            ax.plot(when[alone] * ms, values[alone] * scale, ".", color=colour_of(result, name))
        for body, values in mean.items():
            ax.plot(
                t * ms,
                values * scale,
                "--",
                color=colour_of(result, body),
                linewidth=1,
                zorder=1.5,
                label=f"{body}, mean of its mass",
            )
        ax.set(ylabel=f"{label} ({shown_unit})", title=title)
    force_panel(result, axes[2], i)
    for ax in axes:
        shade_contact(result, ax, ms)
    handles: dict[str, Any] = {}
    for ax in (axes[0], axes[2]):
        handles |= dict(zip(*reversed(ax.get_legend_handles_labels())))
    handles["in contact"] = Rectangle((0, 0), 1, 1, **SHADE)
    legend_below(figure, handles.values(), handles.keys())
    where = ", ".join(f"{x:.4g}" for x in result.point_a[i])
    figure.suptitle(f"{result.title}: contact at point {i + 1} of {points}, at ({where}) m", fontsize=11)
    return figure
