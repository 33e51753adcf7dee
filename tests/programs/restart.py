# SPDX-License-Identifier: BSD-2-Clause
"""A killed ricochet-kernel continues from its finished slices on any number of ranks and gives the same kernel."""

import os
import signal
import subprocess
import time
import unittest
from pathlib import Path

import h5py
import numpy as np

import scenes
from programs import BIN, DEADLOCK_S, ProgramTest, displacement_kernel, kernel

# So many slices that a kill after two of them comes before the last one, however late this process is scheduled.
SCENE = scenes.block_on_floor(
    "Restart", "count = 600", "direction = [0, 0, -1]\nspacing = 0.4", "duration = 1.0"
)


def kill_ranks(out):
    """Sends SIGKILL to every rank of the run that writes to `out`, also to those that mpirun has only just forked."""
    for process in Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes()
        except OSError:
            continue
        if str(out).encode() in words and b"ricochet-kernel" in words:
            os.kill(int(process.name), signal.SIGKILL)


class Restart(ProgramTest):
    def slices(self, out):
        return len(list(out.glob("*.slices/slice-*.h5")))

    def killed_at(self, slices, out, ranks):
        """Starts a run and kills it when this number of slices is finished."""
        start = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks)]
        command = [*start, BIN / "ricochet-kernel", self.scene, "--out", out, "--quiet"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        limit = time.monotonic() + DEADLOCK_S
        while self.slices(out) < slices and process.poll() is None and time.monotonic() < limit:
            time.sleep(0.002)
        # mpirun first: it could start a rank after the others have been killed, which would finish the kernel.
        process.kill()
        process.wait()
        kill_ranks(out)

    def test_after_kills_and_a_slice_that_was_damaged(self):
        self.write("block.geo", scenes.skewed_block(0.25))
        self.scene = self.write("restart.toml", SCENE)
        whole, broken = self.folder / "whole", self.folder / "broken"
        self.succeed(kernel(self.scene, whole))
        self.assertEqual(self.slices(whole), 0)  # slices are removed once the kernel exists

        for slices, ranks in ((0, 1), (1, 2), (2, 1)):
            self.killed_at(slices, broken, ranks)
        finished = sorted(broken.glob("*.slices/slice-*.h5"))
        self.assertGreaterEqual(len(finished), 2)
        self.assertEqual(list(broken.glob("*.kernel.h5")), [])
        damaged = finished[0]
        damaged.write_bytes(damaged.read_bytes()[: damaged.stat().st_size // 2])
        run = self.succeed(kernel(self.scene, broken, ranks=3, quiet=False))
        self.assertRegex(run.err, f"{len(finished) - 1} of [0-9]+ ")  # the damaged one is computed again
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


if __name__ == "__main__":
    unittest.main()
