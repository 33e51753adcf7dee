# SPDX-License-Identifier: BSD-2-Clause
"""Rotations of bodies: as scenes give them, in degrees about the fixed axes x, then y, then z, and as results do, by
unit quaternions (w, x, y, z)."""
import numpy as np

from ricochet.arrays import Array


def rotation_of(degrees: Array | list[float]) -> Array:
    """(3,3) about the fixed axes x, then y, then z."""
    out = np.eye(3)
    for axis, angle in enumerate(np.radians(degrees)):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[one, one] = turn[two, two] = np.cos(angle)
        turn[one, two], turn[two, one] = -np.sin(angle), np.sin(angle)
        out = turn @ out
    return out


def angles_of(rotation: Array) -> Array:
    """The degrees of which rotation_of makes this rotation."""
    y = np.arctan2(-rotation[2, 0], np.hypot(rotation[2, 1], rotation[2, 2]))
    z = np.arctan2(rotation[1, 0], rotation[0, 0])
    back = rotation_of([0, 0, -np.degrees(z)]) @ rotation
    x = np.arctan2(-back[1, 2], back[1, 1])
    return np.degrees([x, y, z])


def turn_between(start: Array, end: Array) -> Array:
    """(3,3) the smallest rotation from one unit vector to another."""
    axis = np.cross(start, end)
    sine, cosine = float(np.linalg.norm(axis)), float(start @ end)
    if sine < 1e-12:
        if cosine > 0:
            return np.eye(3)
        axis = np.cross(start, np.eye(3)[np.argmin(np.abs(start))])
        sine = float(np.linalg.norm(axis))
        return 2 * np.outer(axis, axis) / sine**2 - np.eye(3)
    x, y, z = axis / sine
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sine * cross + (1 - cosine) * cross @ cross


def matrices_of(quaternion: Array) -> Array:
    """(s,3,3) the rotation matrices of unit quaternions (s,4)."""
    w, axis = quaternion[:, 0, None, None], quaternion[:, 1:]
    cross = -np.cross(axis[:, None, :], np.eye(3))
    return np.asarray(np.eye(3) + 2 * (w * cross + cross @ cross))


def quaternion_of(rotation: Array) -> Array:
    """(4) a unit quaternion w, x, y, z of a rotation matrix (3,3)."""
    xx, yy, zz = np.diag(rotation)
    (_, xy, xz), (yx, _, yz), (zx, zy, _) = rotation
    products = np.array(  # four times those of the components
        [
            [1 + xx + yy + zz, zy - yz, xz - zx, yx - xy],
            [zy - yz, 1 + xx - yy - zz, xy + yx, xz + zx],
            [xz - zx, xy + yx, 1 - xx + yy - zz, yz + zy],
            [yx - xy, xz + zx, yz + zy, 1 - xx - yy + zz],
        ]
    )
    largest = products[np.argmax(np.diag(products))]
    return np.asarray(largest / np.linalg.norm(largest))


def product(one: Array, other: Array) -> Array:
    """The quaternion of the rotation `other`, followed by `one`; (…,4) each."""
    w, u, z, v = one[..., :1], one[..., 1:], other[..., :1], other[..., 1:]
    scalar = w * z - np.sum(u * v, axis=-1, keepdims=True)
    return np.concatenate([scalar, w * v + z * u + np.cross(u, v)], axis=-1)
