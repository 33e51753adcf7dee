# SPDX-License-Identifier: BSD-2-Clause
"""Pictures of results (contact, friction, snapshots, energy, stress, gauges) and of modes, as matplotlib figures and as files."""
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.files import save_picture, writing
from ricochet.pictures.comparison import Law
from ricochet.pictures.contact import contact_picture, table_picture
from ricochet.pictures.energy import energy_picture
from ricochet.pictures.friction import friction_picture
from ricochet.pictures.gauges import gauges_picture
from ricochet.pictures.modes import modes_picture
from ricochet.pictures.snapshots import snapshots_picture
from ricochet.pictures.stress import stress_picture
from ricochet.pictures.style import DPI, STYLE
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.moving_surfaces import moving_surfaces
from ricochet.result_file import File, expected

DRAWN_MODES = 6


def figures(
    result: LoadedResult, kernels: Path, note: Callable[[str], None], laws: Sequence[Law] = ()
) -> Iterator[tuple[str, Figure]]:
    """Yields the figures of a result with their names: "contact", "friction", "snapshots",
    "energy", "stress", "gauges"; of bodies at rest only the last two.

    @param kernels  folder of the kernels
    @param note     called with the reason for each figure that is omitted
    @param laws     whose forces are drawn beside those of the contact
    """
    stressed = stress_picture(result, kernels)
    if isinstance(stressed, Figure):
        yield "stress", stressed
    elif stressed is not None:
        note(f"no picture of stress: {stressed}")
    gauged = gauges_picture(result)
    if gauged:
        yield "gauges", gauged
    if result.static:
        if stressed is not None or gauged:
            return
        raise InputError(f"{result.path}: bodies at rest have no motion to draw. Use ricochet report.")
    if not result.energy:
        yield "contact", table_picture(result)
        note("no energies and no snapshots: runs with sampled responses have neither")
        return
    yield "contact", contact_picture(result, laws)
    if result.has_friction:
        if rubbed := friction_picture(result):
            yield "friction", rubbed
        else:
            note("no picture of friction: no point with friction touched")
    found = moving_surfaces(result, kernels)
    if isinstance(found, str):
        note(f"no picture of snapshots: {found}")
    elif result.episodes and (figure := snapshots_picture(result, *found)):
        yield "snapshots", figure
    else:
        note(f"no picture of snapshots: {why_unseen(result, found[1])}")
    yield "energy", energy_picture(result)


def why_unseen(result: LoadedResult, time: Array) -> str:
    """Why no snapshot at the times (s) shows the contact, and what to set."""
    if not result.episodes:
        return "nothing touched"
    lasts = max(end - start for start, end in result.spans())
    there = (
        f"they are {np.diff(time).min():.2g} s apart"
        if len(time) > 1
        else "there is only the one at the start"
    )
    return f"{there}, and contact lasts {lasts:.2g} s. Set a smaller output.snapshot_every, or a higher time.rate_hz"


def draw(
    path: Path,
    folder: Path | None = None,
    kernels: Path | None = None,
    note: Callable[[str], None] = lambda _: None,
    low_pass: float | None = None,
    laws: Sequence[Law] = (),
) -> Iterator[Path]:
    """Writes the pictures of the result file `path` as <slug>-<name>.png and yields their paths. Forces are
    drawn without vibration from the frequency `low_pass` [Hz] on, and beside those of `laws`. Raises InputError.
    """
    folder = folder or path.parent
    with expected(path), matplotlib.rc_context(STYLE):
        result = LoadedResult(path, low_pass)
        for name, figure in figures(result, kernels or path.parent, note, laws):
            picture = folder / f"{result.slug}-{name}.png"
            save(figure, picture)
            yield picture


def draw_modes(kernel: Path, folder: Path) -> Path | None:
    """Writes the picture of the first elastic modes of a kernel file as <body>-modes.png and returns its
    path, or None if the kernel has no elastic modes.

    Raises InputError, for example if the kernel has no visualisation surface.
    """
    with expected(kernel, "ricochet-kernel"), matplotlib.rc_context(STYLE | {"axes.grid": False}):
        file = File(kernel, "ricochet-kernel")
        path = folder / f"{file.text('/', 'body') or 'body'}-modes.png"
        figure = modes_picture(file, DRAWN_MODES)
        if figure is None:
            return None
        save(figure, path)
    return path


def save(figure: Figure, path: Path) -> None:
    """Writes a figure and creates its folder. Raises InputError."""
    with writing(path, "--out"):
        path.parent.mkdir(parents=True, exist_ok=True)
        save_picture(figure, path, dpi=DPI)
