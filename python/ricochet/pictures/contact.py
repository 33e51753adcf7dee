# SPDX-License-Identifier: BSD-2-Clause
"""Pictures of a contact over time: gap or place, velocity and force at the point with the largest impulse."""
from collections.abc import Sequence
import itertools
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ricochet.pictures.comparison import Law, compared
from ricochet.pictures.style import FRICTION, GREY, NORMAL, SHADE, STATE, WIDTH
from ricochet.pictures.style import colour_of, draw_force, largest_of, legend_below, prefixed, shade_contact
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.result import SLIP, STICK


def panels(result: LoadedResult, i: int, where: str, laws: Sequence[Law] = ()) -> tuple[Figure, Any]:
    """A figure with three axes over time. The lowest axis shows the force at point i."""
    figure = Figure(figsize=(WIDTH, 8.2), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True)
    force_panel(result, axes[2], i, laws)
    count = len(result.initial_gap)
    figure.suptitle(f"{result.title}: contact at point {i + 1} of {count}{where}", fontsize=11)
    return figure, axes


def finish(result: LoadedResult, figure: Figure, axes: Any) -> Figure:
    """Shades the contact and draws the legend, which contains each name once."""
    ms, _ = prefixed(result.window()[1], "s")
    handles: dict[str, Any] = {}
    for ax in axes:
        shade_contact(result, ax, ms)
        handles |= dict(zip(*reversed(ax.get_legend_handles_labels())))
    handles["in contact"] = Rectangle((0, 0), 1, 1, **SHADE)
    legend_below(figure, handles.values(), handles.keys())
    return figure


def force_panel(result: LoadedResult, ax: Axes, i: int, laws: Sequence[Law] = ()) -> None:
    """The force at point i and the sum over all points, as steps over time. The area below them is the
    impulse, unless only every n-th step is stored."""
    start, end = result.window()
    ms, time_unit = prefixed(end, "s")
    when, here = result.force_curve(result.forces.of_point(i))
    _, total = result.force_curve(result.forces.per_row())
    scale, unit = prefixed(largest_of(total), "N")
    if result.every == 1:
        ax.fill_between(when * ms, here * scale, step="pre", color=NORMAL, alpha=0.25, linewidth=0)
    draw_force(result, ax, ms, when, here * scale, color=NORMAL, linewidth=1.4, label="force at the point")
    if result.has_friction:
        _, rubs = result.force_curve(np.linalg.norm(result.frictions.of_point(i), axis=1))
        draw_force(
            result, ax, ms, when, rubs * scale, color=FRICTION, linewidth=1.4, label="friction at the point"
        )
        state_strip(result, ax, i, ms)
        ax.margins(y=0.12)  # the forces stay below the strip
    if len(result.initial_gap) > 1:
        label = f"sum over {len(result.initial_gap)} points"
        draw_force(result, ax, ms, when, total * scale, linestyle=":", color=GREY, linewidth=1.5, label=label)
    for law, dashes in zip(laws, itertools.cycle([(6, 2), (2, 1.5), (6, 2, 1, 2)])):
        name, moments, force = compared(result, law)
        ax.plot(moments * ms, force * scale, color="black", linewidth=1, linestyle=(0, dashes), label=name)
    ax.set(xlabel=f"time ({time_unit})", xlim=(start * ms, end * ms))
    ax.set(ylabel=f"contact force ({unit})", title=f"Contact force{result.every_text}{below(result)}")
    if not result.episodes:
        ax.text(0.5, 0.5, "nothing touched", transform=ax.transAxes, ha="center", color=GREY)


def below(result: LoadedResult) -> str:
    """The filter of the forces in words; empty without a filter."""
    return f", low-pass {result.low_pass:g} Hz" if result.low_pass else ""


def state_strip(result: LoadedResult, ax: Axes, i: int, ms: float) -> None:
    """Draws at the upper edge when point i sticks and when it slips."""
    state, half = result.states.of_point(i), 0.5 * result.spacing
    for value, name in [(STICK, "the point sticks"), (SLIP, "the point slips")]:
        padded = np.concatenate([[False], state == value, [False]])
        breaks = np.diff(padded.astype(int))
        pause = np.append(np.diff(result.contact_time) > 3 * half, False)  # an episode ends here
        ranges = []
        for first, stop in zip(np.flatnonzero(breaks == 1), np.flatnonzero(breaks == -1)):
            inner = [first, *(first + 1 + np.flatnonzero(pause[first : stop - 1])), stop]
            for a, b in zip(inner[:-1], inner[1:]):
                begin = result.contact_time[a] - 2 * half
                ranges.append((begin * ms, (result.contact_time[b - 1] - begin) * ms))
        axes = {"transform": ax.get_xaxis_transform(), "zorder": 3}
        ax.broken_barh(ranges, (0.955, 0.045), facecolors=STATE[value], label=name, linewidth=0, **axes)


def table_picture(result: LoadedResult) -> Figure:
    """A run with sampled responses: gap and force at the point with the largest impulse, and velocities of free
    bodies."""
    i, axis = result.strongest, result.liveliest_axis
    ms, _ = prefixed(result.window()[1], "s")
    figure, axes = panels(result, i, "")
    when, gap = result.broken(result.gap[:, i])
    scale, unit = prefixed(largest_of(gap), "m")
    axes[0].plot(when * ms, gap * scale, color=GREY, label="gap while touching")
    axes[0].set(ylabel=f"gap ({unit})", title="Gap at the point (negative: penetration)")
    along = {body: v[:, axis] for body, v in result.velocity.items()}
    scale, unit = prefixed(largest_of(*along.values()), "m/s")
    for body, v in along.items():
        label = f"{body}, mean of its mass"
        axes[1].plot(result.time * ms, v * scale, color=colour_of(result, body), label=label)
    axes[1].set(ylabel=f"{'xyz'[axis]}-velocity ({unit})", title="Velocity")
    return finish(result, figure, axes)


def contact_picture(result: LoadedResult, laws: Sequence[Law] = ()) -> Figure:
    """Position and velocity of both sides at the point with the largest impulse, and the force there, over time.
    Forces of `laws` are drawn beside it."""
    i = result.strongest
    start, end = result.window()
    shown = (result.time >= start) & (result.time <= end)
    ms, _ = prefixed(end, "s")
    t = result.time[shown] * ms
    place, speed, *means = result.along_normal(i)
    mean_place, mean_speed = ({body: values[shown] for body, (_, values) in mean.items()} for mean in means)
    figure, axes = panels(result, i, f", at ({', '.join(f'{x:.4g}' for x in result.point_a[i])}) m", laws)
    axis = result.axis(i)
    titles = (
        f"Place of the two surfaces (they touch where the lines meet; 0: {axis.zero})",
        f"Velocity (those of contact points are {result.velocities})",
    )
    for ax, unit, label, title, at_point, mean in [
        (axes[0], "m", axis.position, titles[0], place, mean_place),
        (axes[1], "m/s", axis.velocity, titles[1], speed, mean_speed),
    ]:
        scale, shown_unit = prefixed(largest_of(*(v for _, v in at_point.values()), *mean.values()), unit)
        for name, (when, values) in at_point.items():
            # An obstacle is drawn in the background, wide and pale, because the line of the other side covers
            # it.
            style = {"linewidth": 1.8, "color": colour_of(result, name)}
            if name not in result.bodies:
                style |= {"linewidth": 5, "alpha": 0.3, "zorder": 1.4}
            ax.plot(when * ms, values * scale, label=f"{name}, contact point", **style)
            padded = np.concatenate([[np.nan], values, [np.nan]])
            alone = np.isnan(padded[:-2]) & np.isnan(padded[2:])  # an episode of one step
            ax.plot(when[alone] * ms, values[alone] * scale, ".", color=colour_of(result, name))
        for body, values in mean.items():
            style = {"color": colour_of(result, body), "linewidth": 1, "zorder": 1.5}
            ax.plot(t, values * scale, "--", label=f"{body}, mean of its mass", **style)
        ax.set(ylabel=f"{label} ({shown_unit})", title=title)
    return finish(result, figure, axes)
