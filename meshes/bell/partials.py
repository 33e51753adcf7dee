#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Names the partials of a bell by their shapes, from its kernel with a view: partials.py out/bell-*.kernel.h5

A partial goes as cos(m θ) around the bell. Its lip and its waist move outward together, or against each other.
"""
import argparse

import h5py
import numpy as np

NAMES = {
    (2, True): ("hum", 0.5),
    (2, False): ("prime", 1.0),
    (3, True): ("tierce", 1.2),
    (3, False): ("quint", 1.5),
    (4, True): ("nominal", 2.0),
}
WAVES = np.arange(7)


def around(angle, outward):
    """(2, len(WAVES), N): how much of each mode goes as cos(m θ) and as sin(m θ)."""
    waves = np.concatenate([np.cos(np.outer(angle, WAVES)), np.sin(np.outer(angle, WAVES))], axis=1)
    return np.linalg.lstsq(waves, outward, rcond=None)[0].reshape(2, len(WAVES), -1)


parser = argparse.ArgumentParser(description=__doc__, usage=argparse.SUPPRESS)
parser.add_argument("kernel", nargs="+", help="kernel of the bell; of several, the first one")
with h5py.File(parser.parse_args().kernel[0]) as file:
    hertz, decay = file["modes/angular_frequency"][:] / (2 * np.pi), file["modes/decay_rate"][:]
    (x, y, z), shape = file["view/node"][:].T, file["view/shape"][:]
angle, height = np.arctan2(y, x), z / z.max()
outward = np.cos(angle)[:, None] * shape[:, 0] + np.sin(angle)[:, None] * shape[:, 1]
lip, waist = (around(angle[at], outward[at]) for at in (height < 0.1, abs(height - 0.42) < 0.06))

found = {}
for n in range(len(hertz)):
    m = int(np.argmax((lip[:, :, n] ** 2).sum(axis=0)))
    swings = (outward[:, n] ** 2).sum() > 0.25 * (
        shape[:, :, n] ** 2
    ).sum()  # else it twists, or stretches along its height
    together = bool((lip[:, m, n] * waist[:, m, n]).sum() > 0)
    if swings and (m, together) in NAMES:
        found.setdefault((m, together), n)  # the lowest; its twin, turned by a quarter of a wave, follows
strike = hertz[found[4, True]] / 2
print("partial     Hz  ratio  textbook  cents  falls by 60 dB in")
for key, (name, ratio) in NAMES.items():
    n = found[key]
    print(
        f"{name:8} {hertz[n]:5.0f}  {hertz[n] / strike:5.3f}  {ratio:8.3f}  {1200 * np.log2(hertz[n] / strike / ratio):+5.0f}"
        f"  {np.log(1000) / decay[n]:4.1f} s"
    )
