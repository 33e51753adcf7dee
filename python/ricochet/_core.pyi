# SPDX-License-Identifier: BSD-2-Clause
"""The extension module of python/bindings. The modules that use it document its content for users."""

import builtins
from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_Path = str | PathLike[str]
_Array = NDArray[np.float64]

__version__: str

class Purpose:
    impact: Purpose
    kernels: Purpose

class Scene:
    def __init__(self, text: str, file: _Path, settings: Sequence[str], purpose: Purpose) -> None: ...
    @staticmethod
    def read(file: _Path) -> Scene: ...
    title: str
    slug: str
    bodies: list[str]
    needs_other_orders: bool
    def toml(self) -> str: ...
    def chosen(self, folder: _Path) -> Scene: ...
    def kernel_files(self, folder: _Path) -> list[tuple[str, Path, bool]]: ...

channel_classes: tuple[int, ...]

def filter_channel(x: _Array, rate: float, channel_class: float, rest: float) -> _Array: ...
def shock_response(x: _Array, rate: float, frequency: _Array, quality: float, rest: float) -> _Array: ...
def materials_toml() -> str: ...
def slug(title: str) -> str: ...
def overridden(text: str, file: _Path, settings: Sequence[str]) -> str: ...

class Kernel:
    body: str
    hash: str
    scene: str
    created_by: str
    dofs: int
    elements: int
    order: int
    mass: float
    supported: bool
    basis: str
    certificate: dict[str, float | int | bool]
    centre: _Array
    inertia: _Array
    components: int
    direction: _Array | None
    group: list[str]
    visualisation_surface: tuple[_Array, NDArray[np.int64], NDArray[np.float32]] | None
    receivers: dict[str, tuple[_Array, _Array]]
    angular_frequency: _Array
    decay_rate: _Array
    residual: _Array
    node: _Array
    centroid: _Array
    normal: _Array
    area: _Array
    element: NDArray[np.int64]
    shape: _Array
    residual_flexibility: _Array | None
    body_force: _Array
    rotation: _Array

def read_kernel(path: _Path) -> Kernel: ...
def relative_error(value: Sequence[float], reference: Sequence[float], scale: float) -> float: ...
def run_impact(
    file: _Path,
    settings: Sequence[str],
    folder: _Path,
    progress: Callable[[str, int, int], object] | None,
) -> None: ...

class State:
    def bytes(self) -> builtins.bytes: ...

class Pickup:
    def __init__(self, body: str, receiver: str, candidate: int, direction: Sequence[float]) -> None: ...

def contact_system(scene: Scene, kernels: Sequence[Kernel], pickups: Sequence[Pickup]) -> dict[str, Any]: ...

class Simulation:
    def __init__(self, scene: Scene, kernels: Sequence[Kernel], pickups: Sequence[Pickup]) -> None: ...
    def step(self) -> None: ...
    def step_block(
        self,
        steps: int,
        velocity: _Array | None,
        total_force: _Array | None,
        force: _Array | None,
        displacement: _Array | None,
        tangential_force: _Array | None,
    ) -> int: ...
    def save(self) -> State: ...
    def restore(self, state: State) -> bool: ...
    def state(self, bytes: builtins.bytes) -> State: ...
    def add(
        self,
        name: str,
        kernel: Kernel,
        position: Sequence[float],
        attitude: Sequence[float],
        velocity: Sequence[float],
        spin: Sequence[float],
        friction: Sequence[float] | None,
    ) -> None: ...
    def remove(self, name: str) -> None: ...
    bodies: list[str]
    def body_motion(self, body: str) -> tuple[_Array, _Array, _Array, _Array]: ...
    def contacts(self) -> list[tuple[str, str, int, _Array, _Array, _Array]]: ...
    def on_contact(
        self,
        callback: (
            Callable[[float, list[tuple[str, str, int, _Array, _Array, _Array]]], bool | None] | None
        ),
    ) -> None: ...
    def modal_coordinates(self, body: str) -> tuple[_Array, _Array]: ...
    def watch(self) -> None: ...
    def push(self, body: str, force: Sequence[float], torque: Sequence[float]) -> bool: ...
    def push_at(self, body: str, receiver: str, candidate: int, force: Sequence[float]) -> bool: ...
    def mean_velocity(self, body: str) -> _Array: ...
    steps: int
    points: int
    time: float
    active: int
    force: _Array
    displacement: _Array
    tangential_force: _Array
    point_a: _Array
    point_b: _Array
    normal: _Array
    initial_gap: _Array
    area: _Array
    pickup_velocity: _Array
    pickup_displacement: _Array
    energy: dict[str, float]
    quasi_static_modes: int
    warnings: list[str]
