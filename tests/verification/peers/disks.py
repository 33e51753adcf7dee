# SPDX-License-Identifier: BSD-2-Clause
"""The paper's two disks at 1 m/s: a quarter of each, by two planes of symmetry. Both start when the gap is almost closed."""
import numpy as np

import calculix_contact
import peer_impact
import peer_report
import quarter_disks as disks

TITLE = "The paper's two disks"

UPPER, LOWER = "upper", "lower"
DROP = 1.0  # m/s at a gap of disks.GAP
START = 1e-4  # m, the gap at the start of both codes
SPEED = float(np.sqrt(DROP**2 + 2 * disks.GRAVITY * (disks.GAP - START)))
REACH = 0.4  # rad: 20 mm of the rim; the contact extends up to 12 mm from the middle
SETTINGS = [
    *disks.geometry(reach=REACH, largest=1.6e-2),
    f"bodies.{UPPER}.velocity=[0,{-SPEED!r},0]",
    f"bodies.{UPPER}.translate=[0,{2 * disks.RADIUS + START},0]",
    "time.duration=0.018",
]
# Ricochet: steps [µs] by band of the modes [kHz]. The last run is the finest.
OURS = {0.75: (100, 50), 1.5: (50, 25), 3: (25, 12.5), 6: (12.5,), 12: (3.125,)}
FINER = {6: (12.5,)}  # one of them, which is repeated on elements of half the size
# CalculiX: step [µs] and penalty of pressure [N/m³]. The last run is the finest.
THEIRS = ((400, 1e10), (200, 1e10), (100, 1e10), (100, 1e12), (100, 1e11), (50, 1e11))


def theirs(folder, scene, bodies, cache):
    """Yields setting and data of CalculiX's runs."""
    for step, penalty in THEIRS:
        contact = calculix_contact.Contact(UPPER, LOWER, penalty)
        steps = calculix_contact.Steps(
            1e-6 * step, scene["time"]["duration"], gravity=scene["loads"]["gravity"]
        )
        found = calculix_contact.run(folder / "calculix", bodies, [], contact, steps, cache)
        yield f"{step:g} µs, {penalty:.0e}", found


def finer(path, folder, frame, ours):
    """Prints what changes for Ricochet on elements of half the size. @param ours  its impacts on the common mesh"""
    folder.mkdir(exist_ok=True)
    words = [*SETTINGS, *disks.geometry(reach=REACH, size=disks.SIZE / 2, largest=1e-2)]
    bodies, words = peer_impact.bodies(path, words, folder)[1:]
    (one,) = peer_impact.sweep(path, words, FINER, folder, UPPER, bodies[UPPER])
    coarse = next(impact for impact in ours if impact.setting == one.setting)
    apart = peer_impact.difference(coarse, one, frame)
    force, width = frame.copies * (one.force @ frame.normal).max(), peer_report.widest(one, frame)
    print(
        f"\nOn {len(bodies[UPPER].node)} and {len(bodies[LOWER].node)} nodes, Ricochet, {one.setting}: peak {force:.2f} N, "
        f"rebound {one.velocity @ frame.normal:.4f} m/s, widest contact {1e3 * width:.2f} mm. On the common mesh, it differs by: "
        f"normal force {apart['normal']:.2%}, normal rebound {apart['rebound']:.2%}, width {apart['width']:.2%}."
    )


def run(folder, cache, figure):
    """Computes all impacts, and prints and draws the comparison."""
    path = disks.write(folder)
    scene, bodies, words = peer_impact.bodies(path, SETTINGS, folder)
    upper = bodies[UPPER]
    for name, body in bodies.items():
        print(f"{name}: {len(body.node)} nodes, {len(body.element)} elements, mass {body.mass:.6g} kg\n")
    up, across = np.eye(3)[[1, 0]]
    frame = peer_impact.Frame(
        up, across, SPEED, disks.RADIUS, kinds=("normal", "rebound"), copies=4, depth=disks.THICKNESS
    )
    ours = list(peer_impact.sweep(path, words, OURS, folder, UPPER, upper))
    peers = peer_impact.finished(theirs(folder, scene, list(bodies.values()), cache), UPPER)
    peer_report.compare(ours, peers, peers[-1], frame, upper.mass * SPEED**2 / 2, figure)
    finer(path, folder / "finer", frame, ours)
