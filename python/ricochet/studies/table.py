# SPDX-License-Identifier: BSD-2-Clause
"""Tables of studies: inputs and outputs of all settings, as CSV and HDF5."""
import copy
import hashlib
import io
import json
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ricochet import dimensions, files
from ricochet.errors import InputError
from ricochet.studies import histories
from ricochet.studies.histories import Source
from ricochet.studies.journal import outputs, warnings_of
from ricochet.studies.labels import of_magnitude, unit_of
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
        self.warnings = list(map(warnings_of, rows))
        self.keep = study.keep
        found = [outputs(row["summary"]) if row and row["status"] == 0 else {} for row in rows]
        names = list(dict.fromkeys(name for columns in found for name in columns))
        self.outputs = {name: [columns.get(name, math.nan) for columns in found] for name in names}

    def write_csv(self, path: Path) -> None:
        inputs = [list(map(text_or_number, column)) for column in self.inputs.values()]
        titles = [*self.inputs, *self.outputs, "warning_texts", "status", "error"]
        texts = [" | ".join(warnings) for warnings in self.warnings]
        columns = zip(*inputs, *self.outputs.values(), texts, self.status, self.error)
        files.write_csv(path, titles, columns)

    def write_hdf5(self, path: Path, sources: Sequence[Source], units: dict[str, str]) -> None:
        """Writes /inputs/KEY, /outputs/NAME, /status, /error and /warning_texts, each with a value for each
        setting; texts and lists as JSON, and the warnings of a setting as lines. If the study keeps records,
        copies those of `sources` to /histories. `units`: of scene keys (scene_keys.units). Raises OSError."""
        image = io.BytesIO()  # written to memory first, because HDF5 crashes if the disk is full
        with h5py.File(image, "w") as file:
            self._fill(file, units)
        if not self.keep:
            files.write(path, image.getbuffer())
            return
        content = self._fingerprint(sources)
        if content == fingerprint_of(path):
            return
        with files.replacing(path) as place:
            place.write_bytes(image.getbuffer())
            with h5py.File(place, "r+", locking=False) as file:
                histories.reserve(place, file.id.get_filesize() + histories.room_for(sources))
                file.attrs["content"] = content
                histories.copy(file, sources, self.keep, len(self.status))
                file.flush()
                size = file.id.get_filesize()
            os.truncate(place, size)  # the space that was reserved and is not needed

    def _fill(self, file: h5py.File, units: dict[str, str]) -> None:
        file.attrs["format"], file.attrs["version"] = "ricochet-sweep", 1
        file.attrs["title"], file.attrs["scene"] = self.title, self.scene
        impact = dimensions.scale(file, "impact", np.arange(len(self.status)))
        columns = [
            (f"inputs/{key.replace('/', '_')}", key, as_array(self.inputs[key])) for key in self.inputs
        ]
        columns += [(f"outputs/{name}", name, np.array(self.outputs[name], float)) for name in self.outputs]
        for place, column, values in columns:
            unit = unit_of(column, units) if values.dtype == float else ""
            dimensions.name(file.create_dataset(place, data=values), [impact], unit)
        for title, texts, kind in (
            ("status", self.status, np.int8),
            ("error", self.error, h5py.string_dtype()),
            ("warning_texts", list(map("\n".join, self.warnings)), h5py.string_dtype()),
        ):
            dimensions.name(file.create_dataset(title, data=texts, dtype=kind), [impact])

    def _fingerprint(self, sources: Sequence[Source]) -> str:
        """Identifies the content of the HDF5 file, so that records are not copied again for nothing."""
        parts = [self.title, self.scene, self.keep, self.inputs, self.outputs, self.status, self.error]
        places = [(source.row, *source.kept) for source in sources]
        return hashlib.sha256(json.dumps([parts, self.warnings, places]).encode()).hexdigest()

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
        less.status, less.error, less.warnings = (
            [column[k] for k in kept] for column in (self.status, self.error, self.warnings)
        )
        return less

    def count(self, status: int) -> int:
        """Number of settings with a status."""
        return self.status.count(status)

    def column(self, name: str) -> list[Any]:
        """The values of an input or an output. "abs(NAME)": their absolute values, or the lengths of vectors.
        Raises InputError if there is no such column, or if it has values without a length."""
        if (inner := of_magnitude(name)) != name:
            return [magnitude(inner, value) for value in self.column(inner)]
        columns = self.inputs | self.outputs
        if name not in columns:
            raise InputError(f"\"{name}\" is not a column of this sweep, which has {', '.join(columns)}")
        return columns[name]


def fingerprint_of(path: Path) -> str | None:
    """The fingerprint of a file that `Table` has written; None if there is none."""
    try:
        with h5py.File(path, "r") as file:
            return file.attrs.get("content")
    except OSError:
        return None


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


def magnitude(name: str, value: Any) -> float:
    parts = value if isinstance(value, list) else [value]
    if not all(map(is_number, parts)):
        raise InputError(
            f'abs({name}): "{value}" is neither a number nor a vector. Name the column without abs'
        )
    return math.hypot(*parts)
