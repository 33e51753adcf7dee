# SPDX-License-Identifier: BSD-2-Clause
"""A folder with two rods, and functions that run programs in it with limited resources, for the tests in robust.py."""

import os
import resource
import subprocess
import time


import scenes
from errors import ROD, SCENE
from programs import BIN, ProgramTest, Run


LONG = scenes.rod(elements=400)


class Robust(ProgramTest):
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

    def refused(self, run, *fragments, status=2):
        self.assertEqual(run.status, status, run.err)
        lines = [line for line in run.err.split("-----")[0].splitlines() if line.strip()]
        self.assertEqual(len(lines), 1, run.err)
        for fragment in fragments:
            self.assertIn(fragment, lines[0])

    def limited(self, kind, limit, *command):
        """Runs the command with a resource limit."""
        done = subprocess.run(
            [str(word) for word in command],
            capture_output=True,
            text=True,
            timeout=240,
            preexec_fn=lambda: resource.setrlimit(kind, (limit, limit)),
        )
        run = Run(["true"])
        run.status, run.err = done.returncode, done.stderr
        return run
