# SPDX-License-Identifier: BSD-2-Clause
"""Reads result and kernel files for scripts."""
import contextlib
import tomllib
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ricochet.errors import InputError


VERSION = 1


def is_there(path: Path) -> bool:
    """Whether the file exists and can be opened. Raises InputError if it cannot be opened."""
    try:
        if not path.is_file():
            return False
        with open(path, "rb"):
            return True
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read ({error.strerror}). Change its permissions, or name another one."
        ) from None


@contextlib.contextmanager
def expected(path: Path, program: str = "ricochet-contact") -> Iterator[None]:
    """Raises InputError in place of any exception that the content of a foreign file causes."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of numpy, on numbers that no run has
            yield
    except (InputError, MemoryError):
        raise
    except Exception:
        raise InputError(f"{path}: holds what {program} does not write. Compute it again.") from None


class File:
    """An HDF5 file whose datasets are checked as they are read."""

    def __init__(self, path: Path, kind: str) -> None:
        self.path = path
        if not is_there(path):
            name = (
                "a .kernel.h5 that ricochet-kernel wrote"
                if kind == "ricochet-kernel"
                else "a .result.h5 that ricochet-contact wrote"
            )
            raise InputError(f"{path}: there is no such file. Name {name}.")
        try:
            self.file = h5py.File(path, "r")
        except OSError:
            what = "a damaged or truncated" if h5py.is_hdf5(path) else "not an"
            raise InputError(f"{path}: is {what} HDF5 file. Compute it again.") from None
        if self.text("/", "format") != kind:
            raise InputError(f"{path}: is not a {kind} file. Name a file that Ricochet wrote.")

        version = self.attribute("/", "version")
        if not isinstance(version, (int, np.integer)):
            raise InputError(f"{path}: does not say its format version. Compute it again.")
        if not 1 <= version <= VERSION:
            raise InputError(
                f"{path}: has format version {version}, and this program reads {VERSION}. Use a newer Ricochet."
            )

    def text(self, where: str, name: str) -> str | None:
        """An attribute; None unless it is a text."""
        value = self.attribute(where, name)
        return (
            value.decode(errors="replace")
            if isinstance(value, bytes)
            else value
            if isinstance(value, str)
            else None
        )

    def attribute(self, where: str, name: str) -> Any:
        return self.file[where].attrs.get(name) if where in self.file else None

    def has(self, name: str) -> bool:
        try:
            item = self.file.get(name)
        except RuntimeError:  # links in a circle
            return False
        return isinstance(item, h5py.Dataset) and item.file.filename == self.file.filename

    def names(self, group: str) -> list[str]:
        try:
            return sorted(self.file[group]) if isinstance(self.file.get(group), h5py.Group) else []
        except RuntimeError:  # links in a circle
            return []

    def array(self, name: str, *shape: int | None) -> NDArray[Any]:
        """Values as floats or integers. None in `shape` is a dimension of any length."""
        if not self.has(name):
            raise InputError(f'{self.path}: dataset "{name}" is missing. Compute it again.')
        data = self.file[name]
        if len(data.shape) != len(shape) or any(s not in (None, d) for s, d in zip(shape, data.shape)):
            expected = ", ".join("*" if s is None else str(s) for s in shape)
            raise InputError(
                f'{self.path}: dataset "{name}" has shape {data.shape}, expected ({expected}). '
                "Compute it again."
            )
        if data.nbytes > 64 * self.path.stat().st_size:  # no more memory than the file's size justifies
            raise InputError(
                f'{self.path}: dataset "{name}" claims more than the file can hold. ' "Compute it again."
            )
        try:
            values: NDArray[Any] = data[()]
        except OSError:
            raise InputError(f'{self.path}: dataset "{name}" is damaged. Compute it again.') from None
        if values.dtype.kind not in "fi" or not np.isfinite(values).all():
            raise InputError(
                f'{self.path}: dataset "{name}" holds values that are not finite numbers. '
                "Compute it again."
            )
        return values


class Result:
    """What the pictures need of a result. Of one by table kernels `energy` and `sides` are None: not known."""

    TERMS = ["kinetic", "strain", "residual", "loads", "damping", "contact"]

    LABELS = {
        "kinetic": "kinetic",
        "strain": "strain",
        "residual": "strain of modes left out",
        "loads": "− work of loads",
        "damping": "lost in damping",
        "contact": "lost in contact",
    }

    def __init__(self, path):
        f = self.file = File(path, "ricochet-result")
        self.slug = path.name.removesuffix(".h5").removesuffix(".result")
        self.title = f.text("/", "title") or self.slug
        scene = self.scene()
        self.static = scene.get("contact", {}).get("scheme") == "static"
        self.time = f.array("/time", 1 if self.static else None)
        steps = len(self.time)
        if steps < 2 and not self.static:
            every = scene.get("output", {}).get("every", 1)
            raise InputError(
                f"{path}: holds nothing but the start: nothing to draw. output.every is {every if isinstance(every, int) else '?'}, "
                "which must not exceed the number of steps, time.rate_hz times time.duration."
            )
        by_table = not f.has("/energy/total") and f.has("/contact/gap")
        self.energy = (
            None if by_table else {name: f.array(f"/energy/{name}", steps) for name in ["total"] + self.TERMS}
        )
        self.bodies = f.names("/bodies")
        self.velocity = {body: f.array(f"/bodies/{body}/velocity", steps, 3) for body in self.bodies}
        self.gap = f.array("/contact/initial_gap", None)
        points = len(self.gap)
        if not by_table:
            self.point = f.array("/contact/point_a", points, 3)
            self.normal = f.array("/contact/normal", points, 3)
        self.contact_time = f.array("/contact/time", None)
        rows = len(self.contact_time)
        self.force = f.array("/contact/force", rows, points)
        self.gap_now = f.array("/contact/gap", rows, points)
        self.sides = (
            None
            if by_table
            else {
                name: f.array(f"/contact/{name}", rows, points)
                for name in ["displacement_a", "displacement_b", "velocity_a", "velocity_b"]
            }
        )
        self.spacing = float(np.min(np.diff(self.time), initial=np.inf))  # of rows
        self.episodes = self._episodes()

    def _episodes(self):
        """Index ranges (first, behind last) of contact rows without a pause between them."""
        t = self.contact_time
        if len(t) == 0:
            return []
        pause = np.flatnonzero(np.diff(t) > 1.5 * self.spacing) + 1
        edges = [0, *pause, len(t)]
        return list(zip(edges[:-1], edges[1:]))

    def spans(self):
        """(start, end) of each episode [s]: its first force acts from the row before on."""
        before = np.maximum(np.searchsorted(self.time, self.contact_time - 0.5 * self.spacing) - 1, 0)
        return [(self.time[before[first]], self.contact_time[behind - 1]) for first, behind in self.episodes]

    def impulse(self):
        """(m) impulse of each candidate, up to the factor of the step."""
        return self.force.sum(axis=0)

    def positions(self):
        """Contact points in an order for the eye, where they stand in it [m], and what that is."""
        weight, gap = self.impulse(), self.gap
        used = weight > 0
        first = used & (gap <= gap[used].min() + 1e-3 * np.ptp(gap[used]))  # all, where surfaces are parallel
        away = self.point - weight[first] @ self.point[first] / weight[first].sum()
        spread, axes = np.linalg.eigh(away[used].T @ away[used])
        if spread[1] < 0.1 * spread[2]:  # what touches stands along a line
            along = axes[:, 2] * np.sign(axes[np.argmax(np.abs(axes[:, 2])), 2])
            where, what = away @ along, "position along the contact"
        else:
            where, what = (
                np.linalg.norm(away, axis=1),
                "distance from where the gap was least" if self.static else "distance from the first touch",
            )
        order = np.argsort(where, kind="stable")
        return order, where[order], what

    def scene(self):
        """The resolved scene; {} where the file holds none that can be read."""
        try:
            return tomllib.loads(self.file.text("/", "scene") or "")
        except tomllib.TOMLDecodeError:
            return {}

    def window(self):
        """The contact with a margin before and after, or all when nothing touched [s]."""
        t = self.time
        if not self.episodes or len(t) == 1:
            return t[0], t[-1]
        first, last = self.spans()[0][0], self.contact_time[-1]
        margin = max(0.35 * (last - first), 4 * (t[1] - t[0]))
        start, end = max(t[0], first - margin), min(t[-1], last + margin)
        return start - 0.01 * (end - start), end  # a force from the first step on stands clear of the axis

    def broken(self, values):
        """Times and values of contact rows with a gap between episodes, so that no line spans a time without contact."""
        times, parts = [], []
        for first, behind in self.episodes:
            times += [self.contact_time[first:behind], [np.nan]]
            parts += [values[first:behind], [np.nan]]
        return (np.concatenate(times), np.concatenate(parts)) if times else (np.array([]), np.array([]))

    def held(self, values):
        """The same of forces, which hold from one row to the next: drawn as steps that end at these times, they rise from 0 and
        fall back to it, and the area below them is the impulse."""
        times, parts = [], []
        for (first, behind), (start, end) in zip(self.episodes, self.spans()):
            times += [[start], self.contact_time[first:behind], [end, np.nan]]
            parts += [[0], values[first:behind], [0, np.nan]]
        return (np.concatenate(times), np.concatenate(parts)) if times else (np.array([]), np.array([]))

    def along_normal(self, i):
        """Motion along the normal of point i, each by name as (times, values): place and speed of the two sides there, of
        the mean of each body's mass. Places count from where b's surface was: the sides touch where their lines meet.
        """
        n, gap, names = self.normal[i], self.gap[i], self.sides_names()
        place, speed, mean_place, mean_speed = {}, {}, {}, {}
        for side, name, offset in [("a", names[0], gap), ("b", names[1], 0.0)]:
            place[name] = self.broken(self.sides["displacement_" + side][:, i] - offset)
            speed[name] = self.broken(self.sides["velocity_" + side][:, i])
        for body, v in self.velocity.items():
            along = v @ n
            path = np.concatenate([[0], np.cumsum(0.5 * (along[1:] + along[:-1]) * np.diff(self.time))])
            mean_place[body] = self.time, path - (gap if body == names[0] else 0)
            mean_speed[body] = self.time, along
        return place, speed, mean_place, mean_speed

    def sides_names(self):
        """Names of the two sides if the scene has one pair; with several, a point does not tell its own."""
        contact = self.scene().get("contact", {})
        pairs = contact.get("pair", [contact])
        between = pairs[0].get("between", []) if len(pairs) == 1 else []
        return tuple(between) if len(between) == 2 else ("side a", "side b")


class Skin:
    """The visible surface of a body, moved by its modes."""

    def __init__(self, kernel, attributes, coordinates):
        self.rotation, self.translation = attributes
        self.node = kernel.array("/view/node", None, 3).astype(float)
        self.element = kernel.array("/view/element", None, None).astype(int)
        self.shape = kernel.array("/view/shape", len(self.node), 3, coordinates.shape[1])
        if self.element.size == 0 or self.element.shape[1] not in (2, 3):
            raise InputError(
                f'{kernel.path}: dataset "/view/element" holds neither lines nor triangles. Compute it again.'
            )
        if not (0 <= self.element.min() and self.element.max() < len(self.node)):
            raise InputError(
                f'{kernel.path}: dataset "/view/element" names nodes that do not exist. ' "Compute it again."
            )
        self.rigid = kernel.array("/modes/angular_frequency", coordinates.shape[1]) == 0
        self.coordinates = coordinates

    def at(self, k, start=None, amplify=1.0):
        """(V,3) places of the skin's nodes at snapshot k [m], with motion since snapshot `start` so many times as large."""
        now = (
            self.coordinates[k]
            if start is None
            else self.coordinates[start] + amplify * (self.coordinates[k] - self.coordinates[start])
        )
        return (self.node + self.shape @ now) @ self.rotation.T + self.translation

    def deformation(self, k):
        """The largest displacement by elastic modes at snapshot k [m]."""
        return np.linalg.norm(self.shape[:, :, ~self.rigid] @ self.coordinates[k, ~self.rigid], axis=1).max()

    def outline(self, flat):
        """Where the edges of `rim` lie, (·,2,2)."""
        return flat[self.rim(flat)]

    def rim(self, flat):
        """Edges (·,2) between what faces the viewer and what does not, or with nothing beyond. `flat`: (V,2)"""
        e = self.element
        if e.shape[1] == 2:
            return e
        ab, ac = flat[e[:, 1]] - flat[e[:, 0]], flat[e[:, 2]] - flat[e[:, 0]]
        facing = np.tile(ab[:, 0] * ac[:, 1] > ab[:, 1] * ac[:, 0], 3)
        sides = np.sort(np.concatenate([e[:, [0, 1]], e[:, [1, 2]], e[:, [2, 0]]]), axis=1)
        unique, which, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
        towards = np.bincount(which.ravel(), weights=facing, minlength=len(unique))
        return unique[(count == 1) | ((towards > 0) & (towards < count))]


def are_finite(values, count):
    return np.size(values) == count and np.asarray(values).dtype.kind in "fi" and np.isfinite(values).all()


def skins_of(result, folder):
    """The bodies' skins by name and the times of their snapshots; or why there is none."""
    f = result.file
    if not f.has("/snapshots/time"):
        return None, "the result has no snapshots (set [output] snapshot_every)"
    time = f.array("/snapshots/time", None)
    skins = {}
    for body in result.bodies:
        if not f.has(f"/snapshots/{body}"):
            continue
        where = f"/bodies/{body}"
        name, rotation, translation = (
            f.text(where, "kernel"),
            f.attribute(where, "rotation"),
            f.attribute(where, "translation"),
        )
        if not name or not are_finite(rotation, 9) or not are_finite(translation, 3):
            return None, f"the result does not say where {body} stands"
        path = folder / Path(name).name
        if not is_there(path):
            return None, f"there is no kernel {path} (set --kernels)"
        kernel = File(path, "ricochet-kernel")
        if not kernel.has("/view/node"):
            return None, f"{path.name} has no skin (set [output] view = true)"
        coordinates = f.array(f"/snapshots/{body}", len(time), None)
        skins[body] = Skin(kernel, (np.reshape(rotation, (3, 3)), np.reshape(translation, 3)), coordinates)
    return (skins, time) if skins else (None, "the result has no snapshots of bodies")
