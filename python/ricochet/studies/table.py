# SPDX-License-Identifier: BSD-2-Clause
"""Tables of studies: inputs and outputs of all settings, as CSV and HDF5."""
import copy
import io
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ricochet import files
from ricochet.errors import InputError
from ricochet.studies.journal import outputs
from ricochet.studies.records import Row
from ricochet.studies.study import Study, utf8


class Table:
    """Inputs and outputs of all settings as columns of equal length. The outputs of a refused setting are
    NaN."""

    def __init__(self, study: Study, rows: Sequence[Row | None]) -> None:
        """`rows`: rows of the journal, in the order of the settings; None for an impact that has not run."""
        self.title, self.scene = study.title, utf8(study.scene)
        self.inputs = {key: [setting[key] for setting in study.settings] for key in study.keys}
        self.status = [-1 if row is None else row["status"] for row in rows]
        self.error = ["" if row is None else row.get("error", "") for row in rows]
        found = [outputs(row["summary"]) if row and row["status"] == 0 else {} for row in rows]
        names = list(dict.fromkeys(name for columns in found for name in columns))
        self.outputs = {name: [columns.get(name, math.nan) for columns in found] for name in names}

    def write_csv(self, path: Path) -> None:
        inputs = [list(map(text_or_number, column)) for column in self.inputs.values()]
        titles = [*self.inputs, *self.outputs, "status", "error"]
        files.write_csv(path, titles, zip(*inputs, *self.outputs.values(), self.status, self.error))

    def write_hdf5(self, path: Path) -> None:
        """Writes /inputs/KEY, /outputs/NAME, /status and /error, each with a value for each setting; texts
        and lists as JSON."""
        image = io.BytesIO()  # written to memory first, because HDF5 crashes if the disk is full
        with h5py.File(image, "w") as file:
            file.attrs["format"], file.attrs["version"] = "ricochet-sweep", 1
            file.attrs["title"], file.attrs["scene"] = self.title, self.scene
            for key, column in self.inputs.items():
                file.create_dataset(f"inputs/{key.replace('/', '_')}", data=as_array(column))
            for name, column in self.outputs.items():
                file.create_dataset(f"outputs/{name}", data=np.array(column, dtype=float))
            file["status"] = np.array(self.status, dtype=np.int8)
            file.create_dataset("error", data=self.error, dtype=h5py.string_dtype())
        files.write(path, image.getbuffer())

    def with_values(self, names: Sequence[str]) -> "Table":
        """The rows in which each of the columns contains a finite number, a text or a list."""

        def value(v: Any) -> bool:
            return math.isfinite(v) if isinstance(v, (int, float)) else v is not None

        kept = [k for k, row in enumerate(zip(*map(self.column, names))) if all(map(value, row))]
        less = copy.copy(self)
        less.inputs, less.outputs = (
            {name: [column[k] for k in kept] for name, column in columns.items()}
            for columns in (self.inputs, self.outputs)
        )
        less.status, less.error = ([column[k] for k in kept] for column in (self.status, self.error))
        return less

    def column(self, name: str) -> list[Any]:
        columns = self.inputs | self.outputs
        if name not in columns:
            raise InputError(f"\"{name}\" is not a column of this sweep, which has {', '.join(columns)}")
        return columns[name]


def text_or_number(value: Any) -> str | float:
    """A value of a key as stored in tables; lists as JSON."""
    return value if isinstance(value, (int, float, str)) else json.dumps(value)


def is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def as_array(column: list[Any]) -> NDArray[Any]:
    if all(map(is_number, column)):
        return np.array(column, dtype=float)
    texts = [value if isinstance(value, str) else json.dumps(value) for value in column]
    return np.array(texts, dtype=h5py.string_dtype())
