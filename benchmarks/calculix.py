# SPDX-License-Identifier: BSD-2-Clause
"""CalculiX on the same mesh: `ccx` runs on input that bench_modes writes, each kept in a cache."""
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks import launch
from ricochet import errors, programs

RIGID_BELOW_HZ = 1.0  # as in bench_modes: CalculiX finds rigid modes at the square root of round-off


def installed():
    if shutil.which("ccx"):
        return True
    print(
        "bench modes: no ccx here, CalculiX is left out: scripts/setup --peers installs it",
        file=sys.stderr,
    )
    return False


def frequencies_of(path):
    """Frequencies [Hz] in a .dat file of CalculiX, ascending; rigid modes as 0."""
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
    """Wall and processor time [s], peak memory [MiB] and frequencies of `ccx -i body` in a folder."""
    environment = os.environ | {"OMP_NUM_THREADS": str(threads), "OPENBLAS_NUM_THREADS": str(threads)}
    environment |= {"OPENBLAS_CORETYPE": coretype} if coretype else {}
    with open(folder / "log", "w") as log:
        started = time.monotonic()
        process = subprocess.Popen(["ccx", "-i", "body"], cwd=folder, env=environment, stdout=log, stderr=log)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.monotonic() - started
    process.returncode = os.waitstatus_to_exitcode(status)
    found = frequencies_of(folder / "body.dat")
    if process.returncode != 0 or not found:
        print("ccx:", (folder / "log").read_text()[-2000:], file=sys.stderr)
        raise errors.ProgramError(1)
    return {
        "seconds": seconds,
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "peak_mib": usage.ru_maxrss / 1024,
        "frequency_hz": found,
    }


class Cache:
    """Runs of CalculiX in a JSON file: a run that was measured once on this machine is not repeated."""

    def __init__(self, path=None):
        self.path = path
        self.entries = json.loads(path.read_text()) if path and path.exists() else []
        model = [
            line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")
        ]
        self.machine = f"{len(model)} x {model[0].split(':')[1].strip()}" if model else "unknown"

    def entry(self, key):
        key = key | {"machine": self.machine}
        for entry in self.entries:
            if all(entry[name] == value for name, value in key.items()):
                return entry
        self.entries.append(key | {"runs": []})
        return self.entries[-1]

    def save(self):
        if self.path:
            partial = self.path.with_name(self.path.name + ".partial")
            partial.write_text(json.dumps(self.entries, indent=1) + "\n")
            partial.rename(self.path)


def run(case, count, threads, rounds, cache):
    """`rounds` runs of CalculiX for the `count` lowest modes; like those of `search`, but from reading the
    input to the last output. The input decides whether a cached run serves."""
    with tempfile.TemporaryDirectory(prefix="ricochet-ccx-") as folder:
        folder = Path(folder)
        write = [
            programs.BIN / "bench_modes",
            "calculix-input",
            *case.words(f"{{count={count}}}"),
            folder / "body.inp",
        ]
        answer = json.loads(programs.call(write, capture=True).strip().splitlines()[-1])
        deck = hashlib.sha256((folder / "body.inp").read_bytes()).hexdigest()
        entry = cache.entry({"input_sha256": deck, "threads": threads})
        entry["command"] = f"{launch.text(write)} && OMP_NUM_THREADS={threads} ccx -i body"
        while len(entry["runs"]) < rounds:
            entry["runs"].append(run_ccx(folder, threads, answer["openblas_coretype"]))
            cache.save()
    elastic = [f for f in entry["runs"][0]["frequency_hz"] if f > RIGID_BELOW_HZ]
    return [
        timed
        | {
            "solver": "calculix",
            "unknowns": answer["unknowns"],
            "elastic": len(elastic),
            "frequency_hz": elastic,
            "command": entry["command"],
        }
        for timed in entry["runs"][:rounds]
    ]
