# SPDX-License-Identifier: BSD-2-Clause
"""One impact by Ricochet or by a peer: the history of its force, its rebound, and the time that it took. Differences between
two of them."""
import dataclasses
import shutil
import tomllib

import h5py
import numpy as np

import calculix_contact
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
    area: np.ndarray = None  # (k) m² that is pressed, at `time`

    def total(self, kind="cpu_seconds"):
        return sum(part[kind] for part in self.parts.values())

    def component(self, axis, time):
        """Component of the force [N] at times (s) [s]; 0 before the first and after the last."""
        return np.interp(time, np.append(0.0, self.time), np.append(0.0, self.force @ axis), right=0.0)

    def width(self, frame, time):
        """Width [m] of a contact that is a strip at times (s) [s]; 0 before the first and after the last."""
        width = frame.copies * self.area / frame.depth
        return np.interp(time, np.append(0.0, self.time), np.append(0.0, width), right=0.0)

    def duration(self, normal):
        """Time [s] during which the normal force exceeds a hundredth of its peak."""
        time = np.linspace(0, self.time[-1], SAMPLES)
        force = self.component(normal, time)
        pressed = time[force > 0.01 * force.max()]
        return float(pressed[-1] - pressed[0])


@dataclasses.dataclass
class Frame:
    """Directions of a comparison (3), its scales, and the keys of KINDS that it compares."""

    normal: np.ndarray
    tangent: np.ndarray
    speed: float  # m/s of approach, the unit of velocities
    radius: float  # m; times the spin it is a velocity
    kinds: tuple = ("normal", "tangential", "rebound", "slide", "spin")
    copies: int = 1  # of the model that make the whole, with its images in planes of symmetry: multiplies the forces that are shown
    depth: float = 0.0  # m across a contact that is a strip; 0: its width is not compared

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
    `largest` is the largest of them. `width` is apart, as a force: it changes by whole nodes or points of integration.
    """
    time = np.linspace(0, max(one.time[-1], other.time[-1]), SAMPLES)
    velocity, spin = one.velocity - other.velocity, one.spin - other.spin

    def of_force(axis):
        theirs = other.component(axis, time)
        return np.linalg.norm(one.component(axis, time) - theirs) / np.linalg.norm(theirs)

    measures = {
        "normal": lambda: of_force(frame.normal),
        "tangential": lambda: of_force(frame.tangent),
        "rebound": lambda: abs(velocity @ frame.normal) / frame.speed,
        "slide": lambda: abs(velocity @ frame.tangent) / frame.speed,
        "spin": lambda: abs(spin @ frame.axis) * frame.radius / frame.speed,
    }
    found = {kind: measures[kind]() for kind in frame.kinds}
    found |= {"largest": max(found.values())}
    if frame.depth:
        theirs = other.width(frame, time)
        found["width"] = np.linalg.norm(one.width(frame, time) - theirs) / np.linalg.norm(theirs)
    return found


def bodies(path, words, folder):
    """Meshes the bodies of a scene for both codes.

    @param words   settings of the scene, as KEY=VALUE
    @return  the resolved scene, its bodies for CalculiX by name, and the settings with which Ricochet reads the same meshes
    """
    scene = tomllib.loads(programs.resolved(path, programs.with_set(words)))
    found, words = {}, list(words)
    for name, table in scene["bodies"].items():
        mesh = folder / f"{name}.msh"
        calculix_contact.mesh_file(path.parent / table["mesh"], table["geometry"], table["order"], mesh)
        found[name] = calculix_contact.body_of(mesh, name, table)
        words += [f"bodies.{name}.mesh={programs.toml(str(mesh))}", f"bodies.{name}.geometry={{}}"]
    return scene, found, words


def half_space(scene, name, body):
    """An obstacle of a resolved scene for CalculiX, large enough for this body."""
    table = scene["obstacles"][name]
    size = 2 * float(np.ptp(body.node, axis=0).max())
    return calculix_contact.HalfSpace(name, table["point"], table["normal"], size)


def sweep(scene, settings, steps, folder, body, model):
    """Yields impacts by Ricochet. Each counts the whole time of its kernel.

    @param steps  steps [µs] by band of the modes [kHz]
    """
    for band, of_band in steps.items():
        impacts = {f"{band:g} kHz, {step:g} µs": [f"time.rate_hz={1e6 / step!r}"] for step in of_band}
        words = [*settings, f"modes.up_to_hz={1e3 * band}"]
        yield from ricochet(scene, words, impacts, folder / f"{band:g}-khz", body, model)


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
            if "contact/tangential_force" in file:
                force -= file["contact/tangential_force"][:].sum(axis=1)
            area = (file["contact/force"][:] > 0) @ file["contact/area"][:]
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
                    np.linalg.solve(model.inertia, about_centre),
                    float(energy),
                    {"kernel": kernel, "impact": contact},
                    np.append(area, [0.0, 0.0]),
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
        np.array(found.get("area", [])),  # runs that were kept before areas were read have none
    )


def finished(runs, body):
    """The impacts of a body in CalculiX's runs that reach the end. Names the others.

    @param runs  setting and data of `calculix_contact.run`
    """
    found = []
    for setting, data in runs:
        if data["complete"]:
            found.append(calculix(setting, data, body))
        else:
            print(f"CalculiX, {setting}: stops at {1e3 * data['time'][-1]:.3g} ms without convergence\n")
    if len(found) < 2:
        raise errors.SolverError("ccx: fewer than two of its runs reach the end")
    return found


def extrapolated(coarse, fine, ratio, setting):
    """The limit of two impacts with the same steps whose error is proportional to a small quantity.

    @param ratio  this quantity in `coarse` over that in `fine`
    """
    share = 1 / (ratio - 1)
    kinds = ("force", "velocity", "spin", "energy", "area")
    values = {
        kind: getattr(fine, kind) + share * (getattr(fine, kind) - getattr(coarse, kind)) for kind in kinds
    }
    return dataclasses.replace(fine, setting=setting, **values)
