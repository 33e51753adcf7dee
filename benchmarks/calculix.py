# SPDX-License-Identifier: BSD-2-Clause
"""Runs CalculiX (`ccx`) on the same mesh, with input written by bench_modes. Finished runs can be cached."""
import hashlib
import json
import re
import shutil
import sys
import tempfile
from pathlib import Path

from benchmarks import launch
from ricochet import files, programs
from ricochet.errors import SolverError

RIGID_BELOW_HZ = 1.0  # as in bench_modes: due to round-off, CalculiX finds rigid modes slightly above 0


def installed():
    if shutil.which("ccx"):
        return True
    print(
        "bench modes: no ccx here, CalculiX is left out: scripts/setup --peers installs it", file=sys.stderr
    )
    return False


def frequencies_of(path):
    """Frequencies [Hz] in a .dat file of CalculiX, ascending. Rigid modes are included."""
    lines = path.read_text().splitlines() if path.is_file() else []
    found = []
    for line in lines:
        if "P A R T I C I P A T I O N" in line:
            break
        cells = line.split()
        if len(cells) == 5 and cells[0].isdigit():
            found.append(float(cells[3]))
    return sorted(found)


def run_ccx(folder, threads, coretype):
    """Runs `ccx -i body` in a folder. Returns wall and processor time [s], peak memory [MiB] and
    frequencies."""
    environment = {name: str(threads) for name in programs.ONE_THREAD}
    environment |= {"OPENBLAS_CORETYPE": coretype} if coretype else {}
    done = launch.measured(["ccx", "-i", "body"], folder, environment)
    found = frequencies_of(folder / "body.dat")
    if not found:
        raise SolverError(f"ccx: finds no modes: {done.text[-2000:]}")
    return {
        "seconds": done.seconds,
        "cpu_seconds": done.cpu_seconds,
        "peak_mib": done.peak_mib,
        "frequency_hz": found,
    }


class Cache:
    """Runs of CalculiX in a JSON file. A run that was measured on this machine is not repeated."""

    def __init__(self, path=None):
        self.path = path
        self.entries = json.loads(path.read_text()) if path and path.exists() else []
        models = re.findall(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
        self.machine = f"{len(models)} x {models[0].strip()}" if models else "unknown"

    def entry(self, key):
        key = key | {"machine": self.machine}
        for entry in self.entries:
            if all(entry[name] == value for name, value in key.items()):
                return entry
        self.entries.append(key | {"runs": []})
        return self.entries[-1]

    def save(self):
        if self.path:
            files.write(self.path, (json.dumps(self.entries, indent=1) + "\n").encode())


def run(case, count, threads, rounds, cache):
    """Returns `rounds` runs of CalculiX for the `count` lowest modes, in the form of those of `search`. Their
    time extends from reading the input to writing the last output. A cached run is used if its input is the
    same."""
    with tempfile.TemporaryDirectory(prefix="ricochet-ccx-") as folder:
        folder = Path(folder)
        words = case.words(launch.modes_words(count))
        write = [programs.BIN / "bench_modes", "calculix-input", *words, folder / "body.inp"]
        answer = json.loads(programs.call(write, capture=True).strip().splitlines()[-1])
        deck = hashlib.sha256((folder / "body.inp").read_bytes()).hexdigest()
        entry = cache.entry({"input_sha256": deck, "threads": threads})
        entry["command"] = f"{launch.text(write)} && OMP_NUM_THREADS={threads} ccx -i body"
        while len(entry["runs"]) < rounds:
            entry["runs"].append(run_ccx(folder, threads, answer["openblas_coretype"]))
            cache.save()
    elastic = [f for f in entry["runs"][0]["frequency_hz"] if f > RIGID_BELOW_HZ]
    found = {"solver": "calculix", "unknowns": answer["unknowns"], "command": entry["command"]}
    found |= {"elastic": len(elastic), "frequency_hz": elastic}
    return [timed | found for timed in entry["runs"][:rounds]]
