"""What the benchmarks time: bench_modes under mpirun, and CalculiX on the same mesh."""
import hashlib
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from ricochet import programs

RIGID_BELOW_HZ = 1.0  # as in bench_modes: rigid modes come out of CalculiX with the square root of round-off


def build(*targets):
    """Programs as they are in the source now. Needs scripts/build to have run once."""
    if not programs.BIN.is_dir():
        print(f"{programs.BIN}: no programs there. Run scripts/build first.", file=sys.stderr)
        raise programs.ProgramError(2)
    done = subprocess.run(["cmake", "--build", programs.BIN.parent, "--target", *targets], stdout=subprocess.PIPE,
                          text=True)
    if done.returncode != 0:
        print(done.stdout, file=sys.stderr)
        raise programs.ProgramError(done.returncode)


class Case:
    """A body of a scene, meshed with elements of an order and a size (None: the scene's own)."""

    def __init__(self, scene, body, order=None, size=None, settings=()):
        self.scene, self.body, self.order, self.size, self.settings = scene, body, order, size, list(settings)

    def words(self, modes):
        """SCENE BODY --set …, with this [modes]; what the user sets comes last and wins."""
        own = [f"modes={modes}"]
        own += [f"bodies.{self.body}.order={self.order}"] if self.order else []
        own += [f"bodies.{self.body}.geometry.size={self.size}"] if self.size else []
        return [self.scene, self.body, *programs.with_set(own + self.settings)]


def text(command):
    return " ".join(str(word) for word in command)


def search(solver, case, modes, ranks, upto_hz=None, frequencies=False):
    """One run of bench_modes: what it prints, and the elastic frequencies where they are wanted."""
    with tempfile.TemporaryDirectory(prefix="ricochet-bench-") as folder:
        file = Path(folder) / "frequencies"
        command = programs.mpirun(ranks) + [programs.BIN / "bench_modes", solver, *case.words(modes)]
        command += ["--upto-hz", f"{upto_hz:.6f}"] if upto_hz else []
        command += ["--frequencies", file] if frequencies else []
        run = json.loads(programs.call(command, capture=True).strip().splitlines()[-1])
        if frequencies:
            run["frequency_hz"] = [float(line) for line in file.read_text().split()]
    return run | {"command": text(command)}


# ---- CalculiX ----


def has_calculix(program):
    if shutil.which("ccx"):
        return True
    print(f"{program}: no ccx here, CalculiX is left out: scripts/setup --peers installs Debian's calculix-ccx",
          file=sys.stderr)
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
        raise programs.ProgramError(1)
    return {"seconds": seconds, "cpu_seconds": usage.ru_utime + usage.ru_stime, "peak_mib": usage.ru_maxrss / 1024,
            "frequency_hz": found}


class Cache:
    """Runs of CalculiX in a JSON file: what was measured once on this machine is not run again."""

    def __init__(self, path=None):
        self.path = path
        self.entries = json.loads(path.read_text()) if path and path.exists() else []
        model = [line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
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


def calculix(case, count, threads, rounds, cache):
    """`rounds` runs of CalculiX for the `count` lowest modes; like those of `search`, but from reading the
    input to the last output. The input decides whether a cached run is the same."""
    with tempfile.TemporaryDirectory(prefix="ricochet-ccx-") as folder:
        folder = Path(folder)
        write = [programs.BIN / "bench_modes", "calculix-input", *case.words(f"{{count={count}}}"), folder / "body.inp"]
        told = json.loads(programs.call(write, capture=True).strip().splitlines()[-1])
        deck = hashlib.sha256((folder / "body.inp").read_bytes()).hexdigest()
        entry = cache.entry({"input_sha256": deck, "threads": threads})
        entry["command"] = f"{text(write)} && OMP_NUM_THREADS={threads} ccx -i body"
        while len(entry["runs"]) < rounds:
            entry["runs"].append(run_ccx(folder, threads, told["openblas_coretype"]))
            cache.save()
    elastic = [f for f in entry["runs"][0]["frequency_hz"] if f > RIGID_BELOW_HZ]
    return [run | {"solver": "calculix", "unknowns": told["unknowns"], "elastic": len(elastic),
                   "frequency_hz": elastic, "command": entry["command"]} for run in entry["runs"][:rounds]]


# ---- Tables ----


def median(runs, key="seconds"):
    return statistics.median(run[key] for run in runs)


def table_head(cells):
    print("| " + " | ".join(cells) + " |\n" + "|---" * len(cells) + "|", flush=True)


def table_row(cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)
