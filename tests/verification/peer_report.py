# SPDX-License-Identifier: BSD-2-Clause
"""The comparison of impacts by Ricochet with those by a peer: tables in Markdown, and the figure."""
import numpy as np

import case
from benchmarks import tables
from benchmarks.equal_accuracy import time_at
from peer_impact import KINDS, difference

TARGETS = (0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.002)


def compare(ours, peers, limit, frame, before, path):
    """Prints and draws a comparison.

    @param ours, peers  impacts; the last ones are the finest
    @param limit        reference of the peer: the limit of its impacts, or the last of them
    @param before       kinetic energy [J] before the impact
    @param path         of the figure, or None
    """
    best = [ours[-1], peers[-1]] + ([limit] if limit is not peers[-1] else [])
    side_by_side(best, frame, before)
    for one in best[1:]:
        apart = difference(best[0], one, frame)
        words = [f"{KINDS[kind]} {apart[kind]:.2%}" for kind in frame.kinds]
        words += [f"width {apart['width']:.2%}"] if frame.depth else []
        print(f"\nOur finest run differs from {one.code}, {one.setting}, by: {', '.join(words)}.")
    print()
    rows = convergence(ours + peers, {best[0].code: best[0], limit.code: limit}, frame)
    for which in NAMES:
        equal_accuracy(rows, which, TARGETS)
    if path:
        draw(best, rows, frame, path)


def side_by_side(impacts, frame, before):
    """Prints the results of some impacts. @param before  kinetic energy [J] before the impact"""
    by_kind = [
        (
            "normal",
            "peak normal force (N)",
            lambda one: frame.copies * (one.force @ frame.normal).max(),
            ".5g",
        ),
        (
            "tangential",
            "largest friction (N)",
            lambda one: frame.copies * np.abs(one.force @ frame.tangent).max(),
            ".5g",
        ),
        ("normal", "contact (ms)", lambda one: 1e3 * one.duration(frame.normal), ".4g"),
        ("rebound", "normal rebound (m/s)", lambda one: one.velocity @ frame.normal, ".4f"),
        ("slide", "tangential (m/s)", lambda one: one.velocity @ frame.tangent, ".4f"),
        ("spin", "spin (rad/s)", lambda one: one.spin @ frame.axis, ".3f"),
    ]
    table = tables.Table(
        [
            ("", lambda one: f"{one.code}, {one.setting}", ""),
            *(column for kind, *column in by_kind if kind in frame.kinds),
            *([("widest contact (mm)", lambda one: 1e3 * widest(one, frame), ".4g")] if frame.depth else []),
            ("energy kept", lambda one: one.energy / before, ".4f"),
        ]
    )
    for one in impacts:
        table.row(one)


def widest(one, frame):
    """Largest width [m] of a contact."""
    return one.width(frame, one.time).max()


def convergence(impacts, references, frame):
    """Prints the differences of impacts from both references, and their times. Returns the rows.

    @param references  the finest run or the limit of each code, by code
    """
    columns = [("code", "code", ""), ("setting", "setting", "")]
    columns += [(f"{KINDS[kind]}, own / other", kind, ".1e") for kind in frame.kinds]
    columns += [("width, own / other", "width", ".1e")] if frame.depth else []
    columns += [("wall (s)", "seconds", ".2f"), ("processor (s)", "cpu_seconds", ".2f")]
    columns += [("parts (processor s)", "parts", "")]
    table, rows = tables.Table(columns), []
    for one in impacts:
        by = {code: difference(one, reference, frame) for code, reference in references.items()}
        own, (other,) = by.pop(one.code), by.values()
        own = None if one is references[one.code] else own
        row = {"code": one.code, "setting": one.setting, "own": own, "other": other}
        row |= {kind: Pair(own and own[kind], other[kind]) for kind in other}
        row |= {kind: one.total(kind) for kind in ("seconds", "cpu_seconds")}
        row |= {"parts": " + ".join(f"{name} {part['cpu_seconds']:.2f}" for name, part in one.parts.items())}
        rows.append(row)
        table.row(row)
    return rows


class Pair(tuple):
    """Two numbers in one cell."""

    def __new__(cls, *values):
        return super().__new__(cls, values)

    def __format__(self, form):
        return " / ".join(tables.show(value, form) for value in self)


def equal_accuracy(rows, which, targets):
    """Prints the processor time that each code needs for a largest difference from a reference: on the line in log-log through
    its runs that no other run beats in both error and time, or that of its cheapest run if even this one is closer.

    @param which  "own" or "other": the finest result of the same code or of the other one
    """
    print(f"\nProcessor time for a largest difference from the finest result of {NAMES[which]}:\n")
    codes = list(dict.fromkeys(row["code"] for row in rows))
    columns = [("difference", "target", ".1%")] + [(f"{code} (s)", code, "") for code in codes]
    table = tables.Table([*columns, ("ratio", "ratio", "")])
    for target in targets:
        (ours, mark), (theirs, beyond) = (time_within(front(rows, code, which), target) for code in codes)
        row = {"target": target, codes[0]: shown(mark, ours), codes[1]: shown(beyond, theirs)}
        known = ours and theirs and not beyond
        table.row(row | {"ratio": shown("≥ " if mark else "", theirs / ours) if known else "–"})


def time_within(points, target):
    """Time [s] at which the error is `target`, or None, and a mark: "≤ " if the error of all points is below."""
    if not points or min(points)[0] > target:
        return None, ""
    if max(points)[0] <= target:
        return min(seconds for _, seconds in points), "≤ "
    return time_at(points, target)[0], ""


def shown(mark, value):
    return f"{mark}{value:.3g}" if value else "not reached"


NAMES = {"own": "the same code", "other": "the other code"}


def front(rows, code, which):
    """Points (error, time) of a code that no other one of it beats in both."""
    points = [
        (row[which]["largest"], row["cpu_seconds"]) for row in rows if row["code"] == code and row[which]
    ]
    return [p for p in points if not any(q[0] <= p[0] and q[1] < p[1] for q in points if q is not p)]


COLOURS = {"Ricochet": case.BLUE, "CalculiX": case.ORANGE}
LINES = {"Ricochet": "-", "CalculiX": "--"}


def draw(impacts, rows, frame, path):
    """Draws the force histories of some impacts, and the error of all rows against their time."""
    from matplotlib.figure import Figure

    forces = [("normal force (N)", frame.normal)]
    forces += [("friction (N)", -frame.tangent)] if "tangential" in frame.kinds else []
    histories = [
        (label, lambda one, time, along=direction: frame.copies * one.component(along, time))
        for label, direction in forces
    ]
    histories += (
        [("width of the contact (mm)", lambda one, time: 1e3 * one.width(frame, time))] if frame.depth else []
    )
    figure = Figure(figsize=(3.2 * (1 + len(histories)), 3.6), layout="constrained")
    *of_time, of_error = figure.subplots(1, 1 + len(histories))
    for axes, (label, history) in zip(of_time, histories):
        drawn = set()
        for one in impacts:
            line = ":" if one.code in drawn else LINES[one.code]
            drawn.add(one.code)
            time = np.linspace(0, one.time[-1], 2001)
            name = f"{one.code}, {one.setting}"
            axes.plot(
                1e3 * time, history(one, time), line, color=COLOURS[one.code], linewidth=1.2, label=name
            )
        axes.set(xlabel="time (ms)", ylabel=label)
    # The legend is below the curves.
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -0.15 * len(impacts) * high), high)
    axes.legend(frameon=False, fontsize=7, loc="lower left")
    for which, marker in (("own", "o"), ("other", "x")):
        for code, colour in COLOURS.items():
            points = [(r["cpu_seconds"], r[which]["largest"]) for r in rows if r["code"] == code and r[which]]
            label = f"{code}, from {NAMES[which]}"
            of_error.loglog(*zip(*points), marker, color=colour, markersize=4, label=label)
    of_error.set(xlabel="processor time (s)", ylabel="largest difference")
    of_error.grid(True, which="both", color="#e4e4e4")
    of_error.set_ylim(top=1)
    of_error.legend(frameon=False, fontsize=7, loc="upper right")
    tables.save(figure, path)
