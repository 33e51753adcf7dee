# SPDX-License-Identifier: BSD-2-Clause
"""Velocities of a ball, or half of one, after an impact."""


def spin(result, body, height, radius):
    """Angular velocity about y of a homogeneous ball whose centre starts at the given height z [rad/s]."""
    motion = result.bodies[body]
    velocity, momentum, angular = motion.velocity[-1], motion.momentum[-1], motion.angular_momentum[-1]
    mass = momentum[2] / velocity[2]
    return (angular[1] - height * momentum[0]) / (0.4 * mass * radius**2)
