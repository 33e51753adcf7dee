# SPDX-License-Identifier: BSD-2-Clause
"""The programs that scripts/verify --kills kills, on small scenes, and checks of the files that they leave."""
import csv
import json
import os
import zlib

import h5py
import numpy as np

import scenes
from ricochet import programs

SCENE = scenes.two_rods(
    "Kills",
    "up_to_hz = 140",
    "rate_hz = 48000\nduration = 0.5",
    elements=(600, 20),
    more='[[output.receiver]]\nname = "end"\nbody = "resting"\nat = [1, 0, 0]',
)

STUDY = """
scene = "kills.toml"
title = "Many"
keep = ["force"]
[set]
"modes.up_to_hz" = 5.0
"time.rate_hz" = 1000
"time.duration" = 4.0
[grid]
"bodies.moving.velocity[0]" = { from = 0.01, to = 0.02, steps = 80 }
"bodies.resting.material.young" = [1.0, 2.0]
"""

# These datasets are errors of the modes, and of a free body.
ROUND_OFF = ("modes/residual", "loads/body_force_residual")
TIMINGS = ("wall_s", "real_time_factor")


def write_scenes(folder):
    for name, text in (("rod.geo", scenes.rod()), ("kills.toml", SCENE), ("kills-study.toml", STUDY)):
        (folder / name).write_text(text)


def files(out):
    """Files with final names: path within `out` as text → Path."""
    return {
        str(path.relative_to(out)): path
        for path in sorted(out.rglob("*"))
        if path.is_file() and path.suffix != ".partial"
    }


def leftovers(out):
    return [str(path.relative_to(out)) for path in out.rglob("*.partial")]


def same_numbers(one, other):
    """Whether two HDF5 files agree up to round-off. Slices may be read or computed, on one rank or two."""
    with h5py.File(one) as a, h5py.File(other) as b:
        found, wanted = [], []
        a.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
        b.visititems(lambda name, item: wanted.append(name) if isinstance(item, h5py.Dataset) else None)
        if found != wanted or a.attrs["hash"] != b.attrs["hash"]:
            return False
        for name in found:
            x, y = a[name][()], b[name][()]
            if x.shape != y.shape or x.dtype != y.dtype:
                return False
            if (
                x.dtype.kind == "f"
                and name not in ROUND_OFF
                and x.size
                and np.abs(x - y).max() > 1e-7 * np.abs(y).max()
            ):
                return False
    return True


def is_slice(path):
    """Whether a slice, or the plan of slices, is complete."""
    try:
        with h5py.File(path) as file:
            if path.name == "plan.h5":
                return file["end"].shape == (2,) and file["tasks"].shape[1] == 3
            return file["slice"].shape == (4,) and file["shape"].shape[0] == file["lambda"].shape[0]
    except (OSError, KeyError):
        return False


class Subject:
    """A program that is killed. `whole` is the folder that an undisturbed run leaves."""

    victims = ("all",)
    keeps = ()
    under_mpirun = False

    def __init__(self, scenes, whole):
        self.scenes, self.whole = scenes, whole
        self.environment = os.environ | programs.ONE_THREAD | {"RICOCHET_BIN": str(programs.BIN)}

    def prepare(self, out, random):
        """Creates the folder for the first run of a life."""
        out.mkdir(parents=True)

    def finished(self, out):
        """Identifies the files that must be neither lost nor written again."""
        return (
            {
                name: (path.stat().st_ino, path.stat().st_mtime_ns)
                for name, path in files(out).items()
                if name.endswith(self.keeps)
            }
            if self.keeps
            else {}
        )

    def lost(self, before, out):
        after = self.finished(out)
        gone = {name for name in before if before[name] != after.get(name)}
        # Slices are removed once their kernel exists.
        return sorted(
            name
            for name in gone
            if not (
                ".slices/" in name
                and (out / name.split(".slices/")[0])
                .with_name(name.split(".slices/")[0] + ".kernel.h5")
                .exists()
            )
        )

    def outlived(self, before, out):
        """Temporary files that a terminated run should have removed. mpirun kills ranks a second after it has
        asked them to end, even if a slow disk delays them."""
        return sorted(
            name
            for name in set(leftovers(out)) - before
            if not (self.under_mpirun and (".slices/" in name or ".kernel.h5." in name))
        )

    def spoilt(self, out):
        """Names of files that are incomplete or differ from those of an undisturbed run."""
        return [name for name, path in files(out).items() if not self.is_whole(name, path)]

    def is_whole(self, name, path):
        if ".slices/" in name:
            return is_slice(path)
        wanted = self.whole / name
        return wanted.exists() and (path.read_bytes() == wanted.read_bytes() or self.alike(path, wanted))

    def alike(self, path, wanted):
        return path.name.endswith(".kernel.h5") and same_numbers(path, wanted)

    def complete(self, out):
        """Files that are missing or superfluous after an undisturbed run."""
        return sorted(set(files(out)) ^ set(files(self.whole)))


class Kernel(Subject):
    name = "ricochet-kernel"
    keeps = (".h5",)

    def command(self, out):
        # Without mpirun, a program under Open MPI would start a daemon.
        self.environment["OMPI_MCA_ess_singleton_isolated"] = "1"
        return [programs.BIN / "ricochet-kernel", self.scenes / "kills.toml", "--out", out]

    def phase(self, out, said):
        done = [
            line.split(":")[1].split("  ")[0].strip()
            for line in said.splitlines()
            if line.startswith(("moving:", "resting:"))
        ]
        last = done[-1] if done else ""
        if not done:
            return "start"
        if last.startswith(("counts", "slice", "round")):
            return "slices"
        return {"candidates": "counts", "certificate": "trace, writing", "trace": "trace, writing"}.get(
            last, "mesh, assembly"
        )


class Ranks(Kernel):
    name = "mpirun -n 2 ricochet-kernel"
    under_mpirun = True
    victims = ("all", "first", "one", "one")

    def command(self, out):
        return [*programs.mpirun(2), *super().command(out)]


class Contact(Subject):
    name = "ricochet-contact"

    def __init__(self, scenes, whole, earlier):
        super().__init__(scenes, whole)
        self.earlier = earlier

    def command(self, out):
        return [programs.BIN / "ricochet-contact", self.scenes / "kills.toml", "--out", out]

    def prepare(self, out, random):
        """Adds the kernels, and in half of all lives also the results of another impact with the same title."""
        super().prepare(out, random)
        had = self.earlier if random.random() < 0.5 else self.whole
        for name, path in files(had).items():
            if had == self.earlier or name.endswith(".kernel.h5"):
                (out / name).write_bytes(path.read_bytes())

    def phase(self, out, said):
        ended = [line.split()[0] for line in said.splitlines() if line]
        return "writing" if "steps" in ended else "steps" if "pairing" in ended else "start, kernels"

    def of(self, path, whole):
        wanted = whole / path.name
        if path.suffix == ".json":
            one, other = (json.loads(each.read_text()) for each in (path, wanted))
            return all(one[key] == other[key] for key in other if key not in TIMINGS)
        return path.read_bytes() == wanted.read_bytes()

    def spoilt(self, out):
        found = {
            name: [run for run in (self.whole, self.earlier) if self.of(path, run)]
            for name, path in files(out).items()
        }
        wrong = [name for name, runs in found.items() if not runs]
        # If there is a summary, all files belong to its run.
        for name in found if not wrong and "kills.summary.json" in found else ():
            if found["kills.summary.json"][0] not in found[name]:
                wrong.append(name + " beside the summary of another run")
        return wrong

    def complete(self, out):
        return super().complete(out) + [
            name for name, path in files(out).items() if not self.of(path, self.whole)
        ]


class Sweep(Subject):
    name = "sweep"
    under_mpirun = True
    victims = ("all", "first", "first", "one")
    keeps = (".kernel.h5",)

    def command(self, out):
        return [
            programs.BIN / "ricochet",
            "sweep",
            self.scenes / "kills-study.toml",
            "--jobs",
            "1",
            "--ranks",
            "1",
            "--out",
            out,
        ]

    def phase(self, out, said):
        names = files(out)
        if "many.sweep.jsonl" not in names:
            return "start"
        if not names["many.sweep.jsonl"].stat().st_size:
            return "checking, kernels"
        return "impacts" if self.journal(out)[0].count(b"\n") < len(self.rows(self.whole)) else "tables"

    def journal(self, out):
        path = out / "many.sweep.jsonl"
        content = path.read_bytes() if path.exists() else b""
        return content[: content.rfind(b"\n") + 1], content

    def finished(self, out):
        return super().finished(out) | {"journal": self.journal(out)[0]}

    def lost(self, before, out):
        return super().lost({key: value for key, value in before.items() if key != "journal"}, out) + [
            "journal"
        ] * (not self.journal(out)[1].startswith(before["journal"]))

    def rows(self, out):
        with open(out / "many.sweep.csv", newline="") as file:
            return [
                {key: value for key, value in row.items() if key not in TIMINGS}
                for row in csv.DictReader(file)
            ]

    def is_whole(self, name, path):
        if name == "many.sweep.jsonl":
            wanted = self.results(self.whole)
            return all(wanted.get(key) == value for key, value in self.results(path.parent).items())
        if name == "many.sweep.csv":
            # Impacts that have not run yet have no outputs.
            rows = self.rows(path.parent)
            return len(rows) == len(self.rows(self.whole)) and all(
                row == wanted for row, wanted in zip(rows, self.rows(self.whole)) if row["status"] == "0"
            )
        if name == "many.sweep.h5":
            with h5py.File(path) as file:
                return len(file["status"]) == len(self.rows(self.whole)) and "error" in file
        if name == "many.sweep.histories":
            content = path.read_bytes()
            lines = map(json.loads, self.journal(path.parent)[0].splitlines())
            return all(
                zlib.crc32(content[at["at"] : at["at"] + at["bytes"]]) == at["crc"]
                for at in (line["kept"] for line in lines)
            )
        return super().is_whole(name, path)

    def results(self, out):
        """Results of the journal by key. A repeated key is stored under a different key."""
        found = {}
        for line in self.journal(out)[0].splitlines():
            row = json.loads(line)
            key = row.pop("key")
            row["kept"] = row["kept"]["words"]  # a killed process may have left other histories before these
            for timing in TIMINGS:
                row["summary"].pop(timing)
            found[key if key not in found else key + " twice"] = row
        return found

    def complete(self, out):
        same = self.rows(out) == self.rows(self.whole) and self.results(out) == self.results(self.whole)
        return (
            super().complete(out)
            + ["the tables"] * (not same)
            + ["the histories"] * (self.histories(out) != self.histories(self.whole))
        )

    def histories(self, out):
        with h5py.File(out / "many.sweep.h5") as file:
            return {
                row: [values[()].tobytes() for values in impact["contact"].values()]
                for row, impact in file["histories"].items()
            }
