# SPDX-License-Identifier: BSD-2-Clause
"""Contact and friction never add energy: a million steps of random bodies.

    scripts/verify --friction                # about 10 minutes
    scripts/verify --friction --steps 20000  # as in the tests

Steps over 12 decades, coefficients from 0 to 10, 1 to 200 points and 1 to 400 modes; conserving steps and backward
Euler, single steps and blocks. The status is 1 if energy was gained.
"""
import os
import subprocess

from ricochet import programs

PROGRAM, TEST = "test_contact_core", "Energy.is_never_added_by_contact_and_friction"


def add_arguments(parser):
    parser.add_argument("--steps", type=int, default=1_000_000, help="number of steps (default: a million)")


def run(options):
    build = programs.ROOT / "build"
    subprocess.run(["cmake", "--build", build, "--target", PROGRAM], check=True, stdout=subprocess.DEVNULL)
    return subprocess.run(
        [build / "bin" / PROGRAM, f"--gtest_filter={TEST}"],
        env=os.environ | {"RICOCHET_RANDOM_STEPS": str(options.steps)},
        check=False,
    ).returncode
