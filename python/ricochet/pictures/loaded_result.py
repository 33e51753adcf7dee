# SPDX-License-Identifier: BSD-2-Clause
"""A result prepared for pictures: episodes of contact, the time around them, and motion along the normal of a
point."""
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.pictures.normal_axis import NormalAxis, normal_axis
from ricochet.result import SLIP, STICK, Result

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
    """A result whose arrays are read at once. A run with sampled responses has no `energy` and no `sides`."""

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
        self.sides: dict[str, Array] = {}
        if self.energy:
            shape = (len(self.contact_time), len(self.initial_gap))
            for name in ("displacement_a", "displacement_b", "velocity_a", "velocity_b"):
                self.sides[name] = self._read(f"contact/{name}", *shape)
            self.point_a, self.normal  # reading checks the arrays and raises InputError for damaged ones
        self.force, self.gap
        if self.has_friction:
            self.tangential_force, self.tangential_displacement, self.state
        self.spacing = self.contact_step
        self.episodes = self._episodes()
        if low_pass:
            self.force = low_passed(self.force, self.contact_time, self.spacing, low_pass)

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

    def impulse(self) -> Array:
        """(m) impulse of each contact point, divided by the step [N]"""
        return np.asarray(self.force.sum(axis=0))

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
        return np.asarray((self.state > 0).any(axis=0))

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
        normal = self.force[:, self.rubbing].sum(axis=1)
        resultant = np.linalg.norm(self.tangential_force.sum(axis=1), axis=1)
        return normal, resultant, np.linalg.norm(self.tangential_force, axis=2).sum(axis=1)

    @property
    def roughest(self) -> int:
        """The contact point with the largest impulse of friction."""
        return int(np.argmax(np.linalg.norm(self.tangential_force, axis=2).sum(axis=0)))

    def loop(self, i: int) -> tuple[Array, Array]:
        """(k) each: tangential displacement [m] and force of friction [N] at point i, along the direction in
        which friction acts most."""
        force = self.tangential_force[:, i]
        _, axes = np.linalg.eigh(force.T @ force)
        along = axes[:, 2] * np.sign(axes[np.argmax(np.abs(axes[:, 2])), 2])
        return self.tangential_displacement[:, i] @ along, force @ along

    def mixed_row(self) -> int:
        """The contact row in which most points stick while others slip; among equal ones, that with the
        largest friction."""
        fewer = np.minimum((self.state == STICK).sum(axis=1), (self.state == SLIP).sum(axis=1))
        _, resultant, _ = self.tangential_totals()
        return int(np.argmax(np.where(fewer == fewer.max(), resultant, -1)))

    def broken(self, values: Array) -> Curve:
        """Contact rows with NaN between episodes, so that no line crosses a time without contact."""
        times, parts = list[Any](), list[Any]()
        for first, stop in self.episodes:
            times += [self.contact_time[first:stop], [np.nan]]
            parts += [values[first:stop], [np.nan]]
        return np.concatenate([*times, []]), np.concatenate([*parts, []])

    def as_steps(self, values: Array) -> Curve:
        """Contact rows of forces, which are constant between rows, for drawing as steps that end at these
        times. Forces start from 0 and return to 0, so the area below them is the impulse."""
        times, parts = list[Any](), list[Any]()
        for (first, stop), (start, end) in zip(self.episodes, self.spans()):
            times += [[start], self.contact_time[first:stop], [end, np.nan]]
            parts += [[0.0], values[first:stop], [0.0, np.nan]]
        return np.concatenate([*times, []]), np.concatenate([*parts, []])

    def along_normal(self, i: int) -> tuple[Curves, Curves, Curves, Curves]:
        """Motion along the axis of point i: position and velocity of the two sides there, by name, then of
        the centre of mass of each body. Positions are relative to the initial surface of the side
        `axis(i).origin`, so the sides touch where their lines meet.
        """
        axis, gap, names = self.axis(i), self.initial_gap[i], self.sides_names(i)
        n = axis.sign * self.normal[i]
        starts = {names[0]: 0.0, names[1]: axis.sign * gap}
        place, speed, mean_place, mean_speed = Curves(), Curves(), Curves(), Curves()
        for side, name in zip("ab", names):
            start = starts[name] - starts[axis.origin]
            place[name] = self.broken(start + axis.sign * self.sides["displacement_" + side][:, i])
            speed[name] = self.broken(axis.sign * self.sides["velocity_" + side][:, i])
        for body, v in self.velocity.items():
            along = v @ n
            path = np.concatenate([[0], np.cumsum(0.5 * (along[1:] + along[:-1]) * np.diff(self.time))])
            mean_place[body] = self.time, path + starts.get(body, 0.0) - starts[axis.origin]
            mean_speed[body] = self.time, along
        return place, speed, mean_place, mean_speed

    def axis(self, i: int) -> NormalAxis:
        """The axis of the motion at point i."""
        masses = {name: body.mass for name, body in self.bodies.items()}
        return normal_axis(self.sides_names(i), self.normal[i], self.scene, masses)

    @property
    def velocities(self) -> str:
        """Which velocity the rows of the contact hold."""
        impulses = self.scene.get("contact", {}).get("scheme") == "impulse"
        return "taken just after the impulses" if impulses else "means over the steps"

    def sides_names(self, i: int) -> tuple[str, str]:
        """Names of the two sides of point i. Files of earlier versions do not hold its pair if there are
        several."""
        contact = self.scene.get("contact", {})
        pairs = contact.get("pair", [contact])
        if len(pairs) == 1:
            pair = pairs[0]
        else:
            pair = pairs[self.pair[i] - 1] if self.pair is not None else {}
        between = pair.get("between", [])
        return (between[0], between[1]) if len(between) == 2 else ("side a", "side b")
