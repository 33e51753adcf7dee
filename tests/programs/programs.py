# SPDX-License-Identifier: BSD-2-Clause
"""The harness of all tests in Python: impacts through the package, and the programs and the command where these are tested."""

import atexit
import contextlib
import functools
import gc
import io
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import unittest
import warnings

import h5py
import numpy as np

import ricochet
from ricochet import cli, programs
from ricochet.programs import changes

BIN = pathlib.Path(os.environ["RICOCHET_BIN"])
SOURCE = pathlib.Path(__file__).resolve().parents[2]
MESHES = SOURCE / "meshes"
# A program that runs longer counts as a deadlock.
DEADLOCK_S = 240


class Run:
    """A program that has ended: `status`, `out`, `err`. `more` are words of subprocess.run."""

    def __init__(self, command, **more):
        streams = {
            "stdout": subprocess.PIPE,
            "stderr": subprocess.PIPE,
            "text": True,
            "errors": "surrogateescape",
        }
        words = by_server(command)
        done = subprocess.run(words, **{"timeout": DEADLOCK_S} | streams | more)
        self.status, self.out, self.err = done.returncode, done.stdout, done.stderr


class Command(Run):
    """The command `ricochet` with these words, in this process: a start of Python takes longer than most of its work."""

    def __init__(self, *words):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
            warnings.simplefilter("ignore", ResourceWarning)  # as outside tests
            try:
                self.status = cli.main([os.fsdecode(w) if isinstance(w, bytes) else str(w) for w in words])
            except SystemExit as end:
                self.status = end.code
            gc.collect()  # closes files
        self.out, self.err = out.getvalue(), err.getvalue()


class Forked(Run):
    """The command `ricochet` with these words in a fork of this process, for verbs that become another program. `folder` is where it
    works."""

    def __init__(self, *words, folder="."):
        kernel_server()  # for all forks
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            self.number = os.fork()
            if self.number == 0:
                self.become(map(str, words), folder, out, err)
            self.status = os.waitstatus_to_exitcode(os.waitpid(self.number, 0)[1])
            self.out, self.err = (stream.seek(0) or stream.read().decode() for stream in (out, err))

    def become(self, words, folder, out, err):
        status = 1
        try:
            os.dup2(out.fileno(), 1), os.dup2(err.fileno(), 2)
            sys.stdout, sys.stderr = (open(number, "w", closefd=False) for number in (1, 2))
            os.chdir(folder)
            status = cli.main([*words])
        except SystemExit as end:
            status = end.code
        finally:
            with contextlib.suppress(OSError):
                sys.stdout.flush(), sys.stderr.flush()
            os._exit(status or 0)


@contextlib.contextmanager
def limited(kind, limit):
    """A resource of this process and of those that it starts has this limit."""
    before = resource.getrlimit(kind)
    resource.setrlimit(kind, (limit, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(kind, before)


def start_server(program, socket):
    """Lets a process that has linked the libraries of a program run it for all who ask at this socket, until this process ends."""
    before = os.environ.get("LD_PRELOAD", "")
    variables = {
        "LD_PRELOAD": f"{os.environ['RICOCHET_FORK_SERVER']} {before}",
        "RICOCHET_FORK_PRELOAD": before,
        "RICOCHET_FORK_SOCKET": socket,
    }
    server = subprocess.Popen(
        [program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=os.environ | variables
    )

    def end():
        server.stdin.close(), server.stdout.close()
        server.wait()

    atexit.register(end)
    return server


@functools.cache
def kernel_server():
    """What stands before ricochet-kernel in a command, so that a server which has linked its libraries runs it (fork_server.c), and
    another one the mesher that it starts. ctest names the server; without it, the programs are started."""
    if "RICOCHET_FORK_SERVER" not in os.environ:
        return []
    folder = tempfile.TemporaryDirectory(prefix="ricochet-server-", ignore_cleanup_errors=True)
    atexit.register(folder.cleanup)
    sockets = {"RICOCHET_FORK_SOCKET": f"{folder.name}/kernel", "RICOCHET_FORK_MESH": f"{folder.name}/mesh"}
    os.environ.update(sockets)
    start_server(BIN.parent / "libexec/ricochet/ricochet-mesh", sockets["RICOCHET_FORK_MESH"])
    kernel = start_server(BIN / "ricochet-kernel", sockets["RICOCHET_FORK_SOCKET"])
    kernel.stdout.readline()  # it can be asked now; until the other one can, the mesher is started
    return [os.environ["RICOCHET_FORK_CLIENT"]]


def by_server(words):
    """The words of a command, by which the server runs ricochet-kernel, alone or as each rank of mpirun."""
    words = [*map(str, words)]
    if (program := str(BIN / "ricochet-kernel")) in words:
        at = words.index(program)
        if at == 0 or words[0] == "mpirun":
            mpirun = [] if "1" in words[at - 2 : at] else words[:at]
            return mpirun + kernel_server() + words[at:]
    return words


start_program, replace_process = programs.start, programs.replace_this_process
programs.start = lambda command, *more, **options: start_program(by_server(command), *more, **options)
programs.replace_this_process = lambda command: replace_process(by_server(command))


def scene_of(file, *sets):
    """The scene of a file with some keys set, each as KEY=VALUE."""
    return ricochet.Scene(file).changed(changes(sets))


def impact(scene, out, *sets, ranks=1):
    """The result of a scene or its file with some keys set, through the package. Missing kernels are computed."""
    scene = scene if isinstance(scene, ricochet.Scene) else scene_of(scene, *sets)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the result has them too
        ricochet.kernels(scene, ranks, out)
        return ricochet.impact(scene, out)


def settings(sets):
    return [argument for setting in sets for argument in ("--set", setting)]


def kernel(scene, out, *sets, ranks=1, quiet=True, more=()):
    """Runs ricochet-kernel, with `more` options. One rank runs without mpirun, whose start takes longer than most bodies here."""
    start = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", ranks] if ranks > 1 else []
    words = [scene, "--out", out, *more] + ["--quiet"] * quiet + settings(sets)
    return Run(start + [BIN / "ricochet-kernel"] + words)


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
    """Static response of the receivers and gauges of a kernel file to loads, gravity and moving supports, by name: modes and
    residuals together. Also returns sums over modes that do not depend on the choice of vectors within multiple modes.
    """
    with h5py.File(path) as file:
        omega, gravity = file["modes/angular_frequency"][:], file["loads/body_force"][:]
        compliance = np.where(omega > 0, 1 / np.where(omega > 0, omega, 1) ** 2, 0)
        names = {kind: [name.decode() for name in file[f"names/{kind}"][:]] for kind in file["names"]}
        motions = {name: file[f"motions/{name}/participation"][:] for name in names.get("motions", ())}
        found = {}
        seen = [(r, file[f"receivers/{r}"][:], file[f"receiver_data/{r}"]) for r in names["receivers"]]
        for gauge in names.get("gauges", ()):
            parts = (
                (f"{gauge} {part}", data) for part, data in file[f"gauges/{gauge}"].items() if part != "point"
            )
            seen += [(name, data["shape"][:], data) for name, data in parts]
        for receiver, shape, data in seen:
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
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="ricochet-test-")))

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    @classmethod
    def shared_folder(cls):
        """A folder for all tests of the class."""
        return pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="ricochet-test-")))

    def succeed(self, run):
        self.assertEqual(run.status, 0, run.err)
        return run

    def refused(self, run, *parts, status=2):
        """Checks for one line on stderr that contains each part, and the status."""
        # mpirun adds its own remark on the status after a line of dashes.
        lines = [line for line in (run.err or "").split("-----")[0].splitlines() if line.strip()]
        self.assertEqual((run.status, len(lines)), (status, 1), run.err)
        for part in parts:
            self.assertIn(part, lines[0])

    def one(self, out, pattern="*.kernel.h5"):
        """The only file of the folder with such a name."""
        (path,) = pathlib.Path(out).glob(pattern)
        return path

    def summary(self, out):
        return json.loads(self.one(out, "*.summary.json").read_text())
