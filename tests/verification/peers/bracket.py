# SPDX-License-Identifier: BSD-2-Clause
"""A steel bracket falls on a rigid floor with a corner first (`meshes/bracket/bracket.toml`), without friction: it bends and turns
while it is in contact."""
import numpy as np

import calculix_contact
import peer_impact
import peer_report
from ricochet import programs

TITLE = "A bracket on a rigid floor"

SCENE = programs.ROOT / "meshes" / "bracket" / "bracket.toml"
BODY, OBSTACLE = "bracket", "floor"
# Ricochet: steps [µs] by band of the modes [kHz]. The last run is the finest.
OURS = {12: (8, 4), 25: (4, 2), 50: (2, 1), 100: (1, 0.5), 200: (0.5,), 400: (0.125,)}
# CalculiX: step [µs] and penalty of pressure [N/m³]. The last run is the finest.
THEIRS = ((8, 1e16), (8, 1e17), (4, 1e17), (2, 1e17))


def theirs(folder, body, obstacle, duration, cache):
    """Yields setting and data of CalculiX's runs."""
    for step, penalty in THEIRS:
        contact = calculix_contact.Contact(BODY, OBSTACLE, penalty)
        steps = calculix_contact.Steps(1e-6 * step, duration)
        found = calculix_contact.run(folder / "calculix", [body], [obstacle], contact, steps, cache)
        yield f"{step:g} µs, {penalty:.0e}", found


def run(folder, cache, figure):
    """Computes all impacts, and prints and draws the comparison."""
    scene, bodies, words = peer_impact.bodies(SCENE, [], folder)
    body = bodies[BODY]
    obstacle = peer_impact.half_space(scene, OBSTACLE, body)
    print(f"{len(body.node)} nodes, {len(body.element)} elements, mass {body.mass:.6g} kg\n")
    # The blow turns the bracket about the horizontal axis that is normal to the lever from the corner to the centre.
    lever = body.centre - body.node[np.argmin(body.node[:, 2])]
    lever[2] = 0.0
    radius = float(np.linalg.norm(lever))
    speed = -float(body.velocity[2])
    normal = np.array(obstacle.normal)
    frame = peer_impact.Frame(normal, lever / radius, speed, radius, kinds=("normal", "rebound", "spin"))
    ours = list(peer_impact.sweep(SCENE, words, OURS, folder, BODY, body))
    runs = theirs(folder, body, obstacle, scene["time"]["duration"], cache)
    peers = peer_impact.finished(runs, BODY)
    peer_report.compare(ours, peers, peers[-1], frame, body.mass * speed**2 / 2, figure)
