# SPDX-License-Identifier: BSD-2-Clause
"""The first modes of bodies for a page, as `ricochet modes` lists them."""
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ricochet.errors import InputError
from ricochet.modal_table import ModalTable
from ricochet.pages.motion import MODES, body_of, of_rest
from ricochet.pages.page import MODAL, save_page
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.modes import upright
from ricochet.pictures.moving_surfaces import MovingSurface
from ricochet.pictures.viewpoint import clearest
from ricochet.result_file import File, expected, is_there


def modes_of(result: LoadedResult, folder: Path) -> list[dict[str, Any]]:
    """A table for each body of a result whose kernel is in the folder."""
    paths = [
        folder / Path(result.file.text(f"/bodies/{body}", "kernel") or "none").name for body in result.bodies
    ]
    return [
        table_of(body, ModalTable.read(path)) for body, path in zip(result.bodies, paths) if is_there(path)
    ]


def table_of(body: str, table: ModalTable) -> dict[str, Any]:
    """The first elastic modes of a body."""
    elastic = np.flatnonzero(table.frequency_hz > 0)
    return {
        "body": body,
        "basis": table.basis,
        "rigid": len(table.frequency_hz) - len(elastic),
        "elastic": len(elastic),
        "rows": [row(table, int(n)) for n in elastic[:MODES]],
    }


def write_modes_page(title: str, kernels: Sequence[Path], scene: dict[str, Any], path: Path) -> Path:
    """Writes a page with the modes of bodies, without an impact. Returns its path.

    @param kernels  kernel files with visualisation surfaces
    @param scene    the resolved scene, for the sections of rods
    Raises InputError.
    """
    tables, bodies = [], []
    for kernel in kernels:
        with expected(kernel, "ricochet-kernel"):
            file, table = File(kernel, "ricochet-kernel"), ModalTable.read(kernel)
            surface = MovingSurface(file, np.eye(3), np.zeros(3), np.zeros((1, len(table.frequency_hz))))
            bodies.append(body_of(table.body, surface, np.array([0]), 1 / len(kernels), scene))
            tables.append(table_of(table.body, table))
    if not any(table["rows"] for table in tables):
        raise InputError(
            f"{kernels[0]}: no body has an elastic mode to show. Increase modes.up_to_hz or modes.count."
        )
    first = bodies[0]
    view = clearest([(first.place, first.element)], np.empty((0, 3)), tilted=True, up=upright(first.place))
    save_page(
        {
            "title": title,
            "bodies": [{"name": table["body"]} for table in tables],
            "episodes": [],
            "modes": tables,
            "motion": of_rest([body.data for body in bodies], view),
        },
        path,
        "modes.html",
        MODAL,
    )
    return path


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
