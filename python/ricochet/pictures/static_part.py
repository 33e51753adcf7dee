# SPDX-License-Identifier: BSD-2-Clause
"""The static response of a visualisation surface by the modes that its kernel does not keep: displacement or stress."""
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.result_file import File, are_finite

LEFT_OUT = 1e-5  # relative root mean square error of the forces, of which a few patterns are kept


def static_part(
    result: File, kernel: File, body: str, count: int, of: str = "/view", rows: int = 3
) -> tuple[Array, Array]:
    """Fields (V,3,r) 32-bit, of largest entry 1, and their amplitudes (s,r) [m], with fields · amplitudes = static
    displacement. With `of` = "/view/stress" and 6 `rows`, fields (V,6,r) and amplitudes [Pa] of the stress.

    It is the response to contact forces, gravity, loads and moving supports at the `count` = s snapshots, in the axes
    of the body. r is 0 for kernels without static corrections and for results of earlier versions.
    """
    nodes = len(kernel.array("/view/node", None, 3))
    parts = [(np.zeros((nodes, rows, 0), "f4"), np.zeros((count, 0)))]
    group = f"/static/{body}"
    if kernel.has(f"{of}/residual_flexibility") and result.has(f"{group}/force"):
        parts += by_contact(result, kernel, group, (nodes, count), of, rows)
    gravity = result.attribute(group, "gravity")
    if kernel.has(f"{of}/body_force_residual") and are_finite(gravity, 3) and np.any(gravity):
        field = kernel.array(f"{of}/body_force_residual", nodes, rows, 3) @ np.asarray(gravity, "f4")
        parts.append((field[:, :, None], np.ones((count, 1))))
    for name in ("load", "motion"):
        if kernel.has(f"{of}/{name}_residual") and result.has(f"{group}/{name}"):
            amplitude = result.array(f"{group}/{name}", count, None, 3).reshape(count, -1)
            field = kernel.array(f"{of}/{name}_residual", nodes, rows, amplitude.shape[1] // 3, 3)
            active = amplitude.any(axis=0)
            parts.append((field.reshape(nodes, rows, -1)[:, :, active], amplitude[:, active]))
    fields, amplitudes = (np.concatenate(arrays, axis=-1) for arrays in zip(*parts))
    size = np.abs(fields).max(axis=(0, 1), initial=0)
    size[size == 0] = 1
    return fields / size, amplitudes * size


def by_contact(
    result: File, kernel: File, group: str, size: tuple[int, int], of: str, rows: int
) -> list[tuple[Array, Array]]:
    """The response to contact forces; none if there are no forces. Their patterns over all snapshots are few, so that
    only a combination of the columns of the kernel is kept."""
    nodes, count = size
    snapshot, candidate = (
        result.array(f"{group}/{name}", None).astype(int) for name in ("snapshot", "candidate")
    )
    force = result.array(f"{group}/force", len(snapshot), None)
    components = force.shape[1]
    if not np.any(force):
        return []
    candidates, place = np.unique(candidate, return_inverse=True)
    if len(candidate) != len(snapshot) or not within(snapshot, count):
        raise InputError(f'{result.path}: "{group}" names snapshots that do not exist. Compute it again.')
    forces = np.zeros((count, len(candidates), components))
    np.add.at(forces, (snapshot, place.ravel()), force)
    left, weight, patterns = np.linalg.svd(forces.reshape(count, -1), full_matrices=False)
    error = np.sqrt(np.append(np.cumsum(weight[::-1] ** 2)[::-1], 0))  # with the first 0, 1, … patterns
    r = int(np.argmax(error <= LEFT_OUT * error[0]))
    mix = patterns[:r].T.astype("f4")
    fields = [
        block.reshape(len(block), rows, -1) @ mix
        for block in columns(kernel, of, (nodes, rows, components), candidates)
    ]
    return [(np.concatenate(fields), left[:, :r] * weight[:r])]


def columns(
    kernel: File, of: str, size: tuple[int, int, int], candidates: NDArray[np.int64]
) -> Iterator[Array]:
    """Blocks (·,rows,candidates,components) of the static response to forces on these candidates."""
    nodes, rows, components = size
    shape = (nodes, rows, None) + ((components,) if components > 1 else ())
    for block in kernel.blocks(f"{of}/residual_flexibility", *shape):
        if not within(candidates, block.shape[2]):
            raise InputError(
                f"{kernel.path}: is not the kernel of this result, which presses on candidates that it does not "
                "hold. Repeat the run."
            )
        yield block[:, :, candidates].reshape(len(block), rows, len(candidates), components)


def within(index: NDArray[np.int64], count: int) -> bool:
    return len(index) == 0 or bool(0 <= index.min() and index.max() < count)
