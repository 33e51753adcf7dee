# SPDX-License-Identifier: BSD-2-Clause
"""Velocities of a ball, or half of one, after an impact."""


def spin(result, body, height, radius):
    """Angular velocity about y of a homogeneous ball whose centre starts at the given height z [rad/s]."""
    velocity, momentum, angular = (
        result[f"/bodies/{body}/{name}"][-1] for name in ("velocity", "momentum", "angular_momentum")
    )
    mass = momentum[2] / velocity[2]
    return (angular[1] - height * momentum[0]) / (0.4 * mass * radius**2)
