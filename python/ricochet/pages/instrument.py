# SPDX-License-Identifier: BSD-2-Clause
"""An instrument for a page: the player in WebAssembly, the block that it reads, and the picture of the body."""
import base64
import itertools
from pathlib import Path
from typing import Any

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange.instrument import Instrument, instrument_of
from ricochet.interchange.keyboard import Keyboard
from ricochet.interchange.rotations import rotation_of
from ricochet.kernel import Kernel
from ricochet.pages.motion import of_rest, packed
from ricochet.pictures.simplified import coarser, tube
from ricochet.pages.page import FOLDER
from ricochet.pictures.viewpoint import View
from ricochet.result import Result
from ricochet.result_file import is_there
from ricochet.scene import Scene

TRIANGLES = 20_000  # maximum number of the body
REPORTED = 8  # maximum number of places on the page of a run, because each takes a tenth of a second
ELEVATION = 0.4  # of the viewpoint [rad]


def module() -> bytes:
    """The player in WebAssembly, beside the other parts of pages. Raises InputError."""
    path = FOLDER / "player.wasm"
    if not is_there(path):
        raise InputError(
            f"{path}: pages to play need this file, which belongs to the package. Install it again."
        )
    return path.read_bytes()


def surface_of(kernel: Kernel, most: int = TRIANGLES) -> tuple[Array, Array]:
    """Nodes and at most about `most` triangles of a body: its visualisation surface, otherwise its contact surface."""
    surface = kernel.visualisation_surface
    node, element = (surface.node, surface.element) if surface else (kernel.node, kernel.element)
    if element.shape[1] == 2 and len(element):
        faces, of, offset = tube(node, element, 0.02 * float(np.ptp(node, axis=0).max()))
        return node[of] + offset, faces
    if element.shape[1] != 3 or not len(element):
        raise InputError(f"{kernel.path}: has no surface to draw. Set output.view = true in the scene.")
    kept, element = coarser(node, element, most)
    return node[kept], element


def views() -> list[View]:
    """Views of a body that stands upright, from eight sides."""
    sides = itertools.product((1, -1), (-1, 1), (ELEVATION, -ELEVATION))
    return [View(np.array([x, y, 0]) / np.sqrt(2), np.array([0.0, 0.0, 1.0]), 0.0, up) for x, y, up in sides]


def bars(node: Array, element: Array, origin: Array, keyboard: Keyboard) -> tuple[Array, Array]:
    """Nodes and triangles of all bars of a keyboard, from those of the bar of the scene, whose origin stays where it is."""
    nodes = [origin + s * (node - origin) + moved for s, moved in zip(keyboard.scale, keyboard.offset)]
    return np.concatenate(nodes), np.concatenate([element + k * len(node) for k in range(len(nodes))])


def picture_of(
    instrument: Instrument, scene: Scene, kernel: Kernel, keyboard: Keyboard | None = None
) -> dict[str, Any]:
    """The body, or the bars of a keyboard, at rest, in the form of a motion of one moment."""
    asked = scene.resolved["bodies"][instrument.body]
    node, element = surface_of(kernel, TRIANGLES // len(keyboard.notes) if keyboard else TRIANGLES)
    origin = np.array(asked.get("translate", [0, 0, 0]), float)
    place = node @ rotation_of(asked.get("rotate_deg", [0, 0, 0])).T + origin
    if keyboard:
        place, element = bars(place, element, origin, keyboard)
    aside = keyboard.offset[-1] - keyboard.offset[0] if keyboard else np.zeros(3)

    def merit(view: View) -> tuple[float, float]:
        """The place of the scene is in front, and keys rise from left to right."""
        turn = view.turn()
        return round(float(turn[2] @ instrument.places[0].normal), 6), float(turn[0] @ aside)

    view = max(views(), key=merit)
    body = {"name": instrument.body, "node": packed(place), "element": packed(element, "u4"), "lines": False}
    return of_rest([body], view)


def played(
    instrument: Instrument, scene: Scene, kernel: Kernel, keyboard: Keyboard | None = None
) -> dict[str, Any]:
    """What instrument.js needs."""
    left, right = instrument.channels
    heard = f"You hear the velocity of {left}" + (f" and {right}" if right != left else "")
    return {
        "body": instrument.body,
        "wasm": base64.b64encode(module()).decode(),
        "block": base64.b64encode(instrument.block()).decode(),
        "picture": picture_of(instrument, scene, kernel, keyboard),
        "keys": keyboard.names if keyboard else [],
        "points": packed([place.point for place in instrument.places]),
        "normals": packed([place.normal for place in instrument.places]),
        "frequency": packed(instrument.omega / (2 * np.pi)),
        "decay": packed(instrument.decay),
        "mallets": [mallet.name for mallet in instrument.mallets],
        "speed": instrument.speed,
        "note": f"{heard}: {len(instrument.omega)} modes up to {instrument.omega[-1] / (2 * np.pi):.0f} Hz. Contact is "
        "computed as it happens, against the body as it rings. Drag to turn, scroll or pinch to come nearer.",
    }


def run_of_instrument(
    instrument: Instrument, scene: Scene, kernel: Kernel, keyboard: Keyboard | None = None
) -> dict[str, Any]:
    """The content of a page that has nothing but the instrument."""
    return {
        "title": scene.title,
        "bodies": [{"name": instrument.body}],
        "episodes": [],
        "instrument": played(instrument, scene, kernel, keyboard),
    }


def of_run(path: Path, folder: Path) -> dict[str, Any]:
    """The instrument of a result for its page, or {"missing": reason}."""
    try:
        scene, kernels = of_result(Result(path), folder)
        instrument = instrument_of(scene, kernels, most=REPORTED)
        return played(instrument, scene, kernels[instrument.body])
    except InputError as problem:
        return {"missing": str(problem)}


def of_result(result: Result, folder: Path) -> tuple[Scene, dict[str, Kernel]]:
    """The scene of a result and its kernels. Raises InputError if one is missing."""
    found = {}
    for name in result.scene.get("bodies", {}):
        if name not in result.bodies:
            raise InputError(f"{result.path}: has no body {name!r}. Compute it again.")
        file = folder / Path(result._file.text(f"/bodies/{name}", "kernel") or "none").name
        if not is_there(file):
            raise InputError(f"{file}: there is no such kernel. Name its folder with --kernels.")
        found[name] = Kernel(file)
    table = {key: value for key, value in result.scene.items() if key != "loads"}
    return Scene(table, result.path.parent), found
