# SPDX-License-Identifier: BSD-2-Clause
"""What a sweep found: its journal, its tables."""
import copy
import csv
import fcntl
import glob
import io
import json
import math
import os
from pathlib import Path

import h5py
import numpy as np

from ricochet import files
from ricochet.result_file import BadInput
from ricochet.studies.study import utf8


class Journal:
    """A line of JSON for each impact that was run, {"key", "status", "summary" or "error"}, in <stem>.sweep.jsonl; a part of
    a sweep has <stem>.sweep.K-of-N.jsonl of its own beside it, and all read all. Those of status 0 are finished; what was
    refused or broke down may have had a reason that has gone. What was written stays, whatever ends the sweep; half a line
    at the end of one's own is cut off, and a line that a disk spoilt counts as none."""

    def __init__(self, stem, part=None, reads_only=False):
        stem.parent.mkdir(parents=True, exist_ok=True)
        path = Path(f"{stem}.sweep.{part[0]}-of-{part[1]}.jsonl" if part else f"{stem}.sweep.jsonl")
        self.rows = {}
        if not reads_only:  # else it may be one that is being written
            self.file = open(path, "ab")
            lock(self.file, path)
        for other in sorted(stem.parent.glob(f"{glob.escape(stem.name)}.sweep*.jsonl")):
            for row in filter(None, map(row_of, whole_lines(other).split(b"\n"))):
                self._keep(row)
        if not reads_only:
            self.file.truncate(len(whole_lines(path)))

    def add(self, key, answer):
        """`answer`: a line of JSON; one of a process that died is for the tables of this run alone."""
        line = b'{"key": "%s", %s\n' % (key.encode(), answer[1:])
        row = json.loads(line)
        if "died" not in row and row != self.rows.get(key):
            self.file.write(line)
            self.file.flush()
        self._keep(row)

    def _keep(self, row):
        if not self.finished(row["key"]):
            self.rows[row["key"]] = row

    def finished(self, key):
        return key in self.rows and self.rows[key]["status"] == 0

    def sync(self):
        os.fsync(self.file.fileno())


def lock(file, path):
    """Until this process ends. Where a file system has no locks, nothing tells of another sweep."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise BadInput(f"{path}: another sweep is writing it: wait until it has ended, or give another --out") from None
    except OSError:
        pass


def row_of(line):
    """None of a line that no sweep wrote, or that tables can't hold."""
    try:
        row = json.loads(line)
        found = outputs(row["summary"]) if row["status"] == 0 else {}
        [float(value) for value in found.values() if value is not None]
        texts = [row["key"], row.get("error", ""), *found]
        whole = type(row["status"]) is int and row["status"] in (0, 1, 2) and all(map(storable, texts)) and \
            not any(name in ("", ".") or "/" in name for name in found)
        return row if whole else None
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        return None


def storable(text):
    """Whether HDF5 takes it. Raises UnicodeEncodeError of half characters."""
    return isinstance(text, str) and b"\0" not in text.encode()


def whole_lines(path):
    content = path.read_bytes()
    return content[:content.rfind(b"\n") + 1]


def outputs(summary):
    """The numbers of a summary by name: "restitution", "exit_velocity.upper.y", "episodes" (how many)."""
    found = {}
    for name, value in summary.items():
        if name == "episodes":
            found[name] = len(value)
        elif name == "warnings":
            found["warnings"] = len(value)
        elif name == "pairs":
            found |= {f"pairs.{k}.{key}": item for k, pair in enumerate(value) for key, item in pair.items()}
        elif isinstance(value, dict):
            for key, item in value.items():
                if isinstance(item, list):
                    found |= {f"{name}.{key}.{axis}": v for axis, v in zip("xyz", item)}
                elif isinstance(item, (int, float)):
                    found[f"{name}.{key}"] = item
        elif value is None or isinstance(value, (int, float)):
            found[name] = math.nan if value is None else value
    return found


class Table:
    """Inputs and outputs of all settings as columns of equal length; a setting that was refused has NaN outputs."""

    def __init__(self, study, rows):
        """`rows`: of the journal in the order of the study's settings, None where there is none yet."""
        self.title, self.scene = study.title, utf8(study.scene)
        self.inputs = {key: [setting[key] for setting in study.settings] for key in study.keys}
        self.status = [-1 if row is None else row["status"] for row in rows]
        self.error = ["" if row is None else row.get("error", "") for row in rows]
        found = [outputs(row["summary"]) if row and row["status"] == 0 else {} for row in rows]
        names = list(dict.fromkeys(name for columns in found for name in columns))
        self.outputs = {name: [columns.get(name, math.nan) for columns in found] for name in names}

    def write_csv(self, path):
        file = io.StringIO(newline="")
        table = csv.writer(file)
        table.writerow([*self.inputs, *self.outputs, "status", "error"])
        text = [[value if isinstance(value, (int, float, str)) else json.dumps(value) for value in column]
                for column in self.inputs.values()]
        table.writerows(zip(*text, *self.outputs.values(), self.status, self.error))
        files.write(path, file.getvalue().encode())

    def write_hdf5(self, path):
        """/inputs/KEY, /outputs/NAME, /status, /error, all (settings); texts and lists as JSON."""
        image = io.BytesIO()  # HDF5 itself crashes on a full disk
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

    def with_values(self, names):
        """This table without the rows in which one of the columns is no finite number and no text or list."""
        def value(v):
            return math.isfinite(v) if isinstance(v, (int, float)) else v is not None

        kept = [k for k, row in enumerate(zip(*map(self.column, names))) if all(map(value, row))]
        less = copy.copy(self)
        less.inputs, less.outputs = ({name: [column[k] for k in kept] for name, column in columns.items()}
                                     for columns in (self.inputs, self.outputs))
        less.status, less.error = ([column[k] for k in kept] for column in (self.status, self.error))
        return less

    def column(self, name):
        columns = self.inputs | self.outputs
        if name not in columns:
            raise BadInput(f"\"{name}\" is no column of this sweep: it has {', '.join(columns)}")
        return columns[name]


def as_array(column):
    numeric = all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in column)
    if numeric:
        return np.array(column, dtype=float)
    return np.array([value if isinstance(value, str) else json.dumps(value) for value in column], dtype=h5py.string_dtype())
