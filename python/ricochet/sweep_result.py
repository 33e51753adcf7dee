# SPDX-License-Identifier: BSD-2-Clause
"""The results of a study: the figures of all its impacts, and their records."""

from __future__ import annotations

import html
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Floats
from ricochet.studies import histories
from ricochet.studies.histories import Record
from ricochet.studies.table import Table


class SweepResult:
    """The figures of all impacts of a study. All columns have a row for each impact.

    The result keeps its file open, so another sweep that writes a file of the same name does not change it.
    """

    #: columns that a notebook shows
    SHOWN = ("peak_force_n", "impulse_ns", "restitution", "contact_steps")

    def __init__(self, table: Table, path: Path) -> None:
        self.title = table.title
        #: <title>.sweep.h5
        self.path = path
        self._file = h5py.File(path, "r", locking=False)
        #: values of the varied keys
        self.inputs: dict[str, NDArray[Any]] = {
            name: np.array(column) for name, column in table.inputs.items()
        }
        #: figures of summary.json, such as `exit_velocity.upper.y`, and `touched` (1 or 0); NaN if an impact
        #: does not have one
        self.outputs: dict[str, Floats] = {
            name: np.array(column, dtype=np.float64) for name, column in table.outputs.items()
        }
        #: 0: finished, 2: refused, 1: failed
        self.status: NDArray[np.int64] = np.array(table.status, dtype=np.int64)
        #: the reason why an impact was refused or failed, one line
        self.error: list[str] = list(table.error)
        #: the warnings of each impact, one sentence each
        self.warnings: list[list[str]] = [list(texts) for texts in table.warnings]

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A column of the inputs or outputs. Raises KeyError."""
        return self.inputs[name] if name in self.inputs else self.outputs[name]

    def __len__(self) -> int:
        return len(self.status)

    @cached_property
    def histories(self) -> list[str]:
        """The names that `history` takes; empty if the study keeps none."""
        rows = self._file.get("histories", {})
        return list(dict.fromkeys(name for row in rows.values() for name in histories.names_in(row)))

    def history(self, row: int, name: str) -> Record:
        """A quantity of an impact over time, if the study keeps it: `time` (k) [s], `values` (k) or (k,3) in
        world axes, stress (k,6) in the axes of its body, and `unit`.

        row: number of the impact, from 0; negative numbers count from the end.
        name: `force`, the total contact force; `receivers.NAME` and `bodies.NAME`, velocities, of which
            `receivers.NAME.x` is a component; `acceleration.NAME`, that of a receiver; `gauges.NAME.stress`, of which
            `gauges.NAME.stress.xx` is a component, `gauges.NAME.von_mises` and `gauges.NAME.strain`, those of a gauge;
            `energy.TERM`, a term of the ledger.

        Raises InputError, one line, for a name that does not exist and for an impact without records, and
        IndexError for a row that does not exist.
        """
        return histories.read(self._file, range(len(self))[row], name)

    def __repr__(self) -> str:
        failed = np.count_nonzero(self.status)
        return f"<SweepResult {self.title!r}: {', '.join(self.inputs)}; {len(self)} impacts, {failed} failed>"

    def _repr_html_(self) -> str:
        names = [*self.inputs, *(name for name in self.SHOWN if name in self.outputs)]
        head = "".join(f"<th>{html.escape(name)}</th>" for name in [*names, "error"])
        body = ""
        for row in range(len(self)):
            cells = [_text(self[name][row]) for name in names] + [self.error[row]]
            body += "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>"
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
