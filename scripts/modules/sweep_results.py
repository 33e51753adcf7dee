"""What a sweep found: its journal, its tables."""
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

import whole_file
from result_file import BadInput


class Journal:
    """A line of JSON for each impact that is finished, {"key", "status", "summary" or "error"}, in <stem>.sweep.jsonl; a
    part of a sweep has <stem>.sweep.K-of-N.jsonl of its own beside it, and all read all. What was written stays, whatever
    ends the sweep; half a line at the end of one's own is cut off, and a line that a disk spoilt counts as none."""

    def __init__(self, stem, part=None, reads_only=False):
        stem.parent.mkdir(parents=True, exist_ok=True)
        path = Path(f"{stem}.sweep.{part[0]}-of-{part[1]}.jsonl" if part else f"{stem}.sweep.jsonl")
        self.rows = {}
        if not reads_only:  # else it may be one that is being written
            self.file = open(path, "ab")
            lock(self.file, path)
        for other in sorted(stem.parent.glob(f"{glob.escape(stem.name)}.sweep*.jsonl")):
            for row in filter(None, map(row_of, whole_lines(other).split(b"\n"))):
                self.rows[row["key"]] = row
        if not reads_only:
            self.file.truncate(len(whole_lines(path)))

    def add(self, key, answer):
        """`answer`: a line of JSON; one of a process that died is for the tables of this run alone."""
        row = b'{"key": "%s", %s\n' % (key.encode(), answer[1:])
        self.rows[key] = json.loads(row)
        if "died" not in self.rows[key]:
            self.file.write(row)
            self.file.flush()

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
    """None of a line that no sweep wrote."""
    try:
        row = json.loads(line)
        whole = isinstance(row["key"], str) and isinstance(row["status"], int) and isinstance(row.get("summary", {}), dict)
        return row if whole else None
    except (ValueError, KeyError, TypeError):
        return None


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
        self.title, self.scene = study.title, study.scene
        self.inputs = {key: [setting[key] for setting in study.settings] for key in study.keys}
        self.status = [-1 if row is None else row["status"] for row in rows]
        self.error = ["" if row is None else row.get("error", "") for row in rows]
        found = [outputs(row["summary"]) if row and "summary" in row else {} for row in rows]
        names = list(dict.fromkeys(name for columns in found for name in columns))
        self.outputs = {name: [columns.get(name, math.nan) for columns in found] for name in names}

    def write_csv(self, path):
        file = io.StringIO(newline="")
        table = csv.writer(file)
        table.writerow([*self.inputs, *self.outputs, "status", "error"])
        text = [[value if isinstance(value, (int, float, str)) else json.dumps(value) for value in column]
                for column in self.inputs.values()]
        table.writerows(zip(*text, *self.outputs.values(), self.status, self.error))
        whole_file.write(path, file.getvalue().encode())

    def write_hdf5(self, path):
        """/inputs/KEY, /outputs/NAME, /status, /error, all (settings); texts and lists as JSON."""
        image = io.BytesIO()  # HDF5 itself crashes on a full disk
        with h5py.File(image, "w") as file:
            file.attrs["format"], file.attrs["version"] = "ricochet-sweep", 1
            file.attrs["title"], file.attrs["scene"] = self.title, str(self.scene)
            for key, column in self.inputs.items():
                file.create_dataset(f"inputs/{key.replace('/', '_')}", data=as_array(column))
            for name, column in self.outputs.items():
                file.create_dataset(f"outputs/{name}", data=np.array(column, dtype=float))
            file["status"] = np.array(self.status, dtype=np.int8)
            file.create_dataset("error", data=self.error, dtype=h5py.string_dtype())
        whole_file.write(path, image.getbuffer())

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
