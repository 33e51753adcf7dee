# SPDX-License-Identifier: BSD-2-Clause
"""A folder with two rods, and functions that run programs in it with limited resources, for the tests in robust.py."""

import atexit
import functools
import os
import pathlib
import resource
import shutil
import subprocess
import tempfile
import time


import scenes
from errors import ROD, SCENE
from programs import BIN, ProgramTest, Run, kernel


LONG = scenes.rod(elements=400)


@functools.cache
def kernels_of_scene():
    """A folder with the kernels of the scene, computed once."""
    scope = tempfile.TemporaryDirectory(prefix="ricochet-test-")
    atexit.register(scope.cleanup)
    folder = pathlib.Path(scope.name)
    (folder / "rod.geo").write_text(ROD)
    (folder / "scene.toml").write_text(SCENE)
    run = kernel(folder / "scene.toml", folder / "out")
    assert run.status == 0, run.err
    return folder / "out"


class Robust(ProgramTest):
    def kernels(self):
        """The kernels of the scene, in `out`."""
        shutil.copytree(kernels_of_scene(), self.out, dirs_exist_ok=True)

    def setUp(self):
        super().setUp()
        self.write("rod.geo", ROD)
        self.write("long.geo", LONG)
        self.scene = self.write("scene.toml", SCENE)
        self.out = self.folder / "out"

    def start(self, *command):
        process = subprocess.Popen(
            [str(word) for word in command],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            env=os.environ | {"RICOCHET_BIN": str(BIN)},
        )
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def until(self, found):
        limit = time.monotonic() + 120
        while not (value := found()):
            self.assertLess(time.monotonic(), limit, "what was waited for does not come")
            time.sleep(0.005)
        return value

    def left(self):
        return sorted(path.name for path in self.out.rglob("*.partial"))

    def limited(self, kind, limit, *command):
        """Runs the command with a resource limit."""
        return Run(command, preexec_fn=lambda: resource.setrlimit(kind, (limit, limit)))
