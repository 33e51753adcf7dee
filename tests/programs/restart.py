# SPDX-License-Identifier: BSD-2-Clause
"""A killed ricochet-kernel continues from its finished slices on any number of ranks and gives the same kernel."""

import os
import pathlib
import random
import signal
import subprocess
import time
import unittest

import h5py
import numpy as np

import scenes
from programs import BIN, ProgramTest, displacement_kernel, kernel, settings

SCENE = scenes.block_on_floor(
    "Restart", "count = 800", "direction = [0, 0, -1]\nspacing = 0.4", "duration = 1.0"
)


def kill_all(out):
    """Sends SIGKILL to mpirun and to every rank of the run that writes to `out`."""
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes()
        except OSError:
            continue
        if str(out).encode() in words and b"ricochet-kernel" in words:
            os.kill(int(process.name), signal.SIGKILL)


class Restart(ProgramTest):
    def run_for(self, seconds, out, ranks):
        """Starts a run and kills it. Returns whether it had ended before."""
        command = [
            "mpirun",
            "--allow-run-as-root",
            "--oversubscribe",
            "-n",
            ranks,
            BIN / "ricochet-kernel",
            self.scene,
            "--out",
            out,
            "--quiet",
        ]
        process = subprocess.Popen(
            [str(c) for c in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        try:
            process.wait(timeout=seconds)
            return True
        except subprocess.TimeoutExpired:
            kill_all(out)
            process.wait()
            return False

    def slices(self, out):
        return len(list(out.glob("*.slices/slice-*.h5")))

    def test_after_kills_at_random_moments(self):
        self.write("block.geo", scenes.skewed_block(0.16))
        self.scene = self.write("restart.toml", SCENE)
        whole, broken = self.folder / "whole", self.folder / "broken"
        started = time.monotonic()
        self.succeed(kernel(self.scene, whole, ranks=1))
        length = time.monotonic() - started
        self.assertEqual(self.slices(whole), 0)  # slices are removed once the kernel exists

        choice = random.Random(7)
        for attempt in range(4):
            self.run_for(choice.uniform(0.2, 0.7) * length, broken, ranks=1 + attempt % 2)
        # Ensures at least one finished slice; otherwise the test would check nothing.
        self.run_for(60, broken, ranks=2) if self.slices(broken) == 0 else None
        left = self.slices(broken)
        if not list(broken.glob("*.kernel.h5")):
            self.assertGreater(left, 0)
            run = self.succeed(kernel(self.scene, broken, ranks=3, quiet=False))
            self.assertIn(f"{left} of ", run.err)
        self.assertEqual(self.slices(broken), 0)
        (one,), (other,) = whole.glob("*.kernel.h5"), broken.glob("*.kernel.h5")
        times = np.linspace(0, 5, 40)
        exact, got = displacement_kernel(one, times), displacement_kernel(other, times)
        self.assertLess(np.abs(got - exact).max(), 1e-8 * np.abs(exact).max())
        with h5py.File(one) as a, h5py.File(other) as b:
            self.assertEqual(
                a["modes/certificate"].attrs["count_by_inertia"],
                b["modes/certificate"].attrs["count_by_inertia"],
            )

    def test_a_slice_that_was_damaged_is_computed_again(self):
        self.write("block.geo", scenes.skewed_block(0.16))
        self.scene = self.write("restart.toml", SCENE)
        out = self.folder / "out"
        sets = ["modes.count=300"]
        started = time.monotonic()
        self.succeed(kernel(self.scene, self.folder / "first", *sets, ranks=1))
        length = time.monotonic() - started
        command = [BIN / "ricochet-kernel", self.scene, "--out", out, "--quiet", *settings(sets)]
        for part in (0.9, 0.8, 0.7, 0.6):
            process = subprocess.Popen(
                [str(c) for c in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
            time.sleep(part * length)
            process.kill()
            process.wait()
            if self.slices(out):
                break
            for path in out.glob("*.kernel.h5"):
                path.unlink()
        for path in out.glob("*.slices/*.h5"):
            data = path.read_bytes()
            path.write_bytes(data[: len(data) // 2])
        self.succeed(kernel(self.scene, out, *sets, ranks=2))
        self.assertEqual(len(list(out.glob("*.kernel.h5"))), 1)


if __name__ == "__main__":
    unittest.main()
