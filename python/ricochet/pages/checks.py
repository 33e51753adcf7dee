# SPDX-License-Identifier: BSD-2-Clause
"""What the page of a run says about its peak force, and the checks of its numbers with their bounds."""
from typing import Any

import numpy as np

from ricochet.pages.motion import materials
from ricochet.pictures.history import History

DRIFT = 1e-10  # largest energy drift that is round-off
PENETRATION = {"double": 1e-6, "single": 1e-4}  # largest one, relative to the motion of the points
LOST = 0.01  # largest share of the energy that contact may remove, unless `accuracy` states it
FEW = 3  # with fewer points at the peak, the pressure is that of a patch


def peak_of(result: History) -> dict[str, Any] | None:
    """The step with the largest force: the number of points that carry it, and whether they are so few that the
    pressure depends on the size of a patch. None if nothing touched. If `output.every` is above 1, it is the largest
    of the rows."""
    if len(result.contact_time) == 0:
        return None
    row = int(np.argmax(result.force.sum(axis=1)))
    points = int(np.count_nonzero(result.force[row]))
    bodies = [materials(body).values() for body in result.scene.get("bodies", {}).values()]
    rods = bool(bodies) and all(
        "area" in part for parts in bodies for part in parts
    )  # they have one point, the end
    return {"points": points, "few": points < FEW and not rods}


def checks_of(result: History, summary: dict[str, Any]) -> list[dict[str, Any]]:
    """The checks of an impact whose figures exist, as {"key", "value", "unit", "most", "ok", "warned", "meaning"}. `most` is
    None if there is no bound, and `warned` is set where the program itself warns."""
    contact, moved = result.scene.get("contact", {}), 0.0
    if result.sides:
        moved = float(np.abs(result.sides["displacement_a"] - result.sides["displacement_b"]).max(initial=0))
    holds = contact.get("scheme", "compliant") == "compliant" and bool(result.sides)
    deepest = PENETRATION.get(str(summary.get("precision")), PENETRATION["double"]) * moved if holds else None
    accuracy = result.scene.get("accuracy")
    lost = accuracy if isinstance(accuracy, float) else LOST
    found = []
    for key, unit, most, warned, meaning in (
        ("energy_drift", "", DRIFT, False, "a larger one is a defect of the program"),
        ("energy_lost_contact", "", lost, True, "otherwise an error of the time step, or of few modes"),
        ("max_penetration_m", "m", deepest, False, "points must not penetrate: increase contact.max_pivots"),
        ("limited_steps", "", None, False, ""),
        ("modes_in_residual", "", None, False, ""),
    ):
        value = summary.get(key)
        if isinstance(value, (int, float)):
            ok = None if most is None else value <= most
            found.append(
                {"key": key, "value": value, "unit": unit, "most": most, "ok": ok, "warned": warned}
                | {"meaning": meaning}
            )
    return found
