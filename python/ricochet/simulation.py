# SPDX-License-Identifier: BSD-2-Clause
"""Simulations: advance an impact in a loop, by single steps or blocks of steps."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np

from ricochet import _core
from ricochet.arrays import Floats
from ricochet.errors import InputError
from ricochet.forwarding import of_core
from ricochet.kernel import Kernel
from ricochet.runs import stored_kernels
from ricochet.scene import Scene, scene_of


@dataclass(frozen=True)
class Pickup:
    """A channel to listen to: a place of a body and a direction (world axes, any length except 0).

    The place is a receiver of the scene, by name, or the candidate with this index into `Kernel.node`.
    """

    body: str
    direction: Sequence[float]
    receiver: str = ""
    candidate: int = 0


@dataclass(frozen=True)
class BodyMotion:
    """Where a body is, and how it moves as a whole, in world axes."""

    position: Floats  #: (3) of its centre of mass [m]
    attitude: Floats  #: (4) unit quaternion w, x, y, z, from the axes of the kernel
    velocity: Floats  #: (3) of that centre [m/s]
    spin: Floats  #: (3) [rad/s]


@dataclass(frozen=True)
class Contact:
    """A point that touches, in world axes. With linear rotations, it is where it was at the start."""

    between: tuple[str, str]  #: names of the bodies, or of a body and an obstacle
    point: int  #: number of the contact point, from 0
    place: Floats  #: (3) on the first body [m]
    normal: Floats  #: (3) unit, out of the first body
    force: Floats  #: (3) of contact and friction on the second one, the mean over the last step [N]


@dataclass(frozen=True)
class ModalCoordinates:
    """Coordinates of the modes of one body, in the order of its kernel."""

    displacement: Floats  #: (N) [kg^1/2 m]
    velocity: Floats  #: (N) [kg^1/2 m/s]


@dataclass(frozen=True)
class Block:
    """Rows for n steps, with m contact points and p pickups."""

    velocity: Floats  #: (n,p) velocity of the pickups at the end of each step [m/s]
    total_force: Floats  #: (n) Σ λ over each step [N]
    force: Floats | None  #: (n,m) λ [N], if requested
    displacement: Floats | None  #: (n,m) u [m], if requested; the gap is initial_gap − u
    tangential_force: Floats | None = None  #: (n,m,3) of friction on the second body [N], if requested


@dataclass(frozen=True)
class Energy:
    """Energy ledger [J]: total + damping + contact + friction stays constant to round-off."""

    kinetic: float
    strain: float
    residual: float  #: of the static response
    loads: float  #: work of gravity and of all else from outside so far
    damping: float  #: lost so far
    contact: float  #: lost so far
    total: float  #: kinetic + strain + residual − loads
    friction: float = 0.0  #: heat of friction so far
    added: float = 0.0  #: part of loads: what added bodies brought, less what removed ones took away


def _contacts(rows: list[tuple[str, str, int, Floats, Floats, Floats]]) -> list[Contact]:
    return [Contact((a, b), point, place, normal, force) for a, b, point, place, normal, force in rows]


class State:
    """A saved state, from `Simulation.save`. It can be pickled, and `bytes(state)` are what `State.from_bytes` takes,
    in this process or in another one with the same version of the package and the same kind of processor."""

    def __init__(self, core: _core.State | bytes) -> None:
        self._core = core

    @classmethod
    def from_bytes(cls, data: bytes) -> State:
        """The state that these bytes hold. `Simulation.restore` checks them."""
        return cls(bytes(data))

    def __bytes__(self) -> bytes:
        return self._core if isinstance(self._core, bytes) else self._core.bytes()

    def __reduce__(self) -> tuple[Callable[[bytes], State], tuple[bytes]]:
        return State.from_bytes, (bytes(self),)


class Simulation:
    """Bodies in motion, from t = 0. m contact points, p pickups; SI units, world axes.

    The steps are those of `impact`. One thread at a time may step, save, restore or change a simulation; in any
    other thread, these raise RuntimeError. Reading waits for the end of a step, or of up to 1024 of them in a
    block. Different simulations share only kernels, which do not change.
    """

    def __init__(
        self,
        scene: Scene | str | PathLike[str],
        kernels: Mapping[str, Kernel] | None = None,
        pickups: Sequence[Pickup] | None = None,
    ) -> None:
        """Places the bodies of a scene and finds their contact pairs.

        kernels: kernels by body; default: those that `ricochet.kernels` wrote to `scene.out`.
        pickups: channels to listen to; default: x, y and z of each receiver of the scene, in its order.

        A scene with `accuracy` is stepped with the settings that `ricochet.kernels` chose and stored in
        `scene.out`.

        Raises InputError, one line, for kernels or settings that are missing, for bodies that overlap or do
        not meet, and for scenes that only `impact` supports: the scheme "static", sampled responses.
        """
        self.scene = scene_of(scene)
        core = self.scene._for_impact().chosen(self.scene.out)
        self.kernels = dict(kernels) if kernels is not None else stored_kernels(self.scene)
        missing = [body for body in self.scene.bodies if body not in self.kernels]
        if missing:
            raise InputError(
                f"{self.scene.file.name}: no kernel for body {missing[0]!r} is given. Add it to kernels."
            )
        if pickups is None:
            pickups = [
                Pickup(receiver["body"], direction, receiver["name"])
                for receiver in self.scene.resolved["output"].get("receiver", ())
                for direction in np.eye(3).tolist()
            ]
        self.pickups = list(pickups)
        self._core = _core.Simulation(
            core,
            [self.kernels[body]._core for body in self.scene.bodies],
            [_core.Pickup(p.body, p.receiver, p.candidate, list(p.direction)) for p in self.pickups],
        )

    # ---- Stepping ----

    def step(self) -> None:
        """Makes one step. Raises InputError if no contact forces keep the bodies apart, and SolverError if
        the motion becomes infinite or undefined. A step that fails changes nothing."""
        self._core.step()

    def step_block(
        self, steps: int, *, force: bool = False, displacement: bool = False, tangential_force: bool = False
    ) -> Block:
        """Makes many steps. They equal, to the last bit, those of `step` in a loop, but are much faster.
        Other threads can run meanwhile, and Ctrl-C ends the block. If a step fails, raises the same errors as
        `step`. A callback of `on_contact` may end the block: the rows are those of the steps made.

        force, displacement, tangential_force: whether to return those of each point as well. Displacements slow
        the steps down.
        """
        if steps < 0:
            raise ValueError(f"steps = {steps}: must not be negative")
        points = self._core.points
        block = Block(
            np.empty((steps, len(self.pickups))),
            np.empty(steps),
            np.empty((steps, points)) if force else None,
            np.empty((steps, points)) if displacement else None,
            np.empty((steps, points, 3)) if tangential_force else None,
        )
        rows: list[Any] = [getattr(block, field.name) for field in fields(Block)]
        made = self._core.step_block(steps, *rows)
        rows = [row if row is None else row[:made] for row in rows]
        return Block(*rows)

    def on_contact(self, callback: Callable[[float, list[Contact]], bool | None] | None) -> None:
        """Calls `callback(time, contacts)` from now on, after each step in which points touch, and with an empty list
        after the first step in which none touches any more. If it returns False, a block of steps ends there; an
        exception ends it, too, and is raised by `step` or `step_block`. It may read this simulation, but not step
        or change it. None: no longer.
        """
        if callback is None:
            self._core.on_contact(None)
        else:
            own = callback
            self._core.on_contact(lambda time, rows: own(time, _contacts(rows)))

    def save(self) -> State:
        """Returns the present state, for `restore`."""
        return State(self._core.save())

    def restore(self, state: State) -> None:
        """Restores a saved state, to the last bit, perhaps one that another process has pickled.

        Raises InputError, one line, and changes nothing, if the state is damaged or of another version, or if its
        system differs: the kernels, the scene, or the bodies that were added and removed so far and their order. A
        digest guards this. A body that was added to a place that no other had left must have had the same motion.
        """
        core = state._core
        if isinstance(core, bytes):
            core = self._core.state(core)
        if not self._core.restore(core):
            raise InputError(
                f"{self.scene.title}: state: is of another system: its kernels, its scene, or the bodies that were"
                " added or removed differ. Restore it in a simulation of the same."
            )

    # ---- Bodies ----

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies that are there: those of the scene, then those that were added."""
        return self._core.bodies

    def add(
        self,
        name: str,
        kernel: Kernel | str,
        position: Sequence[float],
        *,
        attitude: Sequence[float] = (1, 0, 0, 0),
        velocity: Sequence[float] = (0, 0, 0),
        spin: Sequence[float] = (0, 0, 0),
        friction: float | Mapping[str, float] | None = None,
    ) -> None:
        """Adds a body between two steps. It may meet every other body and every obstacle. The other bodies go on
        as if nothing had happened, and m may change. If a body with the same kernel has been removed, the new one
        takes its place, which is fast.

        kernel: a kernel, or the name of a body that has it.
        position, attitude, velocity, spin: as `body_motion` returns them; elastic modes are at rest.
        friction: with all that it meets, as the key `contact.friction`; default: that of the scene.

        Raises InputError, one line, if the name is taken, if the body would overlap another one or an obstacle, if
        the kernel does not allow finite rotations, or unless `motion.rotation = "finite"`. Nothing changes then.
        """
        if isinstance(kernel, str):
            if kernel not in self.kernels:
                raise InputError(
                    f"{self.scene.title}: there is no body {kernel!r} whose kernel {name!r} could have. Give a kernel."
                )
            kernel = self.kernels[kernel]
        self._core.add(
            name,
            kernel._core,
            list(position),
            list(attitude),
            list(velocity),
            list(spin),
            self._friction(friction),
        )
        self.kernels[name] = kernel

    def remove(self, name: str) -> None:
        """Removes a body between two steps. Its contacts vanish at once, and its pickups are silent from now on.
        Raises InputError if it is not there, or unless `motion.rotation = "finite"`."""
        self._core.remove(name)
        del self.kernels[name]

    @cached_property
    def _frictions(self) -> list[float | Mapping[str, float]]:
        """The key `friction` of each pair of the scene."""
        contact = self.scene.resolved["contact"]
        pairs = [pair for pair in contact.get("pair", [contact]) if pair.get("touch", True)]
        return [pair.get("friction", 0) for pair in pairs]

    def _friction(self, friction: float | Mapping[str, float] | None) -> list[float] | None:
        """Coefficients at rest and in fast sliding, and the speed between them [m/s]."""
        if friction is None:
            if any(law != self._frictions[0] for law in self._frictions):
                raise InputError(
                    f"{self.scene.title}: contact.friction differs from pair to pair. Give the friction of the body."
                )
            friction = self._frictions[0] if self._frictions else 0
        if isinstance(friction, Mapping):
            at_rest = friction["static"]
            return [at_rest, friction.get("dynamic", at_rest), friction.get("stribeck_velocity", 0)]
        return [friction, friction, 0]

    # ---- State ----

    steps: int = of_core("steps", "Steps since t = 0.")
    time: float = of_core("time", "[s]")
    force: Floats = of_core("force", "(m) λ ≥ 0 over the last step [N]")
    displacement: Floats = of_core("displacement", "(m) u [m]")
    tangential_force: Floats = of_core(
        "tangential_force",
        "(m,3) force of friction on the second body of the pair, the mean over the last step [N]; 0 for points"
        " without friction",
    )

    @property
    def gap(self) -> Floats:
        """(m) initial_gap − u [m]; negative values are penetration"""
        return self.initial_gap - self.displacement

    active: int = of_core("active", "Points with a force in the last step.")
    pickup_velocity: Floats = of_core(
        "pickup_velocity", "(p) of the modes, at the end of the last step [m/s]"
    )
    pickup_displacement: Floats = of_core("pickup_displacement", "(p) of the modes, since t = 0 [m]")

    @property
    def energy(self) -> Energy:
        return Energy(**self._core.energy)

    def body_motion(self, body: str) -> BodyMotion:
        """Where a body is, and how it moves as a whole, at the end of the last step."""
        return BodyMotion(*self._core.body_motion(body))

    @property
    def contacts(self) -> list[Contact]:
        """The points with a force in the last step."""
        return _contacts(self._core.contacts())

    def modal_coordinates(self, body: str) -> ModalCoordinates:
        """Coordinates of the modes of a body at the end of the last step, without the motion that supports give. The
        first modes are those of the rigid body; with `motion.rotation = "finite"` they are 0, and `body_motion` has
        them. Modes above half the rate respond statically and are 0."""
        return ModalCoordinates(*self._core.modal_coordinates(body))

    def watch(self) -> None:
        """Judges the run from here on, as `impact` does: whether bodies turn too far, approach too fast, yield, meet
        where no candidates are, or have too few of them. Steps become slower. `warnings` has the result."""
        self._core.watch()

    @property
    def warnings(self) -> list[str]:
        """What is doubtful in the steps since `watch`, one line each; empty without it."""
        return self._core.warnings

    def push(
        self, body: str, force: Sequence[float] = (0, 0, 0), torque: Sequence[float] = (0, 0, 0)
    ) -> None:
        """Sets a force [N] and a torque about the centre of mass [N m] from outside, in world axes, which act on
        a body until they are set again. Raises InputError unless `motion.rotation = "finite"`."""
        if not self._core.push(body, force, torque):
            raise InputError(f'{self.scene.title}: push needs motion.rotation = "finite"')

    def push_at(self, body: str, point: str | int, force: Sequence[float] = (0, 0, 0)) -> None:
        """Sets a force [N] from outside at a point of a body, in world axes. It acts from the next step on, constant
        over each step, until it is set again at this point, and it moves and deforms the body; without a force, it
        ends. With finite rotations, its arm turns with the body. Its work is part of `energy.loads`.

        point: a receiver of the kernel, by name, or the candidate with this index into `Kernel.node`.

        Raises InputError, one line, if there is no such body or point, if a value is not finite, if forces act at 1024
        other points, or if the kernel holds the motion of the candidate along one direction and the force has another
        component.
        """
        receiver, candidate = (point, 0) if isinstance(point, str) else ("", point)
        if candidate < 0 or not self._core.push_at(body, receiver, candidate, force):
            kernel = self.kernels[body]
            raise InputError(
                f"{self.scene.title}: push_at({body!r}, {point!r}, {list(force)}): the kernel has"
                f" the candidates 0 to {len(kernel.node) - 1} and the receivers {list(kernel.receivers)}. Push one of"
                " them with a finite force, along the direction of the kernel if it has one, at 1024 points at most."
            )

    def mean_velocity(self, body: str) -> Floats:
        """(3) mass-mean velocity of a body [m/s]"""
        return self._core.mean_velocity(body)

    # ---- Contact points ----

    initial_gap: Floats = of_core("initial_gap", "(m) [m]")
    area: Floats = of_core("area", "(m) of the patches on the first body of the pair [m²]")
    point_a: Floats = of_core(
        "point_a", "(m,3) contact points on the first body of the pair, at the start [m]"
    )
    point_b: Floats = of_core("point_b", "(m,3) the places that they face [m]")
    normal: Floats = of_core("normal", "(m,3) unit normals out of the first body")

    def __repr__(self) -> str:
        now = f"step {self.steps}, t = {self.time:.6g} s, {self.active} of {len(self.area)} points touch"
        return f"<Simulation of {self.scene.title!r}: {now}>"
