# SPDX-License-Identifier: BSD-2-Clause
"""What ricochet tradeoff runs: settings of a scene, their kernels and impacts, and a record of all that is finished."""
import hashlib
import itertools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass

from ricochet import programs

SCHEMES = {"compliant": {"contact.scheme": "compliant"},
           "jump": {"contact.scheme": "impulse", "contact.admittance": "jump"},
           "difference": {"contact.scheme": "impulse", "contact.admittance": "difference"}}


def words(changes):
    return programs.with_set(programs.settings(changes))


@dataclass(frozen=True)
class Kernel:
    """What kernels are computed with."""

    basis: str
    size: float  # modes, or flexibility error of vectors fitted to contact
    residual: bool
    order: int | None
    tolerance: float
    spacing: float | None
    band_hz: float | None

    def changes(self, scene):
        if self.basis == "modes":
            modes = {"basis": "modes", "count": int(self.size), "residual_flexibility": self.residual,
                     "relative_residual": self.tolerance}
        else:
            modes = {"basis": "contact", "up_to_hz": self.band_hz, "flexibility_error": self.size}
        found = {"modes": modes, "output.view": False, "output.snapshot_every": 0, "output.every": 1000}
        if self.order is not None:
            found |= {f"bodies.{body}.order": self.order for body in scene.meshed}
        if self.spacing is not None:
            found["contact.spacing"] = self.spacing
        return found

    def name(self):
        size = f"{self.size:g} modes{'' if self.residual else ' without R'}" if self.basis == "modes" else \
            f"fitted to {self.size:g}"
        return size + (f", order {self.order}" if self.order is not None else "")


@dataclass(frozen=True)
class Impact:
    scheme: str
    rate_hz: float
    precision: str = "double"

    def changes(self):
        return SCHEMES[self.scheme] | {"time.rate_hz": self.rate_hz} | \
            ({"time.precision": self.precision} if self.precision != "double" else {})


class Scene:
    """The scene with every default, and what its settings are varied from."""

    def __init__(self, path, settings, band=None):
        self.path, self.settings = path, settings
        self.text = programs.resolved(path, programs.with_set(settings))
        table = tomllib.loads(self.text)
        self.table = table
        self.meshed = [name for name, body in table["bodies"].items()
                       if not str(body["mesh"]).endswith(".msh") and "area" not in body["material"]]
        self.order = max((table["bodies"][name]["order"] for name in self.meshed), default=None)
        self.spacing = table["contact"].get("spacing")
        self.rate_hz = table["time"].get("rate_hz", 44100.0)
        self.band = band or table["modes"].get("up_to_hz")


class Store:
    """One JSON line for each finished run. A line is whole or it is not counted; what is there is not run again."""

    def __init__(self, path):
        self.path, self.rows = path, {}
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists():
            whole = path.read_bytes()
            whole = whole[:whole.rfind(b"\n") + 1]
            for line in whole.decode().splitlines():
                row = json.loads(line)
                self.rows[row["key"]] = row
            with open(path, "r+b") as file:  # cut off what a kill left half written
                file.truncate(len(whole))

    def add(self, row):
        self.rows[row["key"]] = row
        with open(self.path, "a") as file:
            file.write(json.dumps(row) + "\n")
            file.flush()
            os.fsync(file.fileno())
        return row


class Runner:
    """Computes kernels and impacts of one scene into a folder, each once."""

    def __init__(self, scene, folder, ranks, repeats):
        self.scene, self.folder, self.ranks, self.repeats = scene, folder, ranks, repeats
        self.store = Store(folder / "runs.jsonl")

    def key(self, *settings):
        return hashlib.sha256(json.dumps([self.scene.text, *settings], sort_keys=True).encode()).hexdigest()[:16]

    def kernel_key(self, kernel):
        return self.key(kernel.changes(self.scene), self.ranks)

    def kernel(self, kernel):
        """Time [s] and peak memory [MiB] of its kernels, computed from nothing in one go."""
        key = self.kernel_key(kernel)
        folder = self.folder / key
        row = self.store.rows.get(key)
        if row and (folder.is_dir() or "refused" in row):
            return row
        shutil.rmtree(folder, ignore_errors=True)  # a time is of a whole run only
        changes = kernel.changes(self.scene)
        command = programs.mpirun(self.ranks) + [programs.BIN / "ricochet-kernel", self.scene.path, "--out", folder,
                                                 *programs.with_set(self.scene.settings), *words(changes)]
        done = timed(command)
        row = {"key": key, "kernel": changes, "kernel_s": done.seconds}
        if done.status != 0:
            return self.store.add(row | refusal(done))
        peak = re.search(r"^total .* (\d+) MiB", done.text, re.MULTILINE)  # of the rank that needs most
        return self.store.add(row | {"kernel_mib": int(peak[1]) if peak else None})

    def impact(self, kernel, impact):
        """Outcome of one impact with kernels that are there, and the time [s] of all its steps, without reading and
        writing: the least of `repeats` runs."""
        changes = kernel.changes(self.scene) | impact.changes()
        key = self.key(changes)
        if key in self.store.rows:
            return self.store.rows[key]
        folder = self.folder / self.kernel_key(kernel)
        command = [programs.BIN / "ricochet-contact", self.scene.path, "--quiet", "--out", folder,
                   *programs.with_set(self.scene.settings), *words(changes | {"title": "impact"})]
        best, duration = None, self.scene.table["time"]["duration"]
        for _ in range(self.repeats):
            done = timed(command)
            if done.status != 0:
                return self.store.add({"key": key} | refusal(done))
            summary = json.loads((folder / "impact.summary.json").read_text())
            if best is None or summary["real_time_factor"] > best["real_time_factor"]:
                best = summary
        (folder / "impact.result.h5").unlink(missing_ok=True)
        return self.store.add({"key": key, "impact_s": duration / best["real_time_factor"], "vectors": sum(best["modes"].values()),
                               "candidates": best["candidates"], "impact_mib": done.peak_mib,
                               "exit_velocity": best["exit_velocity"], "impulse_ns": best["impulse_ns"],
                               "peak_force_n": best["peak_force_n"], "ended": best["contact_end_s"] is not None})


@dataclass
class Done:
    """A program that has ended: wall time [s], its own peak memory [MiB], status and what it said."""

    seconds: float
    peak_mib: float
    status: int
    text: str


def timed(command):
    environment = os.environ | programs.ONE_THREAD
    with tempfile.TemporaryFile("w+") as said:
        started = time.monotonic()
        process = subprocess.Popen([str(word) for word in command], env=environment, stdout=said, stderr=said)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.monotonic() - started
        process.returncode = os.waitstatus_to_exitcode(status)  # or Popen would wait for it once more
        said.seek(0)
        return Done(seconds, usage.ru_maxrss / 1024, process.returncode, said.read())


def refusal(done):
    """A setting that the programs refuse (status 2) is a row that says so; anything else ends the study."""
    last = ([line for line in done.text.splitlines() if line.startswith("ricochet-")] or ["no word"])[-1]
    if done.status != 2:
        print(last, file=sys.stderr)
        raise programs.Failed(done.status)
    return {"refused": last}


def study(scene, options):
    """Pairs (Kernel, [Impact]) to run: vectors × R × step × scheme in full; order, tolerance, spacing and precision
    beside the base setting of each basis, or in full too."""
    vectors = [("modes", count, residual) for count in options.counts for residual in options.residual]
    vectors += [("contact", error, True) for error in options.fitted if scene.band]
    order, tolerance, spacing, band = scene.order, options.tolerances[0], scene.spacing, scene.band
    orders = options.orders if scene.order is not None else [None]
    spacings = [factor * scene.spacing for factor in options.spacings] if scene.spacing else [None]
    core = [Kernel(*vector, order, tolerance, spacing, band) for vector in vectors]
    every = [Kernel(*vector, *rest, band) for vector in vectors
             for rest in itertools.product(orders, options.tolerances, spacings)]
    beside = [("modes", max(options.counts), True)] + [vector for vector in vectors if vector[0] == "contact"][:1]
    star = [Kernel(*vector, o, tolerance, spacing, band) for vector in beside for o in orders]
    star += [Kernel(*beside[0], order, t, spacing, band) for t in options.tolerances]
    star += [Kernel(*vector, order, tolerance, s, band) for vector in beside for s in spacings]
    kernels = list(dict.fromkeys(every if options.full else core + star))
    impacts = [Impact(scheme, scene.rate_hz * factor, precision) for scheme in options.schemes for factor in options.rates
               for precision in (options.precisions if scheme == "compliant" else ["double"])]
    return [(kernel, impacts) for kernel in kernels]
