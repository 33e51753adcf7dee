# SPDX-License-Identifier: BSD-2-Clause
"""The ball of `ball_at_rest` on three meshes, down to elements of a fortieth of the contact diameter."""
from cases import ball_at_rest

TITLE = "Hertz at rest, finer"
SOURCE = ball_at_rest.SOURCE
RESTS_ON = "theory"
LONG = True


def run(bench):
    ball_at_rest.run(
        bench,
        (1e-4, 5e-5, 2.5e-5),
        {"radius": 0.005, "approach": 0.002, "radius of the area": 0.02, "pressure": 0.1},
    )
