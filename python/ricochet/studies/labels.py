# SPDX-License-Identifier: BSD-2-Clause
"""Labels of the columns of a study in words, with their units."""
import re

from ricochet.scene_keys import unit, words
from ricochet.studies import figures

WORDS = {
    "contact_start_s": "first touch (s)",
    "contact_end_s": "last touch (s)",
    "parted_s": "bodies have parted, beyond the run (s)",
    "duration_s": "simulated time (s)",
    "contact_steps": "steps with contact",
    "episodes": "episodes",
    "peak_force_n": "peak force (N)",
    "impulse_ns": "impulse (N s)",
    "restitution": "restitution",
    "energy_drift": "energy drift, relative",
    "energy_lost_contact": "energy to contact, relative",
    "energy_lost_friction": "heat of friction, relative",
    "friction_impulse_ns": "impulse of friction (N s)",
    "max_slip_m": "longest slip (m)",
    "ambiguous_steps": "steps with several solutions",
    "ambiguous_increments": "increments with several solutions",
    "max_penetration_m": "deepest penetration (m)",
    "candidates": "contact points",
    "unpaired": "points that face nothing",
    "max_active": "most points that touch at once",
    "real_time_factor": "speed of steps (× real time)",
    "wall_s": "time of ricochet-contact (s)",
    "error_estimate.until_s": "end of the error estimate (s)",
    "warnings": "warnings",
    "touched": "touched",
    "iterations": "iterations",
    "force_n": "force (N)",
    "approach_m": "approach (m)",
    "contact_points": "points that press",
    "contact_area_m2": "area of contact (m²)",
    "peak_pressure_pa": "largest pressure (Pa)",
    "imbalance": "imbalance, relative",
}


def label(name: str, units: dict[str, str]) -> str:
    """The label of an output or a scene key, with its unit. `units`: units of scene keys
    (scene_keys.units)."""
    if (inner := of_magnitude(name)) != name:
        text, bracket, rest = label(inner, units).partition(" (")
        return f"|{text}|{bracket}{rest}"
    path = name.split(".")
    if name in WORDS:
        return WORDS[name]
    if path[0] == "exit_velocity" and len(path) > 2:
        return f"exit velocity of {'.'.join(path[1:-1])}, {path[-1]} (m/s)"
    if path[0] == "pairs" and path[-1] in WORDS:
        return f"{WORDS[path[-1]]}, pair {int(path[1]) + 1}"
    if path[0] == "error_estimate" and len(path) > 1:
        of = f" of the {path[2].replace('_', ' ')}" if path[1] == "quantities" else ""
        return f"estimated error{of}, " + (
            "relative" if path[-1] == "total" else f"{path[-1]} alone, relative"
        )
    if (of_part := figures.label(name)) is not None:
        return of_part
    found = unit(name, units)
    return f"{words(name)} ({found})" if found else words(name)


def unit_of(name: str, units: dict[str, str]) -> str:
    """The unit in the label of a column, as files have it: m/s^2; "1" if it has none."""
    bracket = re.search(r" \(([^()×]*)\)$", label(name, units))
    return bracket[1].replace("²", "^2").replace("³", "^3") if bracket else "1"


def of_magnitude(name: str) -> str:
    """NAME of "abs(NAME)"; another name as it is."""
    return name[4:-1] if name.startswith("abs(") and name.endswith(")") else name
