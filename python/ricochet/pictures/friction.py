# SPDX-License-Identifier: BSD-2-Clause
"""The picture of friction: forces over time, maps of pressure and of stick and slip, the loop of one point, and
the contact at the moment in which most points stick while others slip."""
from typing import Any

from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
import numpy as np

from ricochet.arrays import Array
from ricochet.pictures.grid import Grid
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.style import FRICTION, GREY, NORMAL, SHADE, STATE, WIDTH
from ricochet.pictures.style import draw_force, largest_of, legend_below, prefixed, shade_contact
from ricochet.result import OPEN, SLIP, STICK

# Maximum number of cells of a map. A column has at least two pixels, so that none is lost where the image is drawn.
COLUMNS, ROWS = 400, 400
NAMES = {OPEN: "open", STICK: "sticks", SLIP: "slips"}


def friction_picture(result: LoadedResult) -> Figure | None:
    """Draws friction. Returns None if no point with friction has touched."""
    if not result.rubbing.any():
        return None
    grid = Grid(result, result.rubbing, COLUMNS, ROWS)
    several = len(grid.order) > 1
    heights = [2.3, *([1.9] if several else []), 1.9 if several else 0.55, 3.0]
    figure = Figure(figsize=(WIDTH, sum(heights) + 1.9), layout="constrained")
    cells = figure.add_gridspec(len(heights), 2, height_ratios=heights)
    top = figure.add_subplot(cells[0, :])
    forces_panel(result, top)
    maps = [figure.add_subplot(cells[k, :], sharex=top) for k in range(1, len(heights) - 1)]
    if several:
        pressure_map(figure, result, grid, maps[0])
    state_map(result, grid, maps[-1], several)
    for ax in (top, *maps[:-1]):
        ax.tick_params(labelbottom=False)
    loop_panel(result, figure.add_subplot(cells[-1, 0] if several else cells[-1, :]))
    if several:
        moment_panel(result, figure.add_subplot(cells[-1, 1]))
    handles, names = top.get_legend_handles_labels()
    handles += [Rectangle((0, 0), 1, 1, **SHADE)]
    handles += [Rectangle((0, 0), 1, 1, color=colour) for colour in STATE]
    legend_below(figure, handles, [*names, "in contact", *NAMES.values()])
    figure.suptitle(f"{result.title}: friction", fontsize=11)
    return figure


def bounds(result: LoadedResult) -> list[tuple[float, str]]:
    """Coefficients that bound friction, with their names; none if they are not known."""
    if result.coefficients is None:
        return []
    static, dynamic = result.coefficients
    if static == dynamic:
        return [(static, f"μ Σ λ, with μ = {static:g}")]
    return [(static, f"static bound, {static:g} Σ λ"), (dynamic, f"dynamic bound, {dynamic:g} Σ λ")]


def forces_panel(result: LoadedResult, ax: Axes) -> None:
    """Sums over the points with friction: normal force, friction, and its bound."""
    start, end = result.window()
    ms, _ = prefixed(end, "s")
    normal, resultant, magnitudes = result.tangential_totals()
    factor, unit = prefixed(largest_of(normal), "N")
    when, steps = result.force_curve(normal)
    if result.every == 1:
        ax.fill_between(when * ms, steps * factor, step="pre", color=NORMAL, alpha=0.18, linewidth=0)
    draw_force(result, ax, ms, when, steps * factor, color=NORMAL, linewidth=1.2, label="normal force, Σ λ")
    for (coefficient, name), dashes in zip(bounds(result), [(4, 1.5), (1, 1.2)]):
        style: dict[str, Any] = {"linestyle": (0, dashes), "color": "black", "linewidth": 1}
        draw_force(result, ax, ms, when, coefficient * steps * factor, label=name, **style)
    if largest_of(magnitudes) > 1.02 * largest_of(resultant):
        _, steps = result.force_curve(magnitudes)
        style = {"color": FRICTION, "linewidth": 0.9, "alpha": 0.6}
        draw_force(result, ax, ms, when, steps * factor, label="Σ |τ| of the points", **style)
    _, steps = result.force_curve(resultant)
    draw_force(result, ax, ms, when, steps * factor, color=FRICTION, linewidth=1.7, label="friction, |Σ τ|")
    ax.set(
        ylabel=f"force ({unit})",
        xlim=(start * ms, end * ms),
        ylim=(0, None),
        title=f"Normal force and friction{result.every_text}",
    )
    shade_contact(result, ax, ms)


def place_axis(grid: Grid, ax: Axes) -> None:
    """Labels the rows of a map with the places of their points."""
    factor, unit = prefixed(largest_of(grid.where), "m")
    rows = np.unique(np.linspace(0, len(grid.order) - 1, 5).astype(int))
    shown = np.round(grid.where[rows] * factor, 6) + 0.0  # round-off of a place is 0, without a sign
    ax.set_yticks(rows + 0.5, [f"{place:.3g}".replace("-", "−") for place in shown])
    first, second = grid.what.split(" ", 1)  # "distance from …", "position along …"
    ax.set_ylabel(f"{first}\n{second} ({unit})")
    ax.grid(False)


def rows_of(grid: Grid) -> str:
    shown = len(grid.order)
    return f", a row for each of {shown} points" + (f" of {shown + grid.left_out}" if grid.left_out else "")


def pressure_map(figure: Figure, result: LoadedResult, grid: Grid, ax: Axes) -> None:
    ms, _ = prefixed(result.window()[1], "s")
    pressure = grid.largest(result.pressures).T
    factor, unit = prefixed(largest_of(pressure), "Pa")
    shown = np.where(pressure > 0, pressure * factor, np.nan)
    extent = (grid.start * ms, grid.end * ms, 0, len(grid.order))
    red = LinearSegmentedColormap.from_list("pressure", ["#f6d5d0", NORMAL, "#3d0a14"])
    image = ax.imshow(shown, origin="lower", aspect="auto", interpolation="nearest", extent=extent, cmap=red)
    image.set_clim(0, None)
    figure.colorbar(image, ax=ax, label=f"pressure ({unit})", pad=0.01, aspect=12)
    ax.set_title(f"Pressure{rows_of(grid)}")
    place_axis(grid, ax)


def state_map(result: LoadedResult, grid: Grid, ax: Axes, several: bool) -> None:
    """The state of each point over time. A cell of several steps slips if the point slips in one of them, and
    is open only if it is open in all."""
    ms, time_unit = prefixed(result.window()[1], "s")
    ax.imshow(
        grid.largest(result.states).T,
        origin="lower",
        aspect="auto",
        interpolation="nearest",
        extent=(grid.start * ms, grid.end * ms, 0, len(grid.order)),
        cmap=ListedColormap(STATE),
        vmin=-0.5,
        vmax=2.5,
    )
    ax.grid(False)
    ax.set_title(f"Stick and slip{rows_of(grid) if several else ''}")
    ax.set_xlabel(f"time ({time_unit})")
    if several:
        place_axis(grid, ax)
    else:
        ax.set_yticks([])


def loop_panel(result: LoadedResult, ax: Axes) -> None:
    """Friction against displacement at the point with most friction. Each line has the colour of the state that
    the point has at its end."""
    i = result.roughest
    moved, force = result.loop(i)
    (m, moved_unit), (n, force_unit) = prefixed(largest_of(moved), "m"), prefixed(largest_of(force), "N")
    ax.axhline(0, color=GREY, linewidth=0.6)
    states = result.states.of_point(i)
    for state in (OPEN, STICK, SLIP):
        x, y = (parts(result, values, states == state) for values in (moved, force))
        ax.plot(x * m, y * n, color=STATE[state], linewidth=1.4, solid_capstyle="round")
    a, b = result.sides_names(i)
    if len(a + b) > 24:
        a, b = "side a", "side b"
    ax.set(
        xlabel=f"displacement of {a} relative to {b} ({moved_unit})", ylabel=f"friction on {b} ({force_unit})"
    )
    ax.set_title(f"Point {i + 1} of {len(result.initial_gap)}, along its main direction", fontsize=9.5)


def parts(result: LoadedResult, values: Array, here: Array) -> Array:
    """The steps that end in rows `here`, as lines from the row before, with NaN between them."""
    out = list[Any]()
    for first, stop in result.episodes:
        inside = here[first:stop]
        shown = inside | np.append(inside[1:], False)
        # Two separate runs of rows may touch: a line is broken after each row that begins no step.
        row = np.where(shown, values[first:stop], np.nan)
        ends = np.flatnonzero(inside & ~np.append(inside[1:], False)) + 1
        out += [np.insert(row, ends, np.nan), [np.nan]]
    return np.concatenate(out)


def moment_panel(result: LoadedResult, ax: Axes) -> None:
    """The contact in the row in which most points stick while others slip."""
    row = result.mixed_row()
    ms, time_unit = prefixed(result.window()[1], "s")
    at = f"at {result.contact_time[row] * ms:.4g} {time_unit}"
    order, where, what = result.positions()
    if what.startswith("position"):
        inside = result.rubbing[order]
        profile(result, ax, row, order[inside], where[inside], at, what)
    else:
        patch(result, ax, row, at)


def dots(ax: Axes, x: Array, y: Array, state: Array, size: float) -> None:
    for value, colour in enumerate(STATE):
        here = state == value
        outline = {"edgecolors": "#9a9a9a" if value == OPEN else "#333333", "linewidths": 0.4, "zorder": 3}
        ax.scatter(x[here], y[here], s=size, color=colour, **outline)


def far_apart(result: LoadedResult, order: Array, where: Array) -> Array:
    """Indices of the points whose distance from the one before is more than three times the size of their
    patches, so that they are no neighbours."""
    size = np.sqrt(result.area[order])
    return np.flatnonzero(np.diff(where) > 3 * np.maximum(size[1:], size[:-1])) + 1


def profile(result: LoadedResult, ax: Axes, row: int, order: Array, where: Array, at: str, what: str) -> None:
    """A contact along a line: friction of each point and its bound, over the position."""
    force = np.linalg.norm(result.frictions.of_row(row)[order], axis=1)
    normal = result.forces.of_row(row)[order]
    m, place_unit = prefixed(largest_of(where), "m")
    limits = [coefficient * normal for coefficient, _ in bounds(result)]
    n, unit = prefixed(largest_of(force, *limits), "N")
    apart = far_apart(result, order, where)
    line = np.insert(where, apart, np.nan) * m
    for limit, dashes in zip(limits, [(4, 1.5), (1, 1.2)]):
        ax.plot(line, np.insert(limit, apart, np.nan) * n, color="black", linewidth=1, linestyle=(0, dashes))
    ax.plot(line, np.insert(force, apart, np.nan) * n, color=FRICTION, linewidth=1.2)
    dots(ax, where * m, force * n, result.states.of_row(row)[order], 14)
    ax.set(xlabel=f"{what} ({place_unit})", ylabel=f"friction |τ| ({unit})", ylim=(0, None))
    ax.set_title(f"Friction by point {at}", fontsize=9.5)


def patch(result: LoadedResult, ax: Axes, row: int, at: str) -> None:
    """A contact over an area: its points in their plane, with arrows of friction."""
    used, place, normals = result.touching(row)
    weight = result.impulse()[used]
    place = place - weight @ place / weight.sum()
    normal = weight @ normals
    normal = normal / (np.linalg.norm(normal) or 1)
    push = result.frictions.of_row(row)[used]
    # The first axis is the direction in which friction acts most.
    _, axes = np.linalg.eigh(push.T @ push)
    first = axes[:, 2] - (axes[:, 2] @ normal) * normal
    first = first / (np.linalg.norm(first) or 1)
    first = first * np.sign(first[np.argmax(np.abs(first))] or 1)
    plane = np.stack([first, np.cross(normal, first)], axis=1)
    at_plane, arrows = place @ plane, push @ plane
    m, place_unit = prefixed(largest_of(at_plane), "m")
    n, unit = prefixed(largest_of(np.linalg.norm(push, axis=1)), "N")
    x, y = at_plane.T * m
    size = float(np.clip(7000 / len(used), 2, 70))
    dots(ax, x, y, result.states.of_row(row)[used], size)
    longest = float(np.linalg.norm(arrows, axis=1).max())
    if longest > 0:
        span = max(np.ptp(x), np.ptp(y)) or 0.1  # the width of axes around one point
        every = -(-len(used) // 120)
        scale = longest / (
            span * min(0.12, 1.6 * np.sqrt(every / len(used)))
        )  # arrows hardly reach the next one
        style = {"angles": "xy", "scale_units": "xy", "color": "black", "width": 0.004, "zorder": 4}
        quiver = ax.quiver(x[::every], y[::every], *arrows[::every].T, scale=scale, **style)
        label = f"friction, {longest * n:.3g} {unit}"
        ax.quiverkey(
            quiver, 0.66, 1.05, longest, label, labelpos="E", coordinates="axes", fontproperties={"size": 8}
        )
    ax.set_aspect("equal", adjustable="datalim")
    ax.margins(0.12)
    ax.set(xlabel=f"along friction ({place_unit})", ylabel=f"across ({place_unit})")
    ax.set_title(f"Contact {at}", fontsize=9.5)
