# SPDX-License-Identifier: BSD-2-Clause
"""The first modes of the bodies of a run for a page, as `ricochet modes` lists them."""
from pathlib import Path
from typing import Any

import numpy as np

from ricochet.modal_table import ModalTable
from ricochet.pages.motion import MODES
from ricochet.pictures.history import History
from ricochet.result_file import is_there


def modes_of(result: History, folder: Path) -> list[dict[str, Any]]:
    """A table for each body whose kernel is in the folder: its first elastic modes."""
    found = []
    for body in result.bodies:
        path = folder / Path(result.file.text(f"/bodies/{body}", "kernel") or "none").name
        if not is_there(path):
            continue
        table = ModalTable.read(path)
        elastic = np.flatnonzero(table.frequency_hz > 0)
        found.append(
            {
                "body": body,
                "basis": table.basis,
                "rigid": len(table.frequency_hz) - len(elastic),
                "elastic": len(elastic),
                "rows": [row(table, int(n)) for n in elastic[:MODES]],
            }
        )
    return found


def row(table: ModalTable, n: int) -> dict[str, Any]:
    """A mode: its number from 1, frequency [Hz], damping ratio, effective masses along x, y and z as shares of the mass,
    and its share in the contact flexibility (None if there are no candidates)."""
    share = float(table.contact_share[n])
    return {
        "number": n + 1,
        "frequency_hz": float(table.frequency_hz[n]),
        "damping": float(table.damping[n]),
        "mass": (table.effective_mass[n] / table.mass).tolist(),
        "contact": share if np.isfinite(share) else None,
    }
