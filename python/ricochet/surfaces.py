# SPDX-License-Identifier: BSD-2-Clause
"""The surfaces of a drawing or mesh that gmsh can read, as a table."""
import multiprocessing
import os
import signal
import tempfile
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from ricochet import drawing
from ricochet.arrays import Floats
from ricochet.drawing import Drawing
from ricochet.errors import InputError


def answer(path: Path, to: Connection, log: int) -> None:
    """Sends what `drawing.read_here` returns, or the message of its error. What gmsh prints goes to `log`."""
    os.dup2(log, 1), os.dup2(log, 2)
    try:
        to.send(drawing.read_here(path))
    except Exception as problem:  # gmsh raises Exception itself
        to.send(" ".join(str(problem).split()))
    to.close()
    os._exit(0)  # gmsh crashes when it deletes some models


def read(path: Path, seconds: float = 600) -> Drawing:
    """Reads the surfaces. A drawing is meshed coarsely. gmsh runs in a process of its own, which may crash, end or take
    too long. Raises InputError."""
    if not drawing.INSTALLED:
        raise InputError("needs the Debian package python3-gmsh: run scripts/setup")
    if not path.is_file():
        raise InputError(f"{path}: there is no such file: name a .step, .brep, .geo or .msh")
    context = multiprocessing.get_context("fork")
    with tempfile.TemporaryFile() as log:
        mine, its = context.Pipe(duplex=False)
        process = context.Process(target=answer, args=(path, its, log.fileno()), daemon=True)
        process.start()
        its.close()
        late = not mine.poll(seconds)
        if late:
            process.kill()
        try:
            found = mine.recv()
        except EOFError:
            found = None
        process.join()
        log.seek(0)
        lines = log.read().decode(errors="replace").split("\n")
    if isinstance(found, str):
        raise InputError(f"{path}: {found}")
    if found is None:
        ended = f"took more than {seconds:g} s" if late else "ended"
        if not late and process.exitcode and process.exitcode < 0:
            ended = f"crashed ({signal.Signals(-process.exitcode).name})"
        said = [line for line in lines if line.startswith("Error")] or [
            line for line in lines if line.strip()
        ]
        last = f"; its last message: {' '.join(said[-1].split())}" if said else ""
        raise InputError(f"{path}: gmsh {ended} before it had read the surfaces{last}: repair the drawing")
    if not found.surfaces:
        raise InputError(f"{path}: has no surfaces: name a drawing or mesh of a solid")
    assert isinstance(found, Drawing)
    return found


def table(found: Drawing) -> str:
    """A line for each surface: number, groups, kind, area and extent, in the units of the file."""

    def row(numbers: Floats) -> str:
        return "[" + ", ".join(f"{x:.4g}" for x in np.round(numbers, 9) + 0.0) + "]"

    rows: list[tuple[str, ...]] = [("surface", "groups", "kind", "area", "from [x, y, z]", "to [x, y, z]")]
    for one in found.surfaces:
        names = ", ".join(one.groups) or "–"
        rows.append((str(one.number), names, one.kind, f"{one.area:.4g}", row(one.low), row(one.high)))
    widths = [max(map(len, column)) for column in zip(*rows)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(line, widths)) for line in rows)
    return "\n".join(line.rstrip() for line in lines)
