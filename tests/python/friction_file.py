# SPDX-License-Identifier: BSD-2-Clause
"""Makes result files with friction without a run: a block that presses on an obstacle and is dragged to and fro over it.

Each point is a normal and a tangential spring, so the state, the force and the heat of each step follow from the return
mapping of Coulomb's law alone. The ledger of the file is exact.
"""

import contextlib
import json
import shutil

import h5py
import numpy as np

MU = 0.4
STIFF, ACROSS = 4e6, 3e6  # N/m, of a point along the normal and across it
STEP, STEPS = 1e-5, 400
AREA = 1e-6  # m², of a point

SCENE = """title = "{title}"
[bodies.block]
mesh = "block.msh"
velocity = [0.1, 0, -1]
[bodies.block.material]
density = 2700
young = 70e9
poisson = 0.3
[obstacles.floor]
normal = [0, 0, 1]
point = [0, 0, 0]
[contact]
kernel = "modes"
scheme = "compliant"
[[contact.pair]]
between = ["block", "floor"]
{friction}
[time]
rate_hz = 1e5
duration = {duration}
[output]
every = 1
snapshot_every = 4
view = true
"""


def places(form):
    """(m,3) contact points: "patch" over a disc, "line" along x, "point", or several "cells" of a large disc."""
    if form == "point":
        return np.zeros((1, 3))
    if form == "line":
        return np.stack([np.linspace(-4e-3, 4e-3, 41), np.zeros(41), np.zeros(41)], axis=1)
    axis = np.arange(-5 if form == "patch" else -12, 6 if form == "patch" else 13) * 1e-3
    x, y = map(np.ravel, np.meshgrid(axis, axis))
    inside = np.hypot(x, y) <= axis[-1] + 1e-9
    return np.stack([x, y, 0 * x], axis=1)[inside]


class Drag:
    """The histories of the points. m points, a row for each of STEPS steps."""

    def __init__(self, form="patch", steps=STEPS, touches=1):
        self.point = places(form)
        m = len(self.point)
        self.time = STEP * np.arange(steps + 1)
        radius = np.linalg.norm(self.point, axis=1)
        self.gap = 2e-6 * (radius / max(radius.max(), 1e-9)) ** 2
        phase = self.time / self.time[-1]
        depth = 3e-6 * np.sin(touches * np.pi * (phase - 0.1) / 0.8)
        depth[(phase < 0.1) | (phase > 0.9)] = -1e-6
        sway = 1.6e-6 * np.sin(2 * np.pi * 2.5 * phase)
        self.moved = np.stack([sway, 0.35e-6 * (1 - np.cos(2 * np.pi * 2 * phase)), 0 * phase], axis=1)
        self.force = np.maximum(0, STIFF * (depth[:, None] - self.gap))
        self.tangential = np.zeros((steps + 1, m, 3))
        self.state = np.zeros((steps + 1, m))
        self.heat = np.zeros(steps + 1)
        stretch = np.zeros((m, 3))
        for k in range(1, steps + 1):
            trial = ACROSS * (stretch + self.moved[k] - self.moved[k - 1])
            size, bound = np.linalg.norm(trial, axis=1), MU * self.force[k]
            slips = size > bound
            force = trial * np.minimum(1, bound / np.maximum(size, 1e-300))[:, None]
            slip = (trial - force) / ACROSS
            stretch = force / ACROSS
            self.tangential[k] = force
            self.state[k] = np.where(self.force[k] > 0, np.where(slips, 2, 1), 0)
            self.heat[k] = self.heat[k - 1] + np.sum(force * slip)

    @property
    def slipped(self):
        """Tangential displacement of the points: that of the block without the stretch of their springs."""
        return self.moved[:, None] - self.tangential / ACROSS

    @property
    def rows(self):
        return np.flatnonzero((self.force > 0).any(axis=1))


def write(path, form="patch", friction=f"friction = {MU}", **more):
    """Writes PATH.result.h5, its summary and, for a page in motion, a kernel. Returns the result and the histories.

    friction: lines of the scene's pair; None: a run without friction
    """
    drag = Drag(form, **more)
    title, rows, m = path.name, drag.rows, len(drag.point)
    result = path.with_name(f"{title}.result.h5")
    scene = SCENE.format(title=title, friction=friction or "", duration=drag.time[-1])
    stored = 0.5 * (drag.force**2).sum(axis=1) / STIFF
    stretched = 0.5 * (drag.tangential**2).sum(axis=(1, 2)) / ACROSS
    fall = -0.06 * np.cos(np.pi * drag.time / drag.time[-1])
    velocity = np.stack([np.gradient(drag.moved[:, 0], STEP), 0 * drag.time, fall], 1)
    mass = 0.2
    kinetic = 0.5 * mass * (velocity**2).sum(axis=1)
    heat = drag.heat if friction else 0 * drag.heat
    lost = 1e-4 * kinetic[0] * drag.time / drag.time[-1]
    energy = {
        "kinetic": kinetic,
        "strain": stored,
        "residual": stretched,
        "damping": 0.5 * lost,
        "contact": lost,
    }
    energy["loads"] = sum(energy.values()) + heat - kinetic[0]
    energy["total"] = kinetic + stored + stretched - energy["loads"]
    energy["friction"] = heat
    result.unlink(missing_ok=True)  # a reader may hold an earlier one
    with h5py.File(result, "w") as file:
        file.attrs.update(format=np.bytes_("ricochet-result"), version=1, title=np.bytes_(title))
        file.attrs.update(scene=np.bytes_(scene.encode()), created_by=np.bytes_("a test"))
        file["time"] = drag.time
        contact = file.create_group("contact")
        contact.attrs["step"] = STEP
        contact["point_a"], contact["point_b"] = drag.point + [0, 0, 1e-6], drag.point
        contact["normal"] = np.tile([0.0, 0, -1], (m, 1))
        contact["initial_gap"], contact["area"] = drag.gap, np.full(m, AREA)
        contact["time"], contact["force"] = drag.time[rows], drag.force[rows]
        contact["gap"] = np.maximum(0, drag.gap - drag.force[rows] / STIFF)
        for name in ("displacement_a", "velocity_a"):
            contact[name] = 1e-6 * np.sin(1e3 * drag.time[rows])[:, None] * np.ones(m)
        for name in ("displacement_b", "velocity_b"):
            contact[name] = np.zeros((len(rows), m))
        contact["persistency"] = 0 * drag.time
        if friction:
            contact["tangential_force"] = drag.tangential[rows]
            contact["tangential_displacement"] = drag.slipped[rows]
            contact["state"] = drag.state[rows]
        for name, values in energy.items():
            file[f"energy/{name}"] = values
        body = file.create_group("bodies/block")
        body.attrs.update(
            kernel=np.bytes_(f"{title}.kernel.h5"),
            mass=mass,
            rotation=np.eye(3).ravel(),
            translation=np.zeros(3),
        )
        for name, factor in [("velocity", 1), ("momentum", mass), ("angular_momentum", 0), ("reaction", 0)]:
            body[name] = factor * velocity
        file["snapshots/time"] = drag.time[::4]
        file["snapshots/block"] = np.concatenate(
            [drag.moved[::4], 1e-6 * np.sin(4e3 * drag.time[::4, None])], 1
        )
    impulse = np.linalg.norm(drag.tangential[rows].sum(axis=(0, 1))) * STEP
    slip = (np.linalg.norm(np.diff(drag.slipped, axis=0), axis=2) * (drag.force[1:] > 0)).sum(axis=0).max()
    parts = np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if len(rows) else []
    total = drag.force.sum(axis=1)
    episodes = [
        {
            "start_s": drag.time[part[0]] - STEP,
            "end_s": drag.time[part[-1]],
            "impulse_ns": total[part].sum() * STEP,
            "peak_force_n": total[part].max(),
        }
        for part in parts
    ]
    figures = {
        "contact_start_s": drag.time[rows[0]] - STEP if len(rows) else None,
        "contact_end_s": drag.time[rows[-1]] if len(rows) else None,
        "contact_steps": len(rows),
        "episodes": episodes,
        "peak_force_n": drag.force.sum(axis=1).max(),
        "impulse_ns": drag.force.sum() * STEP,
        "exit_velocity": {"block": velocity[-1].tolist()},
        "restitution": 0.9,
        "energy_drift": 1e-14,
        "energy_lost_contact": 1e-4,
        "energy_lost_friction": heat[-1] / kinetic[0] if friction else None,
        "friction_impulse_ns": impulse if friction else None,
        "max_slip_m": slip if friction else None,
        "ambiguous_steps": 3 if friction else None,
        "max_penetration_m": 0.0,
        "candidates": m,
        "unpaired": 0,
        "max_active": int((drag.force > 0).sum(axis=1).max()),
        "modes": {"block": 4},
        "sounds": {},
        "error_estimate": None,
        "warnings": [],
        "real_time_factor": 2.0,
        "wall_s": 0.5,
    }
    path.with_name(f"{title}.summary.json").write_text(json.dumps(figures))
    kernel(path.with_name(f"{title}.kernel.h5"))
    return result, drag


@contextlib.contextmanager
def edited(path):
    """The file, open for changes. Readers that hold it keep the old content."""
    changed = path.with_suffix(".changed")
    shutil.copy(path, changed)
    with h5py.File(changed, "r+") as file:
        yield file
    changed.rename(path)


def kernel(path):
    """A kernel with the visualisation surface of the block: three translations and a mode that bends it."""
    node = np.array(list(np.ndindex(2, 2, 2))) * [20e-3, 20e-3, 12e-3] - [10e-3, 10e-3, 0]
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    element = np.array([[a, *pair] for a, b, c, d in sides for pair in ((b, c), (c, d))])
    shape = np.zeros((len(node), 3, 4))
    shape[:, range(3), range(3)] = 1
    shape[:, 2, 3] = np.abs(node[:, 0]) * node[:, 2] / 1e-4
    path.unlink(missing_ok=True)
    with h5py.File(path, "w") as file:
        file.attrs.update(
            format=np.bytes_("ricochet-kernel"), version=1, hash=np.bytes_("0" * 64), body=np.bytes_("block")
        )
        file.attrs.update(
            mesh_sha256=np.bytes_("0" * 64), created_by=np.bytes_("a test"), dofs=24, elements=5, order=1
        )
        file.attrs["supported"], file.attrs["mass"] = 0, 1.0
        modes = file.create_group("modes")
        modes.attrs["basis"] = np.bytes_("modes")
        modes["angular_frequency"] = np.array([0.0, 0, 0, 4e3])
        modes["decay_rate"] = np.array([0.0, 0, 0, 40])
        file["loads/body_force"] = np.eye(3, 4)
        file["surface/normal"], file["surface/shape"] = np.zeros((0, 3)), np.zeros((0, 3, 4))
        certificate = modes.create_group("certificate")
        certificate.attrs.update(complete=1, upto_hz=1e4, count_found=4, left_out=0, flexibility_error=0.0)
        file["view/node"], file["view/element"], file["view/shape"] = node, element, shape.astype("f4")
