# SPDX-License-Identifier: BSD-2-Clause
"""Instruments, on which a body is struck and heard, from scenes and from results."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from ricochet import programs, runs
from ricochet.errors import InputError
from ricochet.interchange.instrument import Blow, Instrument, instrument_of
from ricochet.interchange.keyboard import OCTAVE, keyboard_of, name_of
from ricochet.interchange.lv2 import library, write_bundle
from ricochet.kernel import Kernel
from ricochet.pages.instrument import module, of_result, run_of_instrument
from ricochet.pages.page import INSTRUMENT, save_page
from ricochet.result import Result
from ricochet.scene import Scene


def write_instrument(
    source: Path,
    out: Path | None = None,
    *,
    form: Literal["web", "lv2"] = "web",
    body: str | None = None,
    spacing: float | None = None,
    keys: Sequence[int] = (),
    factor: float | None = None,
    settings: Sequence[str] = (),
    kernels: Path | None = None,
    ranks: int = 2,
) -> Path:
    """Writes an instrument and returns its path.

    source: a scene, whose body can then be struck all over its contact surface, or a result, whose body can be
    struck where its kernel has candidates.
    out: default: <slug>.html or <slug>.lv2 in the folder of kernels or of the result.
    form: a page to play, or a bundle with an LV2 plug-in.
    body: that sounds; default: the one with receivers.
    spacing: between places, for a scene; default: half the size of the mallet [m].
    keys: numbers of MIDI, ascending without gaps: the body becomes a bar for each of them (ricochet.interchange.keyboard).
    factor: on all lengths of the bar of the first key; default: such that it is in tune.
    settings: values of scene keys, each as KEY=VALUE.
    kernels: folder of the kernels; default: `out` beside the scene, or the folder of the result.
    ranks: MPI ranks of ricochet-kernel, which computes missing kernels of a scene.

    Raises InputError, one line, for scenes without two bodies that meet, and as ricochet.kernels does; before any
    work if the player that the form needs is not there.
    """
    library() if form == "lv2" else module()
    if factor is not None and not keys:
        raise InputError(
            "--scale-factor: is the size of the first bar of a keyboard. Add --keyboard, such as C4:B5."
        )
    if keys and spacing is not None:
        raise InputError("--spacing: a keyboard is struck at one place of each bar. Leave it out.")
    if keys and form == "lv2" and len(keys) % OCTAVE:
        raise InputError(
            f"--keyboard: has {len(keys)} keys, and a plug-in repeats its keys for the notes beyond. Give whole octaves, "
            f"such as {name_of(keys[0])}:{name_of(keys[0] + OCTAVE * (len(keys) // OCTAVE + 1) - 1)}."
        )
    keyboard = None
    if source.suffix == ".h5":
        if spacing is not None or settings:
            raise InputError(
                f"{source}: is a result, for which --set and --spacing have no use. Name a scene."
            )
        folder = kernels or source.parent
        scene, found = of_result(Result(source), folder)
        if keys:
            instrument, keyboard = keyboard_of(scene, found, keys, factor, body)
        else:
            instrument = instrument_of(scene, found, body)
    elif keys:
        scene = Scene(source)
        scene._load(list(settings))
        folder = kernels or scene.out
        found = runs.kernels(scene, ranks, folder)
        instrument, keyboard = keyboard_of(scene, found, keys, factor, body)
    else:
        instrument, scene, found = of_scene(source, body, spacing, settings, kernels, ranks)
        folder = kernels or programs.out_folder(source)
    if form == "lv2":
        bundle = out or folder / f"{scene.slug}.lv2"
        write_bundle(instrument, scene.title, bundle, keyboard)
        return bundle
    path = out or folder / f"{scene.slug}.html"
    run = run_of_instrument(instrument, scene, found[instrument.body], keyboard)
    save_page(run, path, "instrument.html", INSTRUMENT)
    return path


def of_scene(
    source: Path,
    body: str | None = None,
    spacing: float | None = None,
    settings: Sequence[str] = (),
    kernels: Path | None = None,
    ranks: int = 2,
) -> tuple[Instrument, Scene, dict[str, Kernel]]:
    """The instrument of a scene, the scene and its kernels. Arguments and errors are those of
    write_instrument."""
    scene = Scene(source)
    scene._load(list(settings))
    folder = kernels or scene.out
    found = all_over(Blow(scene, body), spacing, folder, ranks)
    return instrument_of(scene, found, body), scene, found


def all_over(blow: Blow, spacing: float | None, folder: Path, ranks: int) -> dict[str, Kernel]:
    """Kernels with candidates all over the mallet and, at distances of `spacing`, all over the body. Missing
    ones are computed. Without a reach or a zone, those of the scene have them."""
    if spacing is None and not blow.pair.keys() & {"reach", "zone"}:
        return runs.kernels(blow.scene, ranks, folder)
    modes = blow.table["modes"] | {"residual_components": "all"}
    pair = {key: value for key, value in blow.pair.items() if key not in ("reach", "zone", "spacing")}
    bodies, contact = {blow.mallet: blow.bodies[blow.mallet]}, {}
    if pair.keys() & {"direction", "along"}:  # candidates depend on the pair
        bodies, contact = blow.bodies, {"contact": pair}
    folder_of_scene = blow.scene.file.parent
    table = blow.table | {"title": f"{blow.scene.title}, {blow.mallet}", "modes": modes, "bodies": bodies}
    mallet = runs.kernels(Scene(table | contact, folder_of_scene), ranks, folder)[blow.mallet]
    size = spacing or 0.5 * float(np.ptp(mallet.node, axis=0).max())
    table |= {"title": f"{blow.scene.title}, {blow.body}", "bodies": blow.bodies}
    table["contact"] = pair | ({"spacing": size} if size > 0 else {})  # the end of a rod has no size
    table["output"] = {"view": True, "receiver": blow.receivers}
    return {
        blow.mallet: mallet,
        blow.body: runs.kernels(Scene(table, folder_of_scene), ranks, folder)[blow.body],
    }
