# SPDX-License-Identifier: BSD-2-Clause
"""The surfaces of a drawing for a page, on which they have numbers and are picked."""
from pathlib import Path
from typing import Any

import numpy as np

from ricochet.arrays import Floats
from ricochet.drawing import Drawing, Surface
from ricochet.pages.motion import of_rest, packed
from ricochet.pages.page import SURFACES, save_page
from ricochet.pictures.colouring import borders, map_colours
from ricochet.pictures.simplified import coarser
from ricochet.pictures.viewpoint import View

TRIANGLES = 200_000  # of all surfaces
FEWEST = 50  # triangles of a surface that is made coarser


def lines_of_scene(surface: Surface, members: dict[str, int]) -> list[str]:
    """The values of `contact` that mean a surface: its groups, if they have no other surface, and its number."""
    alone = [name for name in surface.groups if members[name] == 1]
    return [*alone, f"surface {surface.number}"]


def face_of(surface: Surface, colour: int, scale: float, members: dict[str, int]) -> dict[str, Any]:
    """A surface for the page [m]."""
    return {
        "number": surface.number,
        "groups": surface.groups,
        "kind": surface.kind,
        "area": surface.area * scale**2,
        "low": surface.low * scale + 0.0,
        "high": surface.high * scale + 0.0,
        "centre": surface.centre * scale,
        "normal": None if surface.normal is None else surface.normal + 0.0,
        "colour": colour,
        "names": lines_of_scene(surface, members),
    }


def body_of(surface: Surface, node: Floats, share: float) -> dict[str, Any]:
    """A surface as a body that does not move, with its borders.

    @param node   (V,3) of the drawing [m]
    @param share  of its triangles, which may be left
    """
    limit = max(FEWEST, int(share * len(surface.element)))
    used, element = np.unique(surface.element, return_inverse=True)
    kept, element = coarser(node[used], element.reshape(-1, 3), limit)
    # A coarser surface has gaps where triangles were folded, so the borders keep nodes of their own.
    ends, outline = np.unique(borders(surface.element), return_inverse=True)
    return {
        "name": f"surface {surface.number}",
        "node": packed(np.concatenate([node[used][kept], node[ends]])),
        "element": packed(element, "u4"),
        "lines": False,
        "outline": packed(outline.reshape(-1, 2) + len(kept), "u4"),
    }


def write_surfaces_page(drawing: Drawing, title: str, scale: float, path: Path) -> Path:
    """Writes the page. Returns its path.

    @param scale  metres per unit of the drawing
    Raises InputError.
    """
    colours = map_colours([borders(surface.element) for surface in drawing.surfaces])
    members: dict[str, int] = {}
    for surface in drawing.surfaces:
        for name in surface.groups:
            members[name] = members.get(name, 0) + 1
    faces = [face_of(one, colour, scale, members) for one, colour in zip(drawing.surfaces, colours)]
    share = min(1.0, TRIANGLES / sum(len(surface.element) for surface in drawing.surfaces))
    node = drawing.node * scale
    bodies = [body_of(surface, node, share) for surface in drawing.surfaces]
    view = View(np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]), 0.6, 0.5)
    save_page(
        {
            "title": title,
            "bodies": [{"name": body["name"]} for body in bodies],
            "episodes": [],
            "scale": scale,
            "faces": faces,
            "motion": of_rest(bodies, view),
        },
        path,
        "surfaces.html",
        SURFACES,
        "A mesh with fewer surfaces makes it smaller.",
    )
    return path
