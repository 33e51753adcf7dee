# SPDX-License-Identifier: BSD-2-Clause
"""Results: forces, gaps, motion and energy of an impact as NumPy arrays."""

from __future__ import annotations

import html
import json
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Floats
from ricochet.contacts import Contacts, Entries, Ints
from ricochet.errors import InputError
from ricochet.result_file import File
from ricochet.stress import StressEnvelope


class _Data:
    """Datasets of an open result file. Each is read on first use."""

    def __init__(self, file: File, group: str, rows: int | None = None) -> None:
        self._file, self._group, self._rows = file, group, rows

    def _read(self, name: str, *shape: int | None) -> Floats:
        return np.asarray(self._file.array(f"{self._group}/{name}", *shape))

    def _number(self, name: str) -> float:
        return float(self._file.attribute(self._group, name))

    def _vector(self, name: str) -> Floats:
        return np.asarray(self._file.attribute(self._group, name), dtype=np.float64)


class BodyMotion(_Data):
    """The rigid part of the motion of a body. K rows, at the times `Result.time`; world axes."""

    @cached_property
    def has_pose(self) -> bool:
        """Whether the body turns by finite rotations, so that `position`, `attitude` and `spin` exist."""
        return self._file.has(f"{self._group}/attitude")

    def _of_pose(self, name: str, width: int) -> Floats:
        """Reads a dataset of the pose, with a row for each row of state."""
        if not self.has_pose:
            raise InputError(
                f"{self._file.path}: {self._group.removeprefix('/bodies/')} has no {name}: only free bodies of runs "
                'with motion.rotation = "finite" have one.'
            )
        return self._read(name, self._rows, width)

    @cached_property
    def position(self) -> Floats:
        """(K,3) centre of mass [m]. Raises InputError without finite rotations."""
        return self._of_pose("position", 3)

    @cached_property
    def attitude(self) -> Floats:
        """(K,4) unit quaternion w, x, y, z of the rotation from the axes of the body (of its kernel) to those of
        the world. Raises InputError without finite rotations."""
        return self._of_pose("attitude", 4)

    @cached_property
    def spin(self) -> Floats:
        """(K,3) angular velocity [rad/s]. Raises InputError without finite rotations."""
        return self._of_pose("spin", 3)

    @cached_property
    def velocity(self) -> Floats:
        """(K,3) mass-mean [m/s]"""
        return self._read("velocity", self._rows, 3)

    @cached_property
    def momentum(self) -> Floats:
        """(K,3) [kg m/s]"""
        return self._read("momentum", self._rows, 3)

    @cached_property
    def angular_momentum(self) -> Floats:
        """(K,3) about the origin of the world axes [kg m²/s]"""
        return self._read("angular_momentum", self._rows, 3)

    @cached_property
    def reaction(self) -> Floats:
        """(K,3) force of the supports on the body, mean since the previous row [N]"""
        return self._read("reaction", self._rows, 3)

    @property
    def mass(self) -> float:
        """[kg]"""
        return self._number("mass")

    @property
    def rotation(self) -> Floats:
        """(3,3) world = rotation · body + translation, at the start"""
        return self._vector("rotation").reshape(3, 3)

    @property
    def translation(self) -> Floats:
        """(3) [m]"""
        return self._vector("translation")


class PoseRows(_Data):
    """Poses of a body with finite rotations, or of an obstacle that moves. s rows, at the times of the snapshots or of the
    rows of state; world axes."""

    @cached_property
    def position(self) -> Floats:
        """(s,3) centre of mass, or `point` of an obstacle [m]"""
        return self._read("position", self._rows, 3)

    @cached_property
    def attitude(self) -> Floats:
        """(s,4) unit quaternion w, x, y, z of the rotation from the axes of the body or obstacle to those of the world"""
        return self._read("attitude", self._rows, 4)


class ReceiverMotion(_Data):
    """Motion of a receiver. S rows, at the times `Result.receiver_time`; world axes."""

    @cached_property
    def displacement(self) -> Floats:
        """(S,3) [m]"""
        return self._read("displacement", self._rows, 3)

    @cached_property
    def velocity(self) -> Floats:
        """(S,3) [m/s]"""
        return self._read("velocity", self._rows, 3)

    @cached_property
    def acceleration(self) -> Floats:
        """(S,3) acceleration of the modes [m/s²]"""
        return self._read("acceleration", self._rows, 3)

    @cached_property
    def mean_acceleration(self) -> Floats:
        """(S−1,3) mean acceleration between two rows, from the velocities [m/s²]. Unlike `acceleration`, which is that
        of an instant, it has hardly any aliases of vibration above half of the rate, so it is what filters and spectra
        should get. A receiver in the axes of a body that turns by finite rotations has the acceleration at the rows.
        """
        if self._file.attribute("/", "version") == 2 and self._file.text(self._group, "axes") == "body":
            return self.acceleration[1:]
        time = self._file.array("/receivers/time", None)
        return np.diff(self.velocity, axis=0) / np.diff(time)[:, None]

    @property
    def point(self) -> Floats:
        """(3) initial position [m]"""
        return self._vector("point")


class GaugeHistory(_Data):
    """Stress and strain at a gauge. S rows, at the times `Result.gauge_time`; axes of its body."""

    @cached_property
    def stress(self) -> Floats:
        """(S,6) xx, yy, zz, yz, xz, xy [Pa]"""
        return self._read("stress", self._rows, 6)

    @cached_property
    def strain(self) -> Floats | None:
        """(S) strain along the direction of the gauge [1]; None if it has no direction"""
        if "strain" not in self._file.names(self._group):
            return None
        return self._read("strain", self._rows)

    @property
    def point(self) -> Floats:
        """(3) in the axes of the body [m]"""
        return self._vector("point")


#: values of `Result.state`
OPEN, STICK, SLIP = 0, 1, 2


@dataclass(frozen=True)
class FrictionFigures:
    """The figures of friction in the summary of a run."""

    #: heat of friction, relative to the energy put in; None if none was
    energy_lost: float | None
    #: impulse of friction: for each pair the magnitude of its vector, summed over the pairs [N s]
    impulse: float
    #: longest path that a pressed point slipped [m]
    max_slip: float
    #: number of steps whose forces are known not to be the only solution
    ambiguous_steps: int


def _summary_of(path: Path) -> tuple[str, str | None]:
    """The text of a summary.json, empty if it cannot be read, and the identifier of its run."""
    try:
        text = path.read_text("utf-8")
    except (OSError, ValueError):
        return "", None
    try:
        run = json.loads(text).get("run")
    except (ValueError, AttributeError, RecursionError):
        run = None
    return text, run if isinstance(run, str) else None


class Result(_Data):
    """The result of an impact. Each array is read on first use.

    K rows of state at the times `time`, k rows of contact at the times `contact_time`, m contact points. SI
    units, world axes. docs/formats/result.md defines each quantity. The result keeps its file open, so another run
    that writes a file of the same name does not change it.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Opens a `.result.h5`. Raises InputError, one line, for a file that is missing, damaged or not a
        result, and if the summary beside it is of another run."""
        self.path = Path(path)
        beside = self.path.with_name(f"{self.slug}.summary.json")
        super().__init__(File(self.path, "ricochet-result"), "")
        self._summary, run = _summary_of(beside)  # now, because another run may replace the file
        if run != self.run:  # it may just have replaced both, the summary after the result
            super().__init__(File(self.path, "ricochet-result"), "")
            self._summary, run = _summary_of(beside)
        if run and self.run and run != self.run:
            raise InputError(
                f"{self.path}: is of the run {self.run}, and {beside.name} of the run {run}. Repeat the run."
            )

    @property
    def slug(self) -> str:
        """The start of its file names."""
        return self.path.name.removesuffix(".h5").removesuffix(".result")

    @property
    def title(self) -> str:
        return self._file.text("/", "title") or self.slug

    @property
    def run(self) -> str | None:
        """Identifier of the run, which its summary and its sounds contain as well; None in files of earlier
        versions."""
        return self._file.text("/", "run")

    @cached_property
    def scene(self) -> dict[str, Any]:
        """The resolved scene of the run; empty if the file contains none."""
        try:
            return tomllib.loads(self._file.text("/", "scene") or "")
        except tomllib.TOMLDecodeError:
            return {}

    @cached_property
    def summary(self) -> Mapping[str, Any]:
        """The content of summary.json. Raises InputError if the file is missing or damaged."""
        try:
            return dict(json.loads(self._summary))
        except (ValueError, TypeError):
            raise InputError(f"{self.path}: the summary cannot be read. Repeat the run.") from None

    @property
    def warnings(self) -> list[str]:
        """Warnings that the model may not be valid, one sentence each."""
        return list(self.summary["warnings"])

    # ---- Contact ----

    @cached_property
    def time(self) -> Floats:
        """(K) t [s]: 0 and each `output.every`-th output sample"""
        return self._read("time", None)

    @cached_property
    def contact_time(self) -> Floats:
        """(k) times of the rows whose step has a force [s]"""
        return self._read("contact/time", None)

    @cached_property
    def contact_step(self) -> float:
        """Time between the rows of the contact [s]; infinite for bodies at rest"""
        every_row = np.min(np.diff(self.time), initial=np.inf)  # of files without the attribute
        return float(self._file.attribute("/contact", "step") or every_row)

    @cached_property
    def has_entries(self) -> bool:
        """Whether a contact row has entries for the points that carry a force, and no value for the others."""
        return bool(self._file.attribute("/", "version") == 2)

    @property
    def _shape(self) -> tuple[int, int]:
        """k and m"""
        return len(self.contact_time), len(self.initial_gap)

    @cached_property
    def _entry(self) -> tuple[Ints, Ints]:
        """(e) contact row and contact point of each entry"""
        k, m = self._shape
        point = self._read("contact/point", None)
        edges = np.append(self._read("contact/first", k), len(point))
        known = np.all((point >= 0) & (point < m) & (point == np.floor(point)))
        if not known or np.any(edges != np.floor(edges)) or np.any(np.diff(edges) < 0) or edges[0] != 0:
            raise InputError(f"{self.path}: names contact points that do not exist. Compute it again.")
        return np.repeat(np.arange(k), np.diff(edges).astype(np.int64)), point.astype(np.int64)

    def _entries(self, name: str, *more: int) -> Entries:
        row, point = self._entry
        return Entries(row, point, self._read(f"contact/{name}", len(row), *more), self._shape)

    def _dense(self, name: str, *more: int) -> Floats:
        """Reads a dataset with a row for each contact row and point."""
        return self._read(f"contact/{name}", *self._shape, *more)

    @cached_property
    def contacts(self) -> Contacts:
        """The points that carry a force in each contact row, or stick or slip, with where they are. For results of
        bodies with finite rotations this takes much less memory than `force`, of which most is 0."""
        if self.has_entries:
            row, point = self._entry
            place, normal = self._entries("place", 3).values, self._entries("normal_now", 3).values
        else:
            pressed = self.force != 0
            row, point = np.nonzero(pressed | (self.state != OPEN) if self.has_friction else pressed)
            place, normal = self.point_a[point], self.normal[point]

        def of(name: str, *more: int) -> Floats:
            if self.has_entries:
                return np.asarray(self._entries(name, *more).values)
            return np.asarray(getattr(self, name)[row, point])

        friction: dict[str, Any] = {}
        if self.has_friction:
            for name in ("tangential_force", "tangential_displacement"):
                friction[name] = of(name, 3)
            friction["state"] = self.states.values if self.has_entries else self.state[row, point]
        used, place_of = np.unique(point, return_inverse=True)
        sides = np.array([self.sides_names(i) for i in used], dtype=np.str_).reshape(-1, 2)[place_of]
        return Contacts(
            row,
            point,
            self.contact_time[row],
            sides[:, 0],
            sides[:, 1],
            place,
            normal,
            of("force"),
            of("gap"),
            **friction,
        )

    @cached_property
    def sides(self) -> list[tuple[str, str]]:
        """Names of the two sides of each pair, in the order of the scene."""
        if self.has_entries:
            a, b = (self._file.texts(f"/contact/side_{side}") for side in "ab")
            return list(zip(a, b))
        contact = self.scene.get("contact", {})
        between = [pair.get("between", []) for pair in contact.get("pair", [contact])]
        return [(names[0], names[1]) if len(names) == 2 else ("side a", "side b") for names in between]

    def sides_names(self, i: int) -> tuple[str, str]:
        """Names of the two sides of contact point i. Files of earlier versions do not hold its pair if there are
        several."""
        if len(self.sides) == 1:
            return self.sides[0]
        return self.sides[self.pair[i] - 1] if self.pair is not None else ("side a", "side b")

    @cached_property
    def forces(self) -> Entries:
        """`force` of the points that carry one."""
        return self._entries("force") if self.has_entries else Entries.of(self.force)

    @cached_property
    def force(self) -> Floats:
        """(k,m) compressive force λ ≥ 0 [N], constant over the step that ends at the time of the row"""
        return self.forces.dense() if self.has_entries else self._dense("force")

    @cached_property
    def total_force(self) -> Floats:
        """(K) Σ λ [N], the mean over the time since the previous row; 0 where nothing touches"""
        return self._over_time(self.forces.per_row())

    def _over_time(self, values: Floats) -> Floats:
        """Converts contact rows (k,…) to rows of state (K,…): the mean since the previous row. Contact rows after the last row
        of state belong to none."""
        out = np.zeros((len(self.time), *values.shape[1:]))
        rows = np.searchsorted(self.time, self.contact_time - 1e-6 * min(self.contact_step, 1))
        spacing = float(np.min(np.diff(self.time), initial=np.inf))
        per_row = max(1, round(spacing / self.contact_step)) if np.isfinite(spacing) else 1
        within = rows < len(self.time)
        np.add.at(out, rows[within], values[within] / per_row)
        return out

    @cached_property
    def has_friction(self) -> bool:
        """Whether a pair has friction, so that `tangential_force`, `tangential_displacement` and `state`
        exist."""
        return self._file.has("/contact/state")

    def _of_friction(self, name: str) -> None:
        """Raises InputError without friction."""
        if not self.has_friction:
            raise InputError(
                f"{self.path}: this run has no friction, and hence no {name}. Set contact.friction in the scene."
            )

    @cached_property
    def frictions(self) -> Entries:
        """`tangential_force` of the points that carry one."""
        self._of_friction("tangential_force")
        if self.has_entries:
            return self._entries("tangential_force", 3)
        return Entries.of(self.tangential_force)

    @cached_property
    def states(self) -> Entries:
        """`state` of the points that are not open, or that carry a force."""
        self._of_friction("state")
        if not self.has_entries:
            return Entries.of(self.state)
        return self._entries("state").map(self._checked_states)

    def _checked_states(self, found: Floats) -> NDArray[np.int8]:
        if not np.isin(found, (OPEN, STICK, SLIP)).all():
            raise InputError(
                f'{self.path}: dataset "contact/state" holds values other than 0, 1 and 2. Compute it again.'
            )
        return found.astype(np.int8)

    @cached_property
    def tangential_force(self) -> Floats:
        """(k,m,3) force of friction on the second body of the pair [N], constant over the step that ends at
        the time of the row. The first body feels the opposite. 0 at points without friction. Raises
        InputError if no pair has friction."""
        self._of_friction("tangential_force")
        return self.frictions.dense() if self.has_entries else self._dense("tangential_force", 3)

    @cached_property
    def tangential_displacement(self) -> Floats:
        """(k,m,3) displacement of the first body relative to the second one along the contact [m], at the
        time of the row and without the motion of moving obstacles. 0 at points without friction, and with finite
        rotations at open points. Raises InputError if no pair has friction."""
        self._of_friction("tangential_displacement")
        if self.has_entries:
            return self._entries("tangential_displacement", 3).dense()
        return self._dense("tangential_displacement", 3)

    @cached_property
    def state(self) -> NDArray[np.int8]:
        """(k,m) `OPEN` (0), `STICK` (1) or `SLIP` (2), at the time of the row; 0 at points without friction.
        Raises InputError if no pair has friction."""
        self._of_friction("state")
        if self.has_entries:
            return self.states.dense()
        return self._checked_states(self._dense("state"))

    @cached_property
    def total_tangential_force(self) -> Floats:
        """(K,3) Σ τ, the force of friction on the second bodies [N], the mean over the time since the
        previous row; 0 where nothing touches. Raises InputError if no pair has friction."""
        return self._over_time(self.frictions.per_row())

    @property
    def friction(self) -> FrictionFigures | None:
        """The figures of friction in the summary; None without friction and for bodies at rest."""
        impulse, slip = (self.summary.get(key) for key in ("friction_impulse_ns", "max_slip_m"))
        if impulse is None or slip is None:
            return None
        lost = self.summary.get("energy_lost_friction")
        return FrictionFigures(
            energy_lost=None if lost is None else float(lost),
            impulse=float(impulse),
            max_slip=float(slip),
            ambiguous_steps=int(self.summary.get("ambiguous_steps") or 0),  # null if nothing touched
        )

    @cached_property
    def gap(self) -> Floats:
        """(k,m) [m]; negative values are penetration. With finite rotations, NaN at points without a force."""
        return self._entries("gap").dense(np.nan) if self.has_entries else self._dense("gap")

    @cached_property
    def initial_gap(self) -> Floats:
        """(m) [m]"""
        return self._read("contact/initial_gap", None)

    @cached_property
    def area(self) -> Floats:
        """(m) area of the patches on the first body of the pair [m²]; pressure is force / area"""
        return self._read("contact/area", len(self.initial_gap))

    @cached_property
    def point_a(self) -> Floats:
        """(m,3) contact points on the first body of the pair, at the start [m]"""
        return self._read("contact/point_a", len(self.initial_gap), 3)

    @cached_property
    def point_b(self) -> Floats:
        """(m,3) opposite points on the other surface [m]"""
        return self._read("contact/point_b", len(self.initial_gap), 3)

    @cached_property
    def normal(self) -> Floats:
        """(m,3) unit normals, pointing out of the first body"""
        return self._read("contact/normal", len(self.initial_gap), 3)

    @cached_property
    def pair(self) -> NDArray[np.int64] | None:
        """(m) number of the pair of each contact point, from 1, in the order of the scene; None in older
        files and for sampled responses without modes"""
        if not self._file.has("/contact/pair"):
            return None
        return self._read("contact/pair", len(self.initial_gap)).astype(np.int64)

    # ---- Motion and energy ----

    @cached_property
    def bodies(self) -> dict[str, BodyMotion]:
        return {
            name: BodyMotion(self._file, f"/bodies/{name}", len(self.time))
            for name in self._file.names("/bodies")
        }

    @cached_property
    def receivers(self) -> dict[str, ReceiverMotion]:
        """Motion of the receivers, by the names in `[[output.receiver]]`."""
        names = [name for name in self._file.names("/receivers") if name != "time"]
        return {
            name: ReceiverMotion(self._file, f"/receivers/{name}", len(self.receiver_time)) for name in names
        }

    @cached_property
    def receiver_time(self) -> Floats:
        """(S) times of the rows of receivers [s]: 0 and each output sample, or fewer with
        `output.receivers_rate_hz`. Raises InputError if the scene has no receivers."""
        return self._read("receivers/time", None)

    @cached_property
    def gauges(self) -> dict[str, GaugeHistory]:
        """Stress and strain at the gauges, by the names in `[[output.gauge]]`."""
        names = [name for name in self._file.names("/gauges") if name != "time"]
        return {name: GaugeHistory(self._file, f"/gauges/{name}", len(self.gauge_time)) for name in names}

    @cached_property
    def gauge_time(self) -> Floats:
        """(S) times of the rows of gauges [s], as of receivers; at rest, those of the rows. Raises InputError if the scene
        has no gauges."""
        return self._read("gauges/time", None)

    @cached_property
    def stress(self) -> dict[str, StressEnvelope]:
        """The largest stresses of the run at the nodes of the visualisation surfaces, by body. Empty without
        `output.stress`."""
        names = [field.name for field in fields(StressEnvelope)]
        return {
            body: StressEnvelope(**{name: self._read(f"stress/{body}/{name}", None) for name in names})
            for body in self._file.names("/stress")
        }

    def surface_stress(self, body: str, kernels: str | os.PathLike[str] | None = None) -> Floats:
        """(s,V,6) stress at the nodes of the visualisation surface of a body at the snapshots, xx, yy, zz, yz, xz, xy in the
        axes of the body [Pa]; `ricochet.von_mises` and `ricochet.principal_stresses` take it.

        @param kernels  folder of the kernels; by default, that of the result
        Raises InputError if the result has no snapshots of this body, or if its kernel has no stress.
        """
        fields, amplitudes = self.stress_fields(body, kernels)
        return np.moveaxis(fields @ amplitudes.T.astype(fields.dtype), 2, 0).astype(float)

    def stress_fields(
        self, body: str, kernels: str | os.PathLike[str] | None = None
    ) -> tuple[NDArray[np.float32], Floats]:
        """(V,6,r) fields in single precision and (s,r) amplitudes whose products are `surface_stress`. Large surfaces are
        treated in parts. Raises InputError, as `surface_stress`."""
        from ricochet.pictures.static_part import static_part

        if body not in self.snapshots:
            raise InputError(
                f"{self.path}: has no snapshots of {body}. Set output.snapshot_every and run again."
            )
        name = Path(self._file.text(f"/bodies/{body}", "kernel") or "").name
        kernel = File(Path(kernels or self.path.parent) / name, "ricochet-kernel")
        if not kernel.has("/view/stress/shape"):
            raise InputError(
                f"{kernel.path}: holds no stress of its surface. Set output.stress = true and compute it again."
            )
        modal = self.snapshots[body]
        shape = kernel.array("/view/stress/shape", None, 6, modal.shape[1])
        static, amplitudes = static_part(self._file, kernel, body, len(modal), "/view/stress", 6)
        return np.concatenate([shape, static], axis=2), np.concatenate([modal, amplitudes], axis=1)

    @cached_property
    def energy(self) -> dict[str, Floats]:
        """(K) each [J]: `kinetic`, `strain`, `residual` (of the static response), `loads` (work so far of
        loads, supports and moving obstacles), `damping` and `contact` (lost so far), `friction` (its heat so
        far), and `total` = kinetic + strain + residual − loads. Empty for sampled responses.
        """
        if not self._file.has("/energy/total"):
            return {}
        out = {name: self._read(f"energy/{name}", len(self.time)) for name in _TERMS if name != "friction"}
        written = self.has_friction or self._file.has("/energy/friction")  # not in files of older versions
        out["friction"] = (
            self._read("energy/friction", len(self.time)) if written else np.zeros(len(self.time))
        )
        return out

    @cached_property
    def ledger(self) -> Floats:
        """(K) total + damping + contact + friction [J], which stays constant to round-off in a run; for
        bodies at rest no ledger is kept. Raises InputError for sampled responses."""
        if not self.energy:
            raise InputError(f"{self.path}: runs with sampled responses keep no energy ledger.")
        return np.asarray(sum(self.energy[name] for name in ("total", "damping", "contact", "friction")))

    @cached_property
    def snapshots(self) -> dict[str, Floats]:
        """(s,N) modal coordinates by body [kg^1/2 m], and the (s) times as `time` [s]. Empty without
        `output.snapshot_every`."""
        return {
            name: self._read(f"snapshots/{name}", *([None] if name == "time" else [None, None]))
            for name in self._file.names("/snapshots")
        }

    @cached_property
    def obstacles(self) -> dict[str, PoseRows]:
        """Poses at the times `time`, of the obstacles that move. Of half-spaces, only the motion along the normal counts."""
        groups = [f"/obstacles/{number}" for number in self._file.names("/obstacles")]
        return {
            self._file.text(group, "name") or group: PoseRows(self._file, group, len(self.time))
            for group in groups
            if self._file.has(f"{group}/position")
        }

    @cached_property
    def poses(self) -> dict[str, PoseRows]:
        """Poses at the snapshots, of the bodies with finite rotations. A point X of the body, in its axes, is at
        position + A (X − centre + u), with the rotation matrix A of the attitude, `Kernel.centre`, and the
        deformation u by modes and static response."""
        return {
            name: PoseRows(self._file, f"/pose/{name}", len(self._read("snapshots/time", None)))
            for name in self._file.names("/pose")
        }

    # ---- Display ----

    def figures(self) -> dict[str, str]:
        """The main figures by name, as text with units."""
        out = {}
        for key, name, unit in _FIGURES:
            value = self.summary.get(key)
            if isinstance(value, (int, float)):
                out[name] = f"{value:.6g}{unit}"
        for body, velocity in self.summary.get("exit_velocity", {}).items():
            out[f"exit velocity of {body}"] = "[" + ", ".join(f"{v:.4g}" for v in velocity) + "] m/s"
        for number, pair in enumerate(self.summary.get("pairs", ()), 1):
            out[f"force of pair {number}"] = f"{pair['force_n']:.6g} N on {pair['contact_points']} points"
        estimate = self.summary.get("error_estimate")
        if estimate and estimate.get("total") is not None:
            out["error estimate"] = f"{estimate['total']:.2g}"
        return out

    def __repr__(self) -> str:
        figures = "; ".join(f"{name} {value}" for name, value in list(self.figures().items())[:4])
        return f"<Result {self.title!r}: {figures}; {self.path}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{html.escape(name)}</th><td>{html.escape(value)}</td></tr>"
            for name, value in self.figures().items()
        )
        warned = "".join(f"<p><b>Warning:</b> {html.escape(warning)}</p>" for warning in self.warnings)
        return f"<b>{html.escape(self.title)}</b>{warned}<table>{rows}</table>{self._force_drawing()}"

    def _force_drawing(self) -> str:
        """The total force over the time of contact as a small SVG. Empty if nothing touches or the result
        has only one time."""
        if len(self.contact_time) == 0 or len(self.time) < 3:
            return ""
        step = self.time[1] - self.time[0]
        margin = 0.1 * (self.contact_time[-1] - self.contact_time[0]) + 2 * step
        first, last = np.searchsorted(
            self.time, [self.contact_time[0] - margin, self.contact_time[-1] + margin]
        )
        t, force = self.time[first:last], self.total_force[first:last]
        width, height, most = 420, 120, max(1, -(-len(t) // 800))
        if most > 1:  # keep the peak of each group
            groups = np.arange(0, len(t), most)
            t, force = t[groups], np.maximum.reduceat(force, groups)
        peak, (scale, unit) = float(force.max()), _prefix(float(t[-1]))
        x = (t - t[0]) / max(t[-1] - t[0], step) * width
        y = height - force / (peak or 1) * (height - 8)
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y))
        return (
            f'<svg width="{width}" height="{height + 20}" role="img" aria-label="contact force over time">'
            f'<polyline points="0,{height} {points} {width},{height}" fill="#b03a4830" stroke="#b03a48"/>'
            f'<g font-size="11" fill="currentColor"><text x="4" y="10">{peak:.4g} N</text>'
            f'<text x="0" y="{height + 15}">{t[0] * scale:.4g} {unit}</text>'
            f'<text x="{width}" y="{height + 15}" text-anchor="end">{t[-1] * scale:.4g} {unit}</text>'
            "</g></svg>"
        )


#: datasets of the energy ledger
_TERMS = ("kinetic", "strain", "residual", "loads", "damping", "contact", "friction", "total")

#: main figures: key in the summary, name and unit
_FIGURES = (
    ("contact_start_s", "contact starts", " s"),
    ("contact_end_s", "contact ends", " s"),
    ("peak_force_n", "peak force", " N"),
    ("impulse_ns", "impulse", " N s"),
    ("restitution", "restitution", ""),
    ("energy_lost_contact", "energy lost to contact", " of the energy put in"),
    ("energy_lost_friction", "heat of friction", " of the energy put in"),
    ("friction_impulse_ns", "impulse of friction", " N s"),
    ("max_slip_m", "longest slip", " m"),
    ("ambiguous_steps", "steps with several solutions", ""),
    ("energy_drift", "energy drift", ""),
    ("max_penetration_m", "deepest penetration", " m"),
    ("candidates", "contact points", ""),
    ("max_active", "most that touch at once", ""),
    ("imbalance", "imbalance", ""),
)


def _prefix(seconds: float) -> tuple[float, str]:
    return (1.0, "s") if seconds >= 1 else (1e3, "ms") if seconds >= 1e-3 else (1e6, "µs")
