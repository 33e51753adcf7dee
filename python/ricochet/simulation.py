# SPDX-License-Identifier: BSD-2-Clause
"""Simulations: stepping through an impact in a loop, one step or one block at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from ricochet import _core
from ricochet.errors import InputError
from ricochet.kernel import Kernel
from ricochet.runs import stored_kernels
from ricochet.scene import Scene, scene_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Pickup:
    """A channel to listen to: a place of a body along a direction (world axes, any length but 0).

    The place is a receiver of the scene, by name, or else the candidate of this index into `Kernel.node`.
    """

    body: str
    direction: Sequence[float]
    receiver: str = ""
    candidate: int = 0


@dataclass(frozen=True)
class Block:
    """A row for each of n steps; m contact points, p pickups."""

    velocity: Array  #: (n,p) of the pickups at the end of each step [m/s]
    total_force: Array  #: (n) Σ λ over each step [N]
    force: Array | None  #: (n,m) λ [N], where asked for
    displacement: Array | None  #: (n,m) u: the gap is initial_gap − u [m], where asked for


@dataclass(frozen=True)
class Energy:
    """Running ledger [J]: total + damping + contact stays constant, to round-off."""

    kinetic: float
    strain: float
    residual: float  #: of the static response
    loads: float  #: work of gravity so far
    damping: float  #: taken so far
    contact: float  #: taken so far
    total: float  #: kinetic + strain + residual − loads


class State:
    """A saved state of one simulation, from `Simulation.save`."""

    def __init__(self, core: _core.State) -> None:
        self._core = core


class Simulation:
    """Bodies in motion, from t = 0 on. m contact points, p pickups; SI units, world axes.

    Steps are those of `impact`. A simulation belongs to one thread at a time; different simulations share
    only kernels, which never change.
    """

    def __init__(
        self,
        scene: Scene | str | PathLike[str],
        kernels: Mapping[str, Kernel] | None = None,
        pickups: Sequence[Pickup] | None = None,
    ) -> None:
        """Places and pairs the bodies of a scene.

        kernels: by body; otherwise those that `ricochet.kernels` left in `scene.out`.
        pickups: channels to listen to; otherwise x, y and z of each receiver of the scene, in its order.

        Raises InputError, one line, for kernels that are missing, bodies that overlap or do not meet, and
        scenes that only `impact` follows: `accuracy`, loads other than gravity, the scheme "static", table
        kernels, events in steps.
        """
        self.scene = scene_of(scene)
        core = self.scene._for_impact()
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
        """Makes one step. Raises InputError if no contact forces keep the bodies apart, SolverError if the
        motion stops being finite; a step that fails changes nothing."""
        self._core.step()

    def step_block(self, steps: int, *, force: bool = False, displacement: bool = False) -> Block:
        """Makes many steps: the same steps, to the last bit, as `step` in a loop, and much faster. Other
        threads run meanwhile, and Ctrl-C ends the block. Raises as `step` does, when a step fails.

        force, displacement: also return those of each point. Displacements slow the steps down.
        """
        if steps < 0:
            raise ValueError(f"steps = {steps}: must not be negative")
        points = len(self.initial_gap)
        block = Block(
            np.empty((steps, len(self.pickups))),
            np.empty(steps),
            np.empty((steps, points)) if force else None,
            np.empty((steps, points)) if displacement else None,
        )
        self._core.step_block(steps, block.velocity, block.total_force, block.force, block.displacement)
        return block

    def save(self) -> State:
        """Returns the present state, for `restore`."""
        return State(self._core.save())

    def restore(self, state: State) -> None:
        """Returns to a saved state, to the last bit. Raises ValueError for a state of another simulation."""
        if not self._core.restore(state._core):
            raise ValueError("the state is of another simulation")

    # ---- State ----

    @property
    def steps(self) -> int:
        """Steps since t = 0."""
        return self._core.steps

    @property
    def time(self) -> float:
        """[s]"""
        return self._core.time

    @property
    def force(self) -> Array:
        """(m) λ ≥ 0 over the last step [N]"""
        return self._core.force

    @property
    def displacement(self) -> Array:
        """(m) u [m]"""
        return self._core.displacement

    @property
    def gap(self) -> Array:
        """(m) initial_gap − u [m]; negative: penetration"""
        return self.initial_gap - self.displacement

    @property
    def active(self) -> int:
        """Points with a force in the last step."""
        return self._core.active

    @property
    def pickup_velocity(self) -> Array:
        """(p) of the modes, at the end of the last step [m/s]"""
        return self._core.pickup_velocity

    @property
    def pickup_displacement(self) -> Array:
        """(p) of the modes, since t = 0 [m]"""
        return self._core.pickup_displacement

    @property
    def energy(self) -> Energy:
        return Energy(**self._core.energy)

    def mean_velocity(self, body: str) -> Array:
        """(3) mass-mean of a body [m/s]"""
        return self._core.mean_velocity(self.scene.bodies.index(body))

    # ---- Contact points ----

    @property
    def initial_gap(self) -> Array:
        """(m) [m]"""
        return self._core.initial_gap

    @property
    def area(self) -> Array:
        """(m) of the patches on the first body of the pair [m²]"""
        return self._core.area

    @property
    def point_a(self) -> Array:
        """(m,3) contact points on the first body of the pair, at the start [m]"""
        return self._core.point_a

    @property
    def point_b(self) -> Array:
        """(m,3) the places that they face [m]"""
        return self._core.point_b

    @property
    def normal(self) -> Array:
        """(m,3) unit normals out of the first body"""
        return self._core.normal

    def __repr__(self) -> str:
        now = f"step {self.steps}, t = {self.time:.6g} s, {self.active} of {len(self.area)} points touch"
        return f"<Simulation of {self.scene.title!r}: {now}>"
