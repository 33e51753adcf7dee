# SPDX-License-Identifier: BSD-2-Clause
"""Builds the programs to be timed, and runs bench_modes under mpirun on a body of a scene."""
import json
import sys
import tempfile
from pathlib import Path

from ricochet import errors, programs, timing


def build(*targets):
    """Rebuilds programs whose source has changed. scripts/build must have run once."""
    programs.find(["cmake"])
    measured(["cmake", "--build", programs.BIN.parent, "--target", *targets])


def measured(command, folder=None, variables=programs.ONE_THREAD):
    """Runs a program as `ricochet.timing.timed` does. Prints its output and raises SolverError if it fails."""
    done = timing.timed(command, folder, variables)
    if done.status != 0:
        print(done.text, file=sys.stderr)
        raise errors.SolverError(f"{command[0]}: ended with status {done.status}")
    return done


def modes_words(count, tolerance=None):
    """The table [modes] for a number of modes, with a bound on their residuals."""
    return f"{{count={count}" + (f",relative_residual={tolerance}" if tolerance else "") + "}"


class Case:
    """A body of a scene, meshed with elements of a given order and size (None: as in the scene)."""

    def __init__(self, scene, body, order=None, size=None, settings=()):
        self.scene, self.body, self.order, self.size, self.settings = scene, body, order, size, list(settings)

    def words(self, modes):
        """The arguments SCENE BODY --set … for this [modes]. Settings of the user come last, so they take
        precedence."""
        own = [f"modes={modes}"]
        own += [f"bodies.{self.body}.order={self.order}"] if self.order else []
        own += [f"bodies.{self.body}.geometry.size={self.size}"] if self.size else []
        return [self.scene, self.body, *programs.with_set(own + self.settings)]


def text(command):
    return " ".join(str(word) for word in command)


def search(solver, case, modes, ranks, upto_hz=None, frequencies=False):
    """Runs bench_modes once. Returns the data that it prints and, if `frequencies` is set, the elastic
    frequencies."""
    with tempfile.TemporaryDirectory(prefix="ricochet-bench-") as folder:
        file = Path(folder) / "frequencies"
        command = [*programs.mpirun(ranks), programs.BIN / "bench_modes", solver, *case.words(modes)]
        command += ["--upto-hz", f"{upto_hz:.6f}"] if upto_hz else []
        command += ["--frequencies", file] if frequencies else []
        run = json.loads(programs.call(command, capture=True).strip().splitlines()[-1])
        if frequencies:
            run["frequency_hz"] = [float(line) for line in file.read_text().split()]
    return run | {"command": text(command)}
