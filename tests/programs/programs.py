# SPDX-License-Identifier: BSD-2-Clause
"""Runs the two programs as a user does, for the tests in this folder and in tests/verification."""

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
# A program that runs longer counts as a deadlock.
DEADLOCK_S = 240


class Run:
    """The result of a program: `status`, `out`, `err`."""

    def __init__(self, command):
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=DEADLOCK_S)
        self.status, self.out, self.err = done.returncode, done.stdout, done.stderr


def settings(sets):
    return [argument for setting in sets for argument in ("--set", setting)]


def kernel(scene, out, *sets, ranks=1, quiet=True):
    """Runs ricochet-kernel. One rank runs without mpirun, whose start takes longer than most bodies here."""
    start = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", ranks] if ranks > 1 else []
    return Run(start + [BIN / "ricochet-kernel", scene, "--out", out] + ["--quiet"] * quiet + settings(sets))


def contact(scene, out, *sets, quiet=True):
    return Run([BIN / "ricochet-contact", scene, "--out", out] + ["--quiet"] * quiet + settings(sets))


def displacement_kernel(path, times):
    """N_ij(t) (t, i, j) of a kernel file with one component: Σ_n φ_in φ_jn sin(ω_n t)/ω_n over its modes."""
    with h5py.File(path) as file:
        omega, shape = file["modes/angular_frequency"][:], file["surface/shape"][:]
    shape = shape.reshape(-1, shape.shape[-1])
    sine = np.array(
        [np.where(omega > 0, np.sin(omega * t) / np.where(omega > 0, omega, 1), t) for t in times]
    )
    return np.einsum("in,tn,jn->tij", shape, sine, shape)


def static_responses(path):
    """Static response of the receivers of a kernel file to loads, gravity and moving supports, by name: modes and residuals
    together. Also returns sums over modes that do not depend on the choice of vectors within multiple modes.
    """
    with h5py.File(path) as file:
        omega, gravity = file["modes/angular_frequency"][:], file["loads/body_force"][:]
        compliance = np.where(omega > 0, 1 / np.where(omega > 0, omega, 1) ** 2, 0)
        names = {kind: [name.decode() for name in file[f"names/{kind}"][:]] for kind in file["names"]}
        motions = {name: file[f"motions/{name}/participation"][:] for name in names.get("motions", ())}
        found = {}
        for receiver in names["receivers"]:
            shape, data = file[f"receivers/{receiver}"][:], file[f"receiver_data/{receiver}"]
            found[receiver, "gravity"] = (shape * compliance) @ gravity.T + data["body_force_residual"][:]
            for number, name in enumerate(names["loads"]):
                part = file[f"loads/{name}"][:]
                found[receiver, name] = (shape * compliance) @ part.T + data["load_residual"][:, number]
            for number, (name, part) in enumerate(motions.items()):
                found[receiver, "moved " + name] = shape @ part.T + data["motion_residual"][:, number]
        for name in names["loads"]:
            found[name, "total"], found[name, "moment"] = (
                file[f"load_data/{name}/{of}"][:] for of in ("total", "moment")
            )
        for name, part in motions.items():
            found[name, "with gravity"] = gravity @ part.T + file[f"motions/{name}/momentum"][:]
    return found


class ProgramTest(unittest.TestCase):
    """A test with its own folder, `self.folder`, which is removed afterwards."""

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
