"""Runs the two programs as a user does, for the tests of this folder and of tests/verification."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

BIN = pathlib.Path(os.environ["RICOCHET_BIN"])
SOURCE = pathlib.Path(__file__).resolve().parents[2]
MESHES = SOURCE / "meshes"
# A program that has not ended by then is a deadlock.
DEADLOCK_S = 240


class Run:
    """What a program left behind: `status`, `out`, `err`."""

    def __init__(self, command):
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=DEADLOCK_S)
        self.status, self.out, self.err = done.returncode, done.stdout, done.stderr


def settings(sets):
    return [argument for setting in sets for argument in ("--set", setting)]


def kernel(scene, out, *sets, ranks=2, quiet=True):
    command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", ranks, BIN / "ricochet-kernel", scene, "--out", out]
    return Run(command + ["--quiet"] * quiet + settings(sets))


def contact(scene, out, *sets, quiet=True):
    return Run([BIN / "ricochet-contact", scene, "--out", out] + ["--quiet"] * quiet + settings(sets))


def displacement_kernel(path, times):
    """N_ij(t) (t, i, j) of a kernel file with one component, from its modes: Σ_n φ_in φ_jn sin(ω_n t)/ω_n."""
    with h5py.File(path) as file:
        omega, shape = file["modes/angular_frequency"][:], file["surface/shape"][:]
    shape = shape.reshape(-1, shape.shape[-1])
    sine = np.array([np.where(omega > 0, np.sin(omega * t) / np.where(omega > 0, omega, 1), t) for t in times])
    return np.einsum("in,tn,jn->tij", shape, sine, shape)


class ProgramTest(unittest.TestCase):
    """A test with a folder of its own, `self.folder`, gone afterwards."""

    def setUp(self):
        scope = tempfile.TemporaryDirectory(prefix="ricochet-test-")
        self.addCleanup(scope.cleanup)
        self.folder = pathlib.Path(scope.name)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def succeed(self, run):
        self.assertEqual(run.status, 0, run.err)
        return run

    def summary(self, out):
        (path,) = pathlib.Path(out).glob("*.summary.json")
        return json.loads(path.read_text())
