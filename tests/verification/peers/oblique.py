# SPDX-License-Identifier: BSD-2-Clause
"""A soft ball meets a rigid plane obliquely, with friction (`meshes/oblique/soft.toml`), by Ricochet and by CalculiX on the same
nodes."""
import numpy as np

import calculix_contact
import peer_impact
import peer_report
from ricochet import programs

TITLE = "A soft ball on a rigid plane, obliquely"

SCENE = programs.ROOT / "meshes" / "oblique" / "soft.toml"
BODY, OBSTACLE = "ball", "plane"
# Ricochet: steps [µs] by band of the modes [kHz]. The last run is the finest.
OURS = {3: (50, 25), 6: (50, 25, 12.5), 12: (25, 12.5, 6.25), 30: (12.5, 6.25), 80: (1.5625,)}
# CalculiX: step [µs], and penalties of pressure and of stick [N/m³]. The last two runs are extrapolated to rigid stick.
THEIRS = (
    (50, 1e12, 2e11),
    (50, 1e12, 3e10),
    (50, 1e13, 1e11),
    (50, 1e12, 1e11),
    (36, 1e12, 1e11),
    (25, 1e12, 1e11),
    (25, 1e12, 3e11),
    (12.5, 1e12, 1e11),
    (12.5, 1e12, 3e11),
)


def theirs(folder, scene, body, obstacle, cache):
    """Yields setting and data of CalculiX's runs."""
    friction = scene["contact"]["pair"][0]["friction"]
    for step, penalty, stick in THEIRS:
        contact = calculix_contact.Contact(BODY, OBSTACLE, penalty, friction, stick)
        steps = calculix_contact.Steps(1e-6 * step, scene["time"]["duration"])
        name = f"{step:g} µs, {penalty:.0e}, {stick:.0e}"
        yield name, calculix_contact.run(folder / "calculix", [body], [obstacle], contact, steps, cache)


def run(folder, cache, figure):
    """Computes all impacts, and prints and draws the comparison."""
    scene, bodies, words = peer_impact.bodies(SCENE, [], folder)
    body = bodies[BODY]
    obstacle = peer_impact.half_space(scene, OBSTACLE, body)
    speed, normal = np.array(body.velocity), np.array(obstacle.normal)
    across = speed - (speed @ normal) * normal
    radius = float(np.ptp(body.node[:, 2])) / 2
    frame = peer_impact.Frame(normal, across / np.linalg.norm(across), -float(speed @ normal), radius)
    print(f"{len(body.node)} nodes, {len(body.element)} elements, mass {body.mass:.6g} kg\n")
    ours = list(peer_impact.sweep(SCENE, words, OURS, folder, BODY, body))
    peers = peer_impact.finished(theirs(folder, scene, body, obstacle, cache), BODY)
    limit = peer_impact.extrapolated(*peers[-2:], THEIRS[-1][2] / THEIRS[-2][2], "limit of rigid stick")
    peer_report.compare(ours, peers, limit, frame, body.mass * float(speed @ speed) / 2, figure)
