# SPDX-License-Identifier: BSD-2-Clause
"""Threads of Python that share a simulation, under ThreadSanitizer. shared_counter.cpp uses Turns as a Simulation does, and is
compiled with the sanitizer; Python itself is not, but its locks are seen. Without the lock of either side, it reports a race;
without the check of Change, no thread is refused."""

import os
import subprocess
import sys
import sysconfig
import tempfile
import threading
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COMPILER, BUSY = "clang++-16", "another thread is stepping this Simulation"


def share(folder):
    """Steps, changes and reads a counter in two threads each, for a second."""
    sys.path.insert(0, folder)
    from shared_counter import SharedCounter  # made by the test

    counter, refused, settled = SharedCounter(), [], []
    end = time.monotonic() + 1

    def work(change, read):
        while time.monotonic() < end:
            try:
                change()
            except RuntimeError as error:
                refused.append(str(error))
            settled.append(read())

    def step():
        counter.step_block(200)

    threads = [
        threading.Thread(target=work, args=(change, counter.is_settled))
        for change in (step, counter.clear) * 2
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(refused) == {BUSY} and len(settled) > 10 and all(settled), (set(refused), len(settled))


class Threads(unittest.TestCase):
    def test_that_share_a_simulation_are_refused_and_never_race(self):
        runtime = subprocess.check_output(
            [COMPILER, "-print-file-name=libclang_rt.tsan-x86_64.so"], text=True
        ).strip()
        with tempfile.TemporaryDirectory() as folder:
            module, source = Path(folder, "shared_counter.so"), ROOT / "tests/python/shared_counter.cpp"
            flags = [
                "-std=c++20",
                "-O1",
                "-g",
                "-fsanitize=thread",
                "-fPIC",
                "-shared",
                "-fvisibility=hidden",
            ]
            include = ["-I", ROOT, "-I", sysconfig.get_path("include")]
            subprocess.run([COMPILER, *flags, *include, source, "-o", module], check=True)
            run = subprocess.run(
                [sys.executable, __file__, "--share", folder],
                env={**os.environ, "LD_PRELOAD": runtime, "TSAN_OPTIONS": "exitcode=66 halt_on_error=1"},
                capture_output=True,
                text=True,
                timeout=120,
            )
        self.assertEqual(run.returncode, 0, run.stderr)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--share"]:
        share(sys.argv[2])
    else:
        unittest.main()
