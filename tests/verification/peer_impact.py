# SPDX-License-Identifier: BSD-2-Clause
"""One impact by Ricochet or by a peer: the history of its force, its rebound, and the time that it took. Differences between
two of them, and the table and the figure of a comparison."""
import dataclasses
import shutil

import h5py
import numpy as np

import case
from benchmarks import tables
from benchmarks.equal_accuracy import time_at
from ricochet import errors, programs, timing

SAMPLES = 20001  # of the histories that are compared


@dataclasses.dataclass
class Impact:
    """A finished impact of a body on an obstacle. `parts` are times [s] by program, wall and processor."""

    code: str
    setting: str
    time: np.ndarray  # (k) s
    force: np.ndarray  # (k,3) N on the body, at these times; straight between them
    velocity: np.ndarray  # (3) m/s, mean over the mass, at the end
    spin: np.ndarray  # (3) rad/s, at the end
    energy: float  # J, kinetic and elastic, at the end
    parts: dict

    def total(self, kind="cpu_seconds"):
        return sum(part[kind] for part in self.parts.values())

    def component(self, axis, time):
        """Component of the force [N] at times (s) [s]; 0 before the first and after the last."""
        return np.interp(time, np.append(0.0, self.time), np.append(0.0, self.force @ axis), right=0.0)

    def duration(self, normal):
        """Time [s] during which the normal force exceeds a hundredth of its peak."""
        time = np.linspace(0, self.time[-1], SAMPLES)
        force = self.component(normal, time)
        pressed = time[force > 0.01 * force.max()]
        return float(pressed[-1] - pressed[0])


@dataclasses.dataclass
class Frame:
    """Directions of a comparison (3) and its scales."""

    normal: np.ndarray
    tangent: np.ndarray
    speed: float  # m/s of approach, the unit of velocities
    radius: float  # m; times the spin it is a velocity

    @property
    def axis(self):
        """Axis of the spin."""
        return np.cross(self.normal, self.tangent)


KINDS = {
    "normal": "normal force",
    "tangential": "tangential force",
    "rebound": "normal rebound",
    "slide": "tangential rebound",
    "spin": "spin",
}


def difference(one, other, frame):
    """Differences by kind: forces as the L2 norm over time, relative to that of `other`; velocities relative to the approach.
    `largest` is the largest of them."""
    time = np.linspace(0, max(one.time[-1], other.time[-1]), SAMPLES)
    found = {}
    for kind, axis in (("normal", frame.normal), ("tangential", frame.tangent)):
        theirs = other.component(axis, time)
        found[kind] = np.linalg.norm(one.component(axis, time) - theirs) / np.linalg.norm(theirs)
    change = one.velocity - other.velocity
    found["rebound"] = abs(change @ frame.normal) / frame.speed
    found["slide"] = abs(change @ frame.tangent) / frame.speed
    found["spin"] = abs((one.spin - other.spin) @ frame.axis) * frame.radius / frame.speed
    return found | {"largest": max(found.values())}


def ricochet(scene, settings, steps, folder, body, model):
    """Runs kernel and impact of a scene and measures both. A kernel of an earlier call is computed again.

    @param settings  of kernel and impact, as KEY=VALUE
    @param steps     by name, settings of impacts with this kernel
    @param model     the body with mass and inertia, from `calculix_contact.body_of`
    @return  an Impact for each of `steps`
    """
    shutil.rmtree(folder, ignore_errors=True)
    found = []
    kernel = measured([programs.BIN / "ricochet-kernel", scene, *programs.with_set(settings, folder)])
    for name, more in steps.items():
        words = programs.with_set([*settings, *more, "title=peer"], folder)
        contact = measured([programs.BIN / "ricochet-contact", scene, "--quiet", *words])
        with h5py.File(folder / "peer.result.h5") as file:
            data = file[f"bodies/{body}"]
            momentum = data["momentum"][-1]
            about_centre = data["angular_momentum"][-1] - np.cross(model.centre, momentum)
            force = file["contact/force"][:] @ -file["contact/normal"][:]
            force -= file["contact/tangential_force"][:].sum(axis=1)
            energy = sum(file[f"energy/{kind}"][-1] for kind in ("kinetic", "strain", "residual"))
            # The row of t_k is the mean over the step before, which is the force in its middle to second order.
            middle = file["contact/time"][:] - file["contact"].attrs["step"] / 2
            end = file["time"][-1]
            found.append(
                Impact(
                    "Ricochet",
                    name,
                    np.append(middle, [middle[-1] + file["contact"].attrs["step"], end]),
                    np.concatenate([force, np.zeros((2, 3))]),
                    momentum / model.mass,
                    about_centre / model.inertia,
                    float(energy),
                    {"kernel": kernel, "impact": contact},
                )
            )
    return found


def measured(command):
    """Wall and processor time [s] of a program."""
    done = timing.timed(command)
    if done.status:
        raise errors.SolverError(f"{command[0].name}: {programs.complaint(done.text)}")
    return {"seconds": done.seconds, "cpu_seconds": done.cpu_seconds}


def calculix(setting, found, body):
    """The Impact of a run of `calculix_contact.run`."""
    return Impact(
        "CalculiX",
        setting,
        np.array(found["time"]),
        np.array(found["force"]),
        np.array(found["velocity"][body]),
        np.array(found["spin"][body]),
        found["energy"][-1],
        {"run": {kind: found[kind] for kind in ("seconds", "cpu_seconds")}},
    )


def extrapolated(coarse, fine, ratio, setting):
    """The limit of two impacts with the same steps whose error is proportional to a small quantity.

    @param ratio  this quantity in `coarse` over that in `fine`
    """
    share = 1 / (ratio - 1)
    kinds = ("force", "velocity", "spin", "energy")
    values = {
        kind: getattr(fine, kind) + share * (getattr(fine, kind) - getattr(coarse, kind)) for kind in kinds
    }
    return dataclasses.replace(fine, setting=setting, **values)


# ---- Table and figure ----


def side_by_side(impacts, frame, before):
    """Prints the results of some impacts. @param before  kinetic energy [J] before the impact"""
    table = tables.Table(
        [
            ("", lambda one: f"{one.code}, {one.setting}", ""),
            ("peak normal force (N)", lambda one: (one.force @ frame.normal).max(), ".4f"),
            ("largest friction (N)", lambda one: np.abs(one.force @ frame.tangent).max(), ".4f"),
            ("contact (ms)", lambda one: 1e3 * one.duration(frame.normal), ".3f"),
            ("normal rebound (m/s)", lambda one: one.velocity @ frame.normal, ".4f"),
            ("tangential (m/s)", lambda one: one.velocity @ frame.tangent, ".4f"),
            ("spin (rad/s)", lambda one: one.spin @ frame.axis, ".3f"),
            ("energy kept", lambda one: one.energy / before, ".4f"),
        ]
    )
    for one in impacts:
        table.row(one)


def convergence(impacts, references, frame):
    """Prints the differences of impacts from both references, and their times. Returns the rows.

    @param references  the finest run or the limit of each code, by code
    """
    columns = [("code", "code", ""), ("setting", "setting", "")]
    columns += [(f"{text}, own / other", kind, ".1e") for kind, text in KINDS.items()]
    columns += [("wall (s)", "seconds", ".2f"), ("processor (s)", "cpu_seconds", ".2f")]
    columns += [("parts (processor s)", "parts", "")]
    table, rows = tables.Table(columns), []
    for one in impacts:
        by = {code: difference(one, reference, frame) for code, reference in references.items()}
        own, (other,) = by.pop(one.code), by.values()
        own = None if one is references[one.code] else own
        row = {"code": one.code, "setting": one.setting, "own": own, "other": other}
        row |= {kind: Pair(own and own[kind], other[kind]) for kind in KINDS}
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


def draw(impacts, rows, frame, path):
    """Draws the force histories of some impacts, and the error of all rows against their time."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 3.6), layout="constrained")
    axes = figure.subplots(1, 3)
    drawn = set()
    for one in impacts:
        style = {"color": COLOURS[one.code], "linewidth": 1.2, "linestyle": ":" if one.code in drawn else "-"}
        drawn.add(one.code)
        time = np.linspace(0, one.time[-1], 2001)
        for axis, direction, sign in ((axes[0], frame.normal, 1), (axes[1], frame.tangent, -1)):
            axis.plot(
                1e3 * time, sign * one.component(direction, time), label=f"{one.code}, {one.setting}", **style
            )
    axes[0].set(xlabel="time (ms)", ylabel="normal force (N)")
    axes[1].set(xlabel="time (ms)", ylabel="friction (N)")
    axes[1].set_ylim(bottom=-0.5 * axes[1].get_ylim()[1])
    axes[1].legend(frameon=False, fontsize=7, loc="lower left")
    for which, marker in (("own", "o"), ("other", "x")):
        for code, colour in COLOURS.items():
            points = [(r["cpu_seconds"], r[which]["largest"]) for r in rows if r["code"] == code and r[which]]
            label = f"{code}, from {NAMES[which]}"
            axes[2].loglog(*zip(*points), marker, color=colour, markersize=4, label=label)
    axes[2].set(xlabel="processor time (s)", ylabel="largest difference")
    axes[2].grid(True, which="both", color="#e4e4e4")
    axes[2].set_ylim(top=1)
    axes[2].legend(frameon=False, fontsize=7, loc="upper right")
    tables.save(figure, path)
