# SPDX-License-Identifier: BSD-2-Clause
"""A steel ball falls on a free steel plate, which bends: the plate of Zener's case in the manual, but thinner and finite."""
import numpy as np

import calculix_contact
import peer_impact
import peer_report
from cases import plate

TITLE = "A ball on an elastic plate"

BALL, PLATE = "ball", "plate"
SPEED = 1.0  # m/s; then the contact is about 0.4 mm wide
SETTINGS = (
    f"bodies.{BALL}.velocity=[0,0,{-SPEED}]",
    f"bodies.{BALL}.geometry={{size=1.6e-4,reach=5e-4,largest=6e-3}}",
    f"bodies.{PLATE}.geometry={{size=1.6e-4,reach=5e-4,largest=1.2e-2,thickness=6e-3,width=0.06}}",
    "time.duration=9e-5",
)
# Ricochet: steps [µs] by band of the modes [kHz]. The last run is the finest.
OURS = {30: (4, 2), 60: (2, 1), 120: (1, 0.5), 240: (0.5, 0.25), 600: (0.0625,)}
# CalculiX: step [µs] and penalty of pressure [N/m³]. The last run is the finest.
THEIRS = ((4, 1e16), (4, 1e17), (2, 1e17), (1, 1e17))


def theirs(folder, bodies, duration, cache):
    """Yields setting and data of CalculiX's runs."""
    for step, penalty in THEIRS:
        contact = calculix_contact.Contact(BALL, PLATE, penalty)
        steps = calculix_contact.Steps(1e-6 * step, duration)
        found = calculix_contact.run(folder / "calculix", bodies, [], contact, steps, cache)
        yield f"{step:g} µs, {penalty:.0e}", found


def run(folder, cache, figure):
    """Computes all impacts, and prints and draws the comparison."""
    (folder / "plate.geo").write_text(plate.GEO)
    path = folder / "plate.toml"
    path.write_text(plate.SCENE)
    scene, bodies, words = peer_impact.bodies(path, SETTINGS, folder)
    ball = bodies[BALL]
    for name, body in bodies.items():
        print(f"{name}: {len(body.node)} nodes, {len(body.element)} elements, mass {body.mass:.6g} kg\n")
    up, across = np.eye(3)[[2, 0]]
    radius = float(np.ptp(ball.node[:, 2])) / 2
    frame = peer_impact.Frame(up, across, SPEED, radius, kinds=("normal", "rebound"), copies=4)
    ours = list(peer_impact.sweep(path, words, OURS, folder, BALL, ball))
    runs = theirs(folder, list(bodies.values()), scene["time"]["duration"], cache)
    peers = peer_impact.finished(runs, BALL)
    peer_report.compare(ours, peers, peers[-1], frame, ball.mass * SPEED**2 / 2, figure)
