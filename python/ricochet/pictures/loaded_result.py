# SPDX-License-Identifier: BSD-2-Clause
"""A result prepared for pictures: episodes of contact, the time around them, and motion along the normal of a
point."""
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.contacts import Entries
from ricochet.errors import InputError
from ricochet.pictures.normal_axis import NormalAxis, normal_axis
from ricochet.result import OPEN, SLIP, STICK, Result

Curve = tuple[Array, Array]  # times [s] and values, NaN between episodes
Curves = dict[str, Curve]  # by name of a side or a body


def low_passed(force: Array, time: Array, spacing: float, hertz: float) -> Array:
    """Means of forces (k,m) at these times under a Hann window that is 2/`hertz` long, without delay. Between the
    rows, nothing touches. A vibration at `hertz` vanishes; above it, at most 2.7 % are left. The impulse stays,
    except for what the window moves beyond the first and the last row."""
    half = int(1 / (hertz * spacing))  # steps
    if len(time) == 0 or half == 0:
        return force
    place = np.rint((time - time[0]) / spacing).astype(int)
    window = 1 + np.cos(np.pi * np.arange(-half, half + 1) / (half + 1))
    window /= window.sum()
    out = np.empty_like(force)
    for point, one in enumerate(force.T):
        dense = np.zeros(place[-1] + 1)
        dense[place] = one
        out[:, point] = np.convolve(dense, window)[half : half + len(dense)][place]
    return out


class LoadedResult(Result):
    """A result whose arrays are read at once. A run with sampled responses has no `energy`."""

    LABELS = {
        "kinetic": "kinetic",
        "strain": "strain",
        "residual": "strain of modes left out",
        "loads": "− work of loads",
        "damping": "lost in damping",
        "contact": "lost in contact",
        "friction": "heat of friction",
    }

    def __init__(self, path: Path, low_pass: float | None = None) -> None:
        """@param low_pass  frequency [Hz] from which on the forces are filtered, see `low_passed`"""
        super().__init__(path)
        self.file = self._file
        self.low_pass = low_pass
        self.static = self.scene.get("contact", {}).get("scheme") == "static"
        if len(self.time) < 2 and not self.static:
            every = self.scene.get("output", {}).get("every", 1)
            raise InputError(
                f"{path}: holds nothing but the start: nothing to draw. output.every is "
                f"{every if isinstance(every, int) else '?'}, which must not exceed the number of steps, "
                "time.rate_hz times time.duration."
            )
        self.velocity = {name: body.velocity for name, body in self.bodies.items()}
        self.motions: dict[str, Array] = {}  # of the sides along the normals, without finite rotations
        if self.energy:
            self.point_a, self.normal  # reading checks the arrays and raises InputError for damaged ones
        if self.has_entries:
            self.contacts
        else:
            if self.energy:
                for name in ("displacement_a", "displacement_b", "velocity_a", "velocity_b"):
                    self.motions[name] = self._dense(name)
            self.force, self.gap
            if self.has_friction:
                self.tangential_force, self.tangential_displacement, self.state
        self.spacing = self.contact_step
        self.episodes = self._episodes()
        if low_pass and self.has_entries:
            self.forces = self._low_passed_forces(low_pass)
        elif low_pass:
            self.force = low_passed(self.force, self.contact_time, self.spacing, low_pass)

    def _low_passed_forces(self, hertz: float) -> Entries:
        """The forces under `low_passed`, point by point, because only few touch at a time."""
        rows, points, values = list[Any](), list[Any](), list[Any]()
        for i in np.unique(self.forces.point):
            one = low_passed(self.forces.of_point(i)[:, None], self.contact_time, self.spacing, hertz)[:, 0]
            rows.append(np.flatnonzero(one))
            points.append(np.full(len(rows[-1]), i))
            values.append(one[rows[-1]])
        row, point, value = (np.concatenate([*parts, []]) for parts in (rows, points, values))
        order = np.argsort(row, kind="stable")
        return Entries(row[order].astype(int), point[order].astype(int), value[order], self.forces.shape)

    def _episodes(self) -> list[tuple[int, int]]:
        """Index ranges (first, last + 1) of contact rows without a pause between them."""
        t = self.contact_time
        if len(t) == 0:
            return []
        pause = np.flatnonzero(np.diff(t) > 1.5 * self.spacing) + 1
        edges = [0, *pause, len(t)]
        return [(int(first), int(stop)) for first, stop in zip(edges[:-1], edges[1:])]

    def spans(self) -> list[tuple[float, float]]:
        """Start and end of each episode [s]. An episode starts one step before its first row."""
        t = self.contact_time
        return [
            (max(float(t[first]) - self.spacing, float(self.time[0])), float(t[stop - 1]))
            for first, stop in self.episodes
        ]

    def during(self, times: Array) -> NDArray[np.int64]:
        """Numbers of the times [s] from the first touch to the last one; of all if none is."""
        spans = self.spans()
        touching = (times >= spans[0][0]) & (times <= spans[-1][1]) if spans else np.zeros(len(times), bool)
        return np.flatnonzero(touching) if touching.any() else np.arange(len(times))

    def impulse(self) -> Array:
        """(m) impulse of each contact point, divided by the step [N]"""
        return self.forces.per_point()

    @property
    def strongest(self) -> int:
        """The contact point with the largest impulse, or the first one if nothing touched."""
        return int(np.argmax(self.impulse())) if self.episodes else 0

    @property
    def liveliest_axis(self) -> int:
        """The axis along which the velocity of a free body changes most, or x if there are no free bodies."""
        changes = [np.ptp(v, axis=0) for v in self.velocity.values()]
        return int(np.argmax(np.max(changes, axis=0))) if changes else 0

    @property
    def terms(self) -> dict[str, Array]:
        """The terms of the energy ledger by name. Their sum is `ledger`. Friction only if the run has it."""
        names = [name for name in self.LABELS if name != "friction" or self.has_friction]
        return {name: self.energy[name] * (-1 if name == "loads" else 1) for name in names}

    def positions(self) -> tuple[NDArray[np.int64], Array, str]:
        """Contact points sorted by place, their places [m], and a description of the place."""
        weight, gap = self.impulse(), self.initial_gap
        used = weight > 0
        first = used & (gap <= gap[used].min() + 1e-3 * np.ptp(gap[used]))  # all if surfaces are parallel
        away = self.point_a - weight[first] @ self.point_a[first] / weight[first].sum()
        spread, axes = np.linalg.eigh(away[used].T @ away[used])
        if spread[1] < 0.1 * spread[2]:  # the points that touch lie on a line
            along = axes[:, 2] * np.sign(axes[np.argmax(np.abs(axes[:, 2])), 2])
            where, what = away @ along, "position along the contact"
        else:
            where = np.linalg.norm(away, axis=1)
            what = "distance from where the gap was least" if self.static else "distance from the first touch"
        where = np.where(np.abs(where) > 1e-9 * np.ptp(self.point_a, axis=0).max(), where, 0.0)  # round-off
        order = np.argsort(where, kind="stable")
        return order, where[order], what

    def window(self) -> tuple[float, float]:
        """Start and end of the contact with a margin [s], or of the run if nothing touched."""
        t = self.time
        if not self.episodes or len(t) == 1:
            return float(t[0]), float(t[-1])
        first, last = self.spans()[0][0], float(self.contact_time[-1])
        margin = max(0.35 * (last - first), 4 * (t[1] - t[0]))
        start, end = max(float(t[0]), first - margin), min(float(t[-1]), last + margin)
        return start - 0.01 * (end - start), end  # so that the axis does not cover a force in the first step

    @cached_property
    def rubbing(self) -> NDArray[np.bool_]:
        """(m) points that have stuck or slipped. Points without friction never do."""
        return self.states.per_point() > 0

    @cached_property
    def coefficients(self) -> tuple[float, float] | None:
        """Static and dynamic coefficient of friction, if all pairs with friction have the same ones."""
        contact = self.scene.get("contact", {})
        found = set()
        for pair in contact.get("pair", [contact]):
            given = pair.get("friction", contact.get("friction", 0))
            static = given.get("static", 0) if isinstance(given, dict) else given
            found.add((static, given.get("dynamic", static) if isinstance(given, dict) else static))
        found -= {(0, 0)}
        return next(iter(found)) if len(found) == 1 else None

    def tangential_totals(self) -> tuple[Array, Array, Array]:
        """(k) each: Σ λ of the points with friction, |Σ τ|, and Σ |τ| [N]"""
        normal = self.forces.only(self.rubbing[self.forces.point]).per_row()
        resultant = np.linalg.norm(self.frictions.per_row(), axis=1)
        return normal, resultant, self.frictions.norms().per_row()

    @property
    def roughest(self) -> int:
        """The contact point with the largest impulse of friction."""
        return int(np.argmax(self.frictions.norms().per_point()))

    @property
    def pressures(self) -> Entries:
        """Of the points that carry a force [Pa]; where two creases cross, a point has no area."""
        on_patches = self.forces.only(self.area[self.forces.point] > 0)
        return on_patches.map(lambda force: force / self.area[on_patches.point])

    def loop(self, i: int) -> tuple[Array, Array]:
        """(k) each: tangential displacement [m] and force of friction [N] at point i, along the direction in
        which friction acts most."""
        force = self.frictions.of_point(i)
        _, axes = np.linalg.eigh(force.T @ force)
        along = axes[:, 2] * np.sign(axes[np.argmax(np.abs(axes[:, 2])), 2])
        return self._moved(i) @ along, force @ along

    def _moved(self, i: int) -> Array:
        """(k,3) tangential displacement of point i [m]; with finite rotations, NaN where it is open"""
        if not self.has_entries:
            return self.tangential_displacement[:, i]
        moved = self._entries("tangential_displacement", 3).only(self.states.values != OPEN)
        return moved.of_point(i, np.nan)

    def mixed_row(self) -> int:
        """The contact row in which most points stick while others slip; among equal ones, that with the
        largest friction."""
        stick, slip = (self.states.only(self.states.values == value).counts() for value in (STICK, SLIP))
        fewer = np.minimum(stick, slip)
        _, resultant, _ = self.tangential_totals()
        return int(np.argmax(np.where(fewer == fewer.max(), resultant, -1)))

    def broken(self, values: Array) -> Curve:
        """Contact rows with NaN between episodes, so that no line crosses a time without contact."""
        times, parts = list[Any](), list[Any]()
        for first, stop in self.episodes:
            times += [self.contact_time[first:stop], [np.nan]]
            parts += [values[first:stop], [np.nan]]
        return np.concatenate([*times, []]), np.concatenate([*parts, []])

    @cached_property
    def every(self) -> int:
        """Steps from one contact row to the next. Above 1, a row holds the force of one step, and those of the
        others are not known."""
        every = self.scene.get("output", {}).get("every", 1)
        return every if isinstance(every, int) and not self.static else 1

    def force_curve(self, values: Array) -> Curve:
        """Contact rows of forces for drawing. If every step has a row, forces are constant between rows: draw
        steps that end at these times; they start from 0 and return to 0, so the area below them is the
        impulse. Otherwise draw the rows as points of a curve, whose area is none."""
        if self.every > 1:
            return self.broken(values)
        times, parts = list[Any](), list[Any]()
        for (first, stop), (start, end) in zip(self.episodes, self.spans()):
            times += [[start], self.contact_time[first:stop], [end, np.nan]]
            parts += [[0.0], values[first:stop], [0.0, np.nan]]
        return np.concatenate([*times, []]), np.concatenate([*parts, []])

    @property
    def every_text(self) -> str:
        """ ", every 8th step" for titles; empty if every step has a row"""
        if self.every == 1:
            return ""
        return f", every {self.every}{ {2: 'nd', 3: 'rd'}.get(self.every, 'th')} step"

    def along_normal(self, i: int) -> tuple[Curves, Curves, Curves, Curves]:
        """Motion along the axis of point i: position and velocity of the two sides there, by name, then of
        the centre of mass of each body. Positions are relative to the initial surface of the side
        `axis(i).origin`, so the sides touch where their lines meet.
        """
        axis, names = self.axis(i), self.sides_names(i)
        n = axis.sign * self.normal_of(i)
        place, speed, mean_place, mean_speed = Curves(), Curves(), Curves(), Curves()
        if self.has_entries:
            starts = dict(zip(names, (self.point_a[i] @ n, self.point_b[i] @ n)))
            for name, at in zip(names, self._places(i)):
                place[name] = self.broken(at @ n - starts[axis.origin])
                speed[name] = self.broken(self._rates(at @ n))
        else:
            starts = {names[0]: 0.0, names[1]: axis.sign * self.initial_gap[i]}
            for side, name in zip("ab", names):
                start = starts[name] - starts[axis.origin]
                place[name] = self.broken(start + axis.sign * self.motions["displacement_" + side][:, i])
                speed[name] = self.broken(axis.sign * self.motions["velocity_" + side][:, i])
        for body, v in self.velocity.items():
            along = v @ n
            moved = 0.5 * (along[1:] + along[:-1]) * np.diff(self.time)
            path = np.concatenate([[0], np.cumsum(moved)])
            mean_place[body] = self.time, path + starts.get(body, 0.0) - starts[axis.origin]
            mean_speed[body] = self.time, along
        return place, speed, mean_place, mean_speed

    def axis(self, i: int) -> NormalAxis:
        """The axis of the motion at point i."""
        masses = {name: body.mass for name, body in self.bodies.items()}
        return normal_axis(self.sides_names(i), self.normal_of(i), self.scene, masses)

    def normal_of(self, i: int) -> Array:
        """(3) the normal of point i; with finite rotations, its mean where the point carries a force"""
        if not self.has_entries:
            return self.normal[i]
        here = self.contacts.point == i
        mean = self.contacts.force[here] @ self.contacts.normal[here]
        size = np.linalg.norm(mean)
        return mean / size if size > 0 else self.normal[i]

    def _places(self, i: int) -> tuple[Array, Array]:
        """(k,3) each: where the two sides of point i are in a result with entries [m]; NaN where they are not
        known"""
        found = self.contacts
        of_b = found.place + found.gap[:, None] * found.normal
        shape = len(self.contact_time), len(self.initial_gap)
        a, b = (Entries(found.row, found.point, at, shape).of_point(i, np.nan) for at in (found.place, of_b))
        return a, b

    def places_in(self, first: int, stop: int) -> Array:
        """(·,3) where each point that touches in some rows first touches in them [m]; none without entries"""
        if not self.has_entries:
            return np.zeros((0, 3))
        inside = (self.contacts.row >= first) & (self.contacts.row < stop)
        _, some = np.unique(self.contacts.point[inside], return_index=True)
        return np.asarray(self.contacts.place[inside][some])

    def _rates(self, values: Array) -> Array:
        """(k) mean rates since the row before; NaN after a pause"""
        steps = np.diff(self.contact_time)
        rates = np.where(steps < 1.5 * self.spacing, np.diff(values) / steps, np.nan)
        return np.append(np.full(min(len(values), 1), np.nan), rates)

    def largest_motion(self) -> float:
        """The largest change of the gap of a point while something touches; with finite rotations, of a point with a
        force [m]"""
        if self.has_entries:
            moved = self.initial_gap[self.contacts.point] - self.contacts.gap
        else:
            moved = self.motions["displacement_a"] - self.motions["displacement_b"]
        return float(np.abs(moved).max(initial=0))

    def touching(self, row: int) -> tuple[NDArray[np.int64], Array, Array]:
        """(p) points with friction in a contact row, (p,3) their places [m] and (p,3) normals: with finite
        rotations, of those that carry a force; otherwise of all that stick or slip in the run, at the start
        """
        if not self.has_entries:
            used = np.flatnonzero(self.rubbing)
            return used, self.point_a[used], self.normal[used]
        some = np.flatnonzero((self.contacts.row == row) & self.rubbing[self.contacts.point])
        return self.contacts.point[some], self.contacts.place[some], self.contacts.normal[some]

    @property
    def velocities(self) -> str:
        """Which velocity the rows of the contact hold."""
        if self.has_entries:
            return "means since the row before"
        impulses = self.scene.get("contact", {}).get("scheme") == "impulse"
        return "taken just after the impulses" if impulses else "means over the steps"
