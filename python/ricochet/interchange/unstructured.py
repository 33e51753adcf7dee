# SPDX-License-Identifier: BSD-2-Clause
"""Meshes that Debian's python3-meshio reads: of FEniCS (.xdmf, .xml), Cubit (.e, .exo), Netgen (.vol) and others."""
import contextlib
import io
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ricochet.errors import InputError
from ricochet.interchange.cells import FACET, SOLID, Cells, labelled, mesh_of, no_pyramids
from ricochet.interchange.elements import SIZES
from ricochet.interchange.mesh import Mesh

DIMENSIONS = {"tetra": SOLID, "wedge": SOLID, "hexahedron": SOLID, "triangle": FACET, "quad": FACET}
WITHOUT = ("vertex", "line")  # points and lines, which are left out in silence
# Cell data that number the groups of their cells.
LABELS = (
    "gmsh:physical",
    "medit:ref",
    "cell_tags",
    "flac3d:group",
    "avsucd:material",
    "su2:tag",
    "tetgen:ref",
)


# Largest processor time of meshio [s], [s/byte]. It takes up to 6e-8 s/byte, but if a file states 1e12 entries, it looks for
# all of them behind the end.
LONGEST, LONGEST_PER_BYTE = 60.0, 2e-6


@contextlib.contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raises TimeoutError after this processor time, in the main thread."""

    def stop(*_: object) -> None:
        raise TimeoutError(f"it takes more than {seconds:.3g} s")

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def loaded(path: Path) -> Any:
    """The mesh as meshio has it. Raises InputError and OSError."""
    try:
        import meshio
    except ImportError:
        raise InputError(
            f"{path}: needs the Debian package python3-meshio: apt install python3-meshio"
        ) from None
    path.open("rb").close()
    said = io.StringIO()
    try:
        limit = LONGEST + LONGEST_PER_BYTE * path.stat().st_size
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), limited(limit):
            return meshio.read(path)
    except (Exception, SystemExit) as error:  # meshio asserts, indexes and exits where files are wrong
        text = " ".join(f"{error} {said.getvalue()}".split())[:120]
        raise InputError(
            f"{path}: meshio can't read it ({text or 'no reason given'}): export it as .vtu or .med"
        ) from None


def read(path: Path) -> Mesh:
    """The mesh of a file that meshio reads, in its units. Raises InputError and OSError."""
    data = loaded(path)
    label = next((name for name in LABELS if name in data.cell_data), None)
    blocks = []
    for number, cells in enumerate(data.cells):
        family, nodes = cells.type.rstrip("0123456789"), np.asarray(cells.data, np.int64)
        if family in WITHOUT:
            continue
        dim = DIMENSIONS.get(family)
        if dim is None or nodes.shape[1] not in SIZES[dim]:
            raise no_pyramids(path)
        groups = {
            name: np.asarray(sets[number], np.int64)
            for name, sets in data.cell_sets.items()
            if not name.startswith("gmsh:") and sets[number] is not None and len(sets[number])
        }
        if label:
            names = {int(value[0]): name for name, value in data.field_data.items() if int(value[1]) == dim}
            groups |= dict(labelled(np.asarray(data.cell_data[label][number]).ravel(), names))
        blocks.append(Cells(dim, nodes, groups))
    node_sets = {name: np.asarray(nodes, np.int64) for name, nodes in data.point_sets.items()}
    return mesh_of(path, np.asarray(data.points, float), blocks, node_sets)
