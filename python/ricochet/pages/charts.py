# SPDX-License-Identifier: BSD-2-Clause
"""The data of the charts of a page; charts.js draws them."""
from typing import Any

import numpy as np

from ricochet.arrays import Array
from ricochet.pages.motion import packed
from ricochet.pictures.history import History

DOTS = 1600  # points of a line
COLUMNS, ROWS = 400, 120  # at most, of the map of forces
PIECES = 700  # points of a spectrum


def thinned(x: Array, y: Array) -> tuple[Array, Array]:
    """A line with fewer points: the minimum and maximum of each of its pieces. Gaps (NaN) are kept."""
    if len(x) <= DOTS:
        return x, y
    edges = np.unique(np.linspace(0, len(x), DOTS // 2 + 1).astype(int))
    kept = []
    for first, behind in zip(edges[:-1], edges[1:]):
        piece, gaps = y[first:behind], np.isnan(y[first:behind])
        kept += [
            first + np.argmin(np.where(gaps, np.inf, piece)),
            first + np.argmax(np.where(gaps, -np.inf, piece)),
        ]
        kept += [first + np.argmax(gaps)] if gaps.any() else []
    kept = np.unique(kept)
    return x[kept], y[kept]


def line(name: str, colour: int | str, x: Any, y: Any, style: str = "") -> dict[str, Any]:
    """`colour`: number of a body, or a name in the style sheet; `style`: words of charts.js, such as "held dashed"."""
    x, y = thinned(np.asarray(x), np.asarray(y))
    return {"name": name, "colour": colour, "style": style, "x": packed(x), "y": packed(y)}


def chart(
    key: str,
    title: str,
    x: dict[str, Any],
    y: dict[str, Any],
    lines: list[dict[str, Any]],
    note: str = "",
    **more: Any,
) -> dict[str, Any]:
    return {"key": key, "title": title, "x": x, "y": y, "lines": lines, "note": note} | more


def axis(label: str, unit: str, **more: Any) -> dict[str, Any]:
    return {"label": label, "unit": unit} | more


def shown(x: Array, y: Array, window: tuple[float, float]) -> tuple[Array, Array]:
    inside = (x >= window[0]) & (x <= window[1])
    return x[inside], y[inside]


def colour_of(result: History, name: str) -> int | str:
    return list(result.bodies).index(name) % 6 if name in result.bodies else "still"


def force_chart(result: History, i: int) -> dict[str, Any]:
    total, one = result.held(result.force.sum(axis=1)), result.held(result.force[:, i])
    lines = [
        line(
            f"sum of {len(result.initial_gap)} points" if len(result.initial_gap) > 1 else "force",
            "force",
            *total,
            style="held filled",
        )
    ]
    if len(result.initial_gap) > 1:
        lines.append(line(f"point {i + 1}", "second", *one, style="held dashed"))
    note = "" if result.episodes else "Nothing touched."
    return chart(
        "force",
        "Contact force",
        axis("time", "s"),
        axis("force", "N", zero=True),
        lines,
        note,
        cursor=True,
        window=result.window(),
    )


def along_normal_charts(result: History, i: int) -> list[dict[str, Any]]:
    window = result.window()
    place, speed, mean_place, mean_speed = result.along_normal(i)
    out = []
    for key, title, label, unit, here, means, note in [
        (
            "place",
            "Place of the two surfaces",
            "place along the normal",
            "m",
            place,
            mean_place,
            "From where the second surface was: the sides touch where their lines meet.",
        ),
        ("speed", "Velocity", "velocity along the normal", "m/s", speed, mean_speed, ""),
    ]:
        lines = [
            line(
                f"{name}, mean of its mass",
                colour_of(result, name),
                *shown(curve[0], curve[1], window),
                style="dashed",
            )
            for name, curve in means.items()
        ]
        lines += [
            line(f"{name}, contact point", colour_of(result, name), *curve) for name, curve in here.items()
        ]
        out.append(
            chart(key, title, axis("time", "s"), axis(label, unit), lines, note, cursor=True, window=window)
        )
    return out


def table_charts(result: History, i: int) -> list[dict[str, Any]]:
    """Charts of a run with table kernels: the gap, and the velocities of free bodies along the axis where they change most."""
    window = result.window()
    out = [
        chart(
            "gap",
            "Gap while touching",
            axis("time", "s"),
            axis("gap", "m"),
            [line("gap", "force", *result.broken(result.gap[:, i]))],
            "Negative: penetration.",
            window=window,
        )
    ]
    if result.velocity:
        a = int(np.argmax(np.max([np.ptp(v, axis=0) for v in result.velocity.values()], axis=0)))
        lines = [
            line(f"{body}, mean of its mass", colour_of(result, body), *shown(result.time, v[:, a], window))
            for body, v in result.velocity.items()
        ]
        out.append(
            chart(
                "speed",
                "Velocity",
                axis("time", "s"),
                axis(f"{'xyz'[a]}-velocity", "m/s"),
                lines,
                window=window,
            )
        )
    return out


def spectrum(values: Array, step: float, factor: float) -> tuple[Array, Array]:
    """Frequencies [Hz] and the largest |Σ values exp(−iωt)| · factor in each piece of a logarithmic axis."""
    length = min(
        1 << (8 * len(values) - 1).bit_length(), max(1 << 20, len(values))
    )  # zero padding makes the spectrum smooth
    size = np.abs(np.fft.rfft(values, length))[1:] * factor
    frequency = np.arange(1, len(size) + 1) / (length * step)
    inside = frequency >= 0.5 / (len(values) * step)  # the record is too short for lower ones
    frequency, size = frequency[inside], size[inside]
    edges = np.unique(np.searchsorted(frequency, np.geomspace(frequency[0], frequency[-1], PIECES)))
    best = [first + int(np.argmax(size[first:behind])) for first, behind in zip(edges[:-1], edges[1:])]
    return frequency[best], size[best]


def spectrum_chart(result: History) -> dict[str, Any]:
    step = result.time[1] - result.time[0]
    frequency, size = spectrum(result.total_force, step, step)
    return chart(
        "spectrum",
        "Spectrum of the contact force",
        axis("frequency", "Hz", log=True),
        axis("|∫ F exp(−iωt) dt|", "N s", log=True, decades=7),
        [line("sum of all points", "force", frequency, size)],
        "Its left end is the impulse of the contact.",
    )


def pressure_chart(result: History, area: Array) -> dict[str, Any]:
    """Pressure of each point in the step of the largest force."""
    row = int(np.argmax(result.force.sum(axis=1)))
    order, where, what = result.positions()
    pressure = (result.force[row] / area)[order]
    pressing = pressure > 0
    far = 1.6 * np.abs(where[pressing]).max()
    near = np.abs(where) <= max(far, np.abs(where).min())  # farther points are open
    note = f"{np.count_nonzero(pressing)} of {len(order)} points press" + (
        "." if len(result.time) == 1 else " when the force is largest."
    )
    return chart(
        "pressure",
        "Contact pressure",
        axis(what, "m"),
        axis("pressure", "Pa", zero=True),
        [line("pressure", "force", where[near], pressure[near], "dots")],
        note,
    )


def force_map(result: History) -> dict[str, Any]:
    """Force by point and time, the maximum in each cell. Points that never touch are left out."""
    order, where, what = result.positions()
    used = result.impulse()[order] > 0
    order, where = order[used], where[used]
    if len(order) > ROWS:
        picked = np.sort(np.argsort(result.impulse()[order])[::-1][:ROWS])
        order, where = order[picked], where[picked]
    first, last = result.contact_time[0], result.contact_time[-1]
    step = result.spacing
    columns = min(COLUMNS, int(round((last - first) / step)) + 1)
    column = np.minimum(
        ((result.contact_time - first + 0.5 * step) / (last - first + step) * columns).astype(int),
        columns - 1,
    )
    cells = np.zeros((columns, len(order)))
    np.maximum.at(cells, column, result.force[:, order])
    return {
        "from": result.spans()[0][0],
        "to": last,
        "what": what,
        "where": packed(where),
        "points": (order + 1).tolist(),
        "force": packed(cells, "u2"),
        "left_out": int(np.count_nonzero(used)) - len(order),
    }


def energy_charts(result: History) -> list[dict[str, Any]]:
    terms = {name: result.energy[name] * (-1 if name == "loads" else 1) for name in result.TERMS}
    ledger = result.energy["total"] + result.energy["damping"] + result.energy["contact"]
    lines = [
        line(result.LABELS[name], number, result.time, values)
        for number, (name, values) in enumerate(terms.items())
        if np.any(values)
    ]
    lines.append(line("sum of all", "still", result.time, ledger, "dashed"))
    nothing = [result.LABELS[name] for name, values in terms.items() if not np.any(values)]
    largest = max(np.abs(values).max() for values in [ledger, *terms.values()]) or 1
    stray = np.abs(ledger - ledger[0]) / largest
    out = [
        chart(
            "energy",
            "Where the energy is",
            axis("time", "s"),
            axis("energy", "J", zero=True),
            lines,
            f"Zero throughout: {', '.join(nothing)}." if nothing else "",
            cursor=True,
        )
    ]
    if np.any(stray):
        out.append(
            chart(
                "ledger",
                "What the ledger fails to account for",
                axis("time", "s"),
                axis("relative change", "", log=True, whole=True),
                [
                    line(
                        "change of the sum over the largest term",
                        "still",
                        result.time[stray > 0],
                        stray[stray > 0],
                        "specks",
                    )
                ],
                cursor=True,
                window=(result.time[0], result.time[-1]),
            )
        )
    return out


def receiver_charts(result: History) -> dict[str, Any]:
    f, out = result.file, dict[str, Any]()
    names = [name for name in f.names("/receivers") if name != "time"]
    if not names:
        return {}
    time = f.array("/receivers/time", None)
    for number, name in enumerate(names):
        velocity = f.array(f"/receivers/{name}/velocity", len(time), 3)
        step = time[1] - time[0]
        window = np.hanning(len(time) + 2)[1:-1]
        moved = [k for k in range(3) if np.ptp(velocity[:, k]) > 1e-9 * np.ptp(velocity, axis=0).max()]
        swing = {
            k: spectrum((velocity[:, k] - velocity[:, k].mean()) * window, step, 2 / window.sum())
            for k in moved
        }
        out[name] = [
            chart(
                f"receiver-{number}",
                "Velocity",
                axis("time", "s"),
                axis("velocity", "m/s"),
                [line("xyz"[k], k, time, velocity[:, k]) for k in moved],
                "" if moved else "It does not move.",
            ),
            chart(
                f"receiver-{number}-spectrum",
                "Spectrum",
                axis("frequency", "Hz", log=True),
                axis("amplitude", "m/s", log=True, decades=6),
                [line("xyz"[k], k, *curve) for k, curve in swing.items()],
                "Amplitude of a steady tone, without the mean; Hann's window over the whole record.",
            ),
        ]
    return out
