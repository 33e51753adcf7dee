# SPDX-License-Identifier: BSD-2-Clause
"""What the page of a run says about its peak force, and the checks of its numbers with their bounds."""
from typing import Any, NamedTuple

import numpy as np

from ricochet.pictures.simplified import materials
from ricochet.pictures.loaded_result import LoadedResult

DRIFT = 1e-10  # largest energy drift that is round-off
PENETRATION = {"double": 1e-6, "single": 1e-4}  # largest one, relative to the motion of the points
LOST = 0.01  # largest share of the energy that contact may remove, unless `accuracy` states it
FEW = 3  # with fewer points at the peak, the pressure is that of a patch


def peak_of(result: LoadedResult) -> dict[str, Any] | None:
    """The step with the largest force: the number of points that carry it, and whether they are so few that the
    pressure depends on the size of a patch. None if nothing touched. If `output.every` is above 1, it is the largest
    of the rows."""
    if len(result.contact_time) == 0:
        return None
    row = int(np.argmax(result.forces.per_row()))
    points = int(np.count_nonzero(result.forces.of_row(row)))
    bodies = [materials(body).values() for body in result.scene.get("bodies", {}).values()]
    rods = bool(bodies) and all(
        "area" in part for parts in bodies for part in parts
    )  # they have one point, the end
    return {"points": points, "few": points < FEW and not rods}


class Check(NamedTuple):
    """A figure of the summary that should not exceed a bound."""

    key: str
    label: str
    unit: str
    most: float | None  # None: no bound
    warned: bool  # whether the program itself warns
    meaning: str


def checks_of(result: LoadedResult, summary: dict[str, Any]) -> list[dict[str, Any]]:
    """The checks of an impact whose figures exist, with "value" and "ok", which is None if there is no bound."""
    compliant = result.scene.get("contact", {}).get("scheme", "compliant") == "compliant" and bool(
        result.energy
    )
    deepest = lost = None
    if compliant:
        share = PENETRATION.get(str(summary.get("precision")), PENETRATION["double"])
        deepest = share * result.largest_motion()
        accuracy = result.scene.get("accuracy")
        lost = accuracy if isinstance(accuracy, float) else LOST
    checks = (
        Check("energy_drift", "energy drift", "", DRIFT, False, "this is a defect of the program"),
        Check("energy_lost_contact", "energy to contact, share", "", lost, True, ""),
        Check("max_penetration_m", "deepest penetration", "m", deepest, False, "see limited_steps"),
        Check("limited_steps", "steps that max_pivots cut short", "", None, False, ""),
        Check("modes_in_residual", "quasi-static modes", "", None, False, ""),
    )
    out = []
    for check in checks:
        value = summary.get(check.key)
        if isinstance(value, (int, float)):
            ok = None if check.most is None else value <= check.most
            out.append(check._asdict() | {"value": value, "ok": ok})
    return out
