# SPDX-License-Identifier: BSD-2-Clause
"""The data of the charts of a page; charts.js draws them."""
from typing import Any

import numpy as np

from ricochet.arrays import Array
from ricochet.pages.motion import packed
from ricochet.pictures.friction import bounds, parts
from ricochet.pictures.grid import Grid
from ricochet.pictures.loaded_result import Curves, LoadedResult
from ricochet.result import OPEN, SLIP, STICK
from ricochet.shock import CHANNEL_CLASSES, cfc_filter, shock_response_spectrum

Axis = dict[str, Any]
Chart = dict[str, Any]

DOTS = 1600  # maximum number of points of a line
COLUMNS, ROWS = 400, 120  # maximum number of cells of the force map
PIECES = 700  # number of points of a spectrum
FEWEST = 8  # number of neighbours that the picture of pressures shows at least


def thinned(x: Array, y: Array) -> tuple[Array, Array]:
    """Reduces the points of a line: each piece keeps its minimum and maximum. Gaps (NaN) are kept."""
    if len(x) <= DOTS:
        return x, y
    edges = np.unique(np.linspace(0, len(x), DOTS // 2 + 1).astype(int))
    kept = []
    for first, stop in zip(edges[:-1], edges[1:]):
        piece, gaps = y[first:stop], np.isnan(y[first:stop])
        kept += [
            first + np.argmin(np.where(gaps, np.inf, piece)),
            first + np.argmax(np.where(gaps, -np.inf, piece)),
        ]
        kept += [first + np.argmax(gaps)] if gaps.any() else []
    kept = np.unique(kept)
    return x[kept], y[kept]


def line(name: str, colour: int | str, x: Any, y: Any, style: str = "") -> dict[str, Any]:
    """The data of a line. `colour` is the number of a body or a name in the style sheet. `style` consists of
    words of charts.js, such as "steps dashed"."""
    x, y = thinned(np.asarray(x), np.asarray(y))
    return {"name": name, "colour": colour, "style": style, "x": packed(x), "y": packed(y)}


def axis(label: str, unit: str, **more: Any) -> Axis:
    return {"label": label, "unit": unit} | more


STATES = {OPEN: "open", STICK: "stick", SLIP: "slip"}  # colours
TOLD = {OPEN: "open", STICK: "sticks", SLIP: "slips"}
TIME, FREQUENCY = axis("time", "s"), axis("frequency", "Hz", log=True)
NATURAL = axis("natural frequency", "Hz", log=True)


def chart(
    key: str, title: str, x: Axis, y: Axis, lines: list[dict[str, Any]], note: str = "", **more: Any
) -> Chart:
    return {"key": key, "title": title, "x": x, "y": y, "lines": lines, "note": note} | more


def shown(x: Array, y: Array, window: tuple[float, float]) -> tuple[Array, Array]:
    inside = (x >= window[0]) & (x <= window[1])
    return x[inside], y[inside]


def colour_of(result: LoadedResult, name: str) -> int | str:
    return list(result.bodies).index(name) % 6 if name in result.bodies else "still"


def styles(result: LoadedResult) -> tuple[str, str]:
    """Styles of a filled and of a plain line of forces: steps if each step has a row."""
    return ("steps filled", "steps") if result.every == 1 else ("", "")


def force_chart(result: LoadedResult, i: int) -> Chart:
    count = len(result.initial_gap)
    total, one = (result.force_curve(force) for force in (result.forces.per_row(), result.forces.of_point(i)))
    name = f"sum of {count} points" if count > 1 else "force"
    filled, steps = styles(result)
    lines = [line(name, "force", *total, style=filled)]
    if count > 1:
        lines.append(line(f"point {i + 1}", "second", *one, style=f"{steps} dashed"))
    note = "" if result.episodes else "Nothing touched."
    if result.every > 1:
        note = f"Stored{result.every_text}: the area is not the impulse."
    force = axis("force", "N", zero=True)
    return chart("force", "Contact force", TIME, force, lines, note, cursor=True, window=result.window())


def friction_charts(result: LoadedResult) -> list[Chart]:
    """Friction beside its bound over time, and friction against displacement at the point with most of it."""
    normal, resultant, magnitudes = result.tangential_totals()
    filled, steps = styles(result)
    when, normals = result.force_curve(normal)
    lines = [line("friction, sum as a vector", "friction", when, result.force_curve(resultant)[1], filled)]
    if magnitudes.max() > 1.02 * resultant.max():
        lines.append(line("sum of magnitudes", "second", when, result.force_curve(magnitudes)[1], steps))
    limits = bounds(result)
    for coefficient, name in limits:
        lines.append(line(name, "still", when, coefficient * normals, f"{steps} dashed"))
    lines.append(line("normal force, Σ λ", "force", when, normals, steps))
    note = "Sums over the points with friction." if limits else "Pairs have different coefficients."
    more: dict[str, Any] = {"cursor": True, "window": result.window()}
    out = [chart("friction", "Friction", TIME, axis("force", "N", zero=True), lines, note, **more)]
    i = result.roughest
    moved, force = result.loop(i)
    a, b = result.sides_names(i)
    lines = []
    for value, name in STATES.items():
        here = result.states.of_point(i) == value
        x, y = parts(result, moved, here), parts(result, force, here)
        if not np.isnan(y).all():
            lines.append(line(TOLD[value], name, x, y))
    x_axis, y_axis = axis(f"displacement of {a} relative to {b}", "m", padded=True), axis(
        f"friction on {b}", "N"
    )
    note = f"Point {i + 1}, along the direction in which friction acts most."
    return [*out, chart("loop", "Friction against displacement", x_axis, y_axis, lines, note)]


def along_normal_charts(result: LoadedResult, i: int) -> list[Chart]:
    window = result.window()
    place, speed, mean_place, mean_speed = result.along_normal(i)

    def lines(here: Curves, means: Curves) -> list[dict[str, Any]]:
        dashed = [
            line(f"{name}, mean of its mass", colour_of(result, name), *shown(*curve, window), "dashed")
            for name, curve in means.items()
        ]
        at_point = [
            line(f"{name}, contact point", colour_of(result, name), *curve) for name, curve in here.items()
        ]
        return dashed + at_point

    along = result.axis(i)
    note = f"The sides touch where their lines meet; 0 is {along.zero}."
    means = f"Those of contact points are {result.velocities}."
    places, speeds = axis(along.position, "m"), axis(along.velocity, "m/s")
    more: dict[str, Any] = {"cursor": True, "window": window}
    return [
        chart("place", "Place of the two surfaces", TIME, places, lines(place, mean_place), note, **more),
        chart("speed", "Velocity", TIME, speeds, lines(speed, mean_speed), means, **more),
    ]


def table_charts(result: LoadedResult, i: int) -> list[Chart]:
    """Charts of a run with sampled responses: the gap, and the velocities of free bodies along the axis of their
    largest change."""
    window = result.window()
    gap = [line("gap", "force", *result.broken(result.gap[:, i]))]
    note = "Negative: penetration."
    out = [chart("gap", "Gap while touching", TIME, axis("gap", "m"), gap, note, window=window)]
    if result.velocity:
        a = result.liveliest_axis
        lines = [
            line(f"{body}, mean of its mass", colour_of(result, body), *shown(result.time, v[:, a], window))
            for body, v in result.velocity.items()
        ]
        velocity = axis(f"{'xyz'[a]}-velocity", "m/s")
        out.append(chart("speed", "Velocity", TIME, velocity, lines, window=window))
    return out


def spectrum(values: Array, step: float, factor: float) -> tuple[Array, Array]:
    """Frequencies [Hz] and spectrum |Σ values exp(−iωt)| · factor: the maximum in each piece of a logarithmic
    axis."""
    # Zero padding makes the spectrum smooth.
    length = min(1 << (8 * len(values) - 1).bit_length(), max(1 << 20, len(values)))
    size = np.abs(np.fft.rfft(values, length))[1:] * factor
    frequency = np.arange(1, len(size) + 1) / (length * step)
    inside = frequency >= 0.5 / (len(values) * step)  # the record is too short for lower frequencies
    frequency, size = frequency[inside], size[inside]
    edges = np.unique(np.searchsorted(frequency, np.geomspace(frequency[0], frequency[-1], PIECES)))
    best = [first + int(np.argmax(size[first:stop])) for first, stop in zip(edges[:-1], edges[1:])]
    return frequency[best], size[best]


def spectrum_chart(result: LoadedResult) -> Chart:
    step = result.time[1] - result.time[0]
    lines = [line("sum of all points", "force", *spectrum(result.total_force, step, step))]
    size = axis("|∫ F exp(−iωt) dt|", "N s", log=True, decades=7)
    note = "Its left end is the impulse of the contact."
    if result.every > 1:
        note = f"Of the forces that are stored{result.every_text}: its left end is near the impulse only."
    return chart("spectrum", "Spectrum of the contact force", FREQUENCY, size, lines, note)


def pressure_chart(result: LoadedResult) -> Chart:
    """The pressure of each point in the step with the largest force."""
    row = int(np.argmax(result.forces.per_row()))
    order, where, what = result.positions()
    pressure = result.pressures.of_row(row)[order]
    pressing = result.forces.of_row(row)[order] > 0  # where creases cross, there is a force, but no patch
    away = np.abs(where)
    far = max(1.6 * away[pressing].max(), np.sort(away)[: FEWEST + 1].max())
    near = away <= far  # points farther away are open
    note = f"{np.count_nonzero(pressing)} of {len(order)} points press" + (
        "." if len(result.time) == 1 else " when the force is largest."
    )
    kinds = [("pressure", "force", near)]
    if result.has_friction:  # colours by state; points without friction keep the colour of forces
        state, rubs = result.states.of_row(row)[order], result.rubbing[order]
        state = np.where(rubs | pressing, state, OPEN)
        kinds = [
            (TOLD[value], name, near & (rubs | ~pressing) & (state == value))
            for value, name in STATES.items()
        ]
        kinds.append(("without friction", "force", near & ~rubs & pressing))
    lines = [line(name, colour, where[at], pressure[at], "dots") for name, colour, at in kinds if at.any()]
    size = axis("pressure", "Pa", zero=True)
    return chart("pressure", "Contact pressure", axis(what, "m"), size, lines, note)


def force_map(result: LoadedResult) -> dict[str, Any]:
    """The force by point and time: the maximum in each cell. Points that never touch are omitted."""
    grid = Grid(result, result.impulse() > 0, COLUMNS, ROWS, by_impulse=True)
    return map_of(grid) | {"force": packed(grid.largest(result.forces), "u2")}


def state_map(result: LoadedResult) -> dict[str, Any]:
    """The state by point and time: slip if a point slips in any step of a cell, open if it is open in all."""
    grid = Grid(result, result.rubbing, COLUMNS, ROWS)
    return map_of(grid) | {"state": packed(grid.largest(result.states), "u1")}


def map_of(grid: Grid) -> dict[str, Any]:
    return {
        "from": grid.start,
        "to": grid.end,
        "what": grid.what,
        "where": packed(grid.where),
        "points": (grid.order + 1).tolist(),
        "left_out": grid.left_out,
    }


def energy_charts(result: LoadedResult) -> list[Chart]:
    terms, ledger = result.terms, result.ledger
    lines = [
        line(result.LABELS[name], number, result.time, values)
        for number, (name, values) in enumerate(terms.items())
        if np.any(values)
    ]
    lines.append(line("sum of all", "still", result.time, ledger, "dashed"))
    nothing = [result.LABELS[name] for name, values in terms.items() if not np.any(values)]
    note = f"Zero throughout: {', '.join(nothing)}." if nothing else ""
    energy = axis("energy", "J", zero=True)
    out = [chart("energy", "Where the energy is", TIME, energy, lines, note, cursor=True)]
    largest = max(np.abs(values).max() for values in [ledger, *terms.values()]) or 1
    stray = np.abs(ledger - ledger[0]) / largest
    if np.any(stray):
        name, there = "change of the sum over the largest term", stray > 0
        lines = [line(name, "still", result.time[there], stray[there], "specks")]
        change = axis("relative change", "", log=True, whole=True)
        title, window = "What the ledger fails to account for", (result.time[0], result.time[-1])
        out.append(chart("ledger", title, TIME, change, lines, cursor=True, window=window))
    return out


def acceleration_charts(result: LoadedResult) -> dict[str, list[Chart]]:
    """The magnitude of the acceleration of each receiver, unfiltered and by class, and its shock response spectrum."""
    out = {}
    time = result.receiver_time
    if len(time) < 3:
        return {}
    rate, middle = 1 / (time[1] - time[0]), (time[1:] + time[:-1]) / 2
    for number, (name, receiver) in enumerate(result.receivers.items()):
        means, start = receiver.mean_acceleration, receiver.acceleration[0]
        size = np.linalg.norm(receiver.acceleration, axis=1)
        lines = [line("unfiltered, at output samples", "still", time, size)]
        for k, cfc in enumerate(CHANNEL_CLASSES):
            if rate >= 10 * cfc:
                filtered = np.linalg.norm(cfc_filter(means, rate, cfc, start), axis=1)
                lines.append(line(f"CFC {cfc}", k, middle, filtered))
        spectra = shock_response_spectrum(means, rate, rest=start)
        responses = [
            line("xyz"[k], k, spectra.frequency_hz, a)
            for k, a in enumerate(spectra.acceleration.T)
            if a.any()
        ]
        key, unit = f"acceleration-{number}", axis("acceleration", "m/s²", zero=True)
        note = "Largest absolute acceleration of oscillators with Q = 10, during the run and afterwards."
        response = axis("acceleration", "m/s²", log=True, decades=6)
        out[name] = [
            chart(key, "Acceleration", TIME, unit, lines, "Magnitude of the vector.", cursor=True),
            chart(f"{key}-shock", "Shock response spectrum", NATURAL, response, responses, note),
        ]
    return out


def receiver_charts(result: LoadedResult) -> dict[str, list[Chart]]:
    out = {}
    for number, (name, receiver) in enumerate(result.receivers.items()):
        time, velocity = result.receiver_time, receiver.velocity
        step = time[1] - time[0]
        window = np.hanning(len(time) + 2)[1:-1]
        moved = [k for k in range(3) if np.ptp(velocity[:, k]) > 1e-9 * np.ptp(velocity, axis=0).max()]
        lines = [line("xyz"[k], k, time, velocity[:, k]) for k in moved]
        still = "" if moved else "It does not move."
        tones = [
            line("xyz"[k], k, *spectrum((v - v.mean()) * window, step, 2 / window.sum()))
            for k, v in zip(moved, velocity.T[moved])
        ]
        size = axis("amplitude", "m/s", log=True, decades=6)
        note = "Amplitude of a steady tone, without the mean; Hann's window over the whole record."
        out[name] = [
            chart(f"receiver-{number}", "Velocity", TIME, axis("velocity", "m/s"), lines, still),
            chart(f"receiver-{number}-spectrum", "Spectrum", FREQUENCY, size, tones, note),
        ]
    return out
