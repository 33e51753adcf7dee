# SPDX-License-Identifier: BSD-2-Clause
"""The scene `meshes/two-disks` unchanged: elements of 5 mm and all modes up to 1500 Hz, certified. The case also checks whether position 9
opens with the schemes of the paper's algorithm."""
from cases import disks

TITLE = "The paper's Figures 7 and 8 with all modes"
SOURCE = disks.SOURCE
RESTS_ON = "published"
LONG = True


def run(bench):
    disks.run(bench, [], ranks=2, laws=("jump", "difference"))
