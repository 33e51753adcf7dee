#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Draws the moments of a tumble in one picture, from a result with snapshots and a kernel with a view:

    meshes/tumble/moments.py out/tumble.result.h5 moments.png

Moments near the floor follow each other after equal motions, from blue to green."""
import argparse
from pathlib import Path

import h5py
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

COUNT = 24  # moments
HIGHEST = 0.06  # m: moments higher above the floor are not drawn


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("result", type=Path)
parser.add_argument("picture", type=Path)
options = parser.parse_args()
with h5py.File(options.result) as file:
    (name,) = file["pose"]
    position, attitude = (file[f"pose/{name}/{part}"][:][:, None] for part in ("position", "attitude"))
    time, kernel = file["snapshots/time"][:], file[f"bodies/{name}"].attrs["kernel"].decode()
with h5py.File(options.result.parent / kernel) as file:
    node, element = file["view/node"][:] - file["body/centre"][:], file["view/element"][:]

# Seen from +x and a little from above; right is y.
tilt = np.radians(16)
screen = np.array([[0, 1, 0], [-np.sin(tilt), 0, np.cos(tilt)]])
towards, light = np.array([np.cos(tilt), 0, np.sin(tilt)]), np.array([0.4, -0.5, 0.77])

w, axis = attitude[..., :1], attitude[..., 1:]
across = np.cross(axis, node)
place = position + node + 2 * (w * across + np.cross(axis, across))
near = place[:, :, 2].min(axis=1) < HIGHEST
moved = np.linalg.norm(np.diff(place, axis=0), axis=2).mean(axis=1) * near[1:]
path = np.concatenate([[0], np.cumsum(moved)])
drawn = np.unique(np.searchsorted(path, np.linspace(0, path[-1], COUNT + 1)[1:]))

figure, axes = plt.subplots(figsize=(10, 3.6))
low, high = (f(place[drawn].reshape(-1, 3), axis=0) for f in (np.min, np.max))
floor = np.array(
    [[x, y, 0] for x, y in zip((low[0], high[0], high[0], low[0]), (low[1], low[1], high[1], high[1]))]
)
axes.add_collection(PolyCollection([floor @ screen.T], facecolor="#dddbd3"))
for number, k in enumerate(drawn):
    triangles = place[k][element]
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    front = np.flatnonzero(normal @ towards > 0)
    front = front[np.argsort(triangles[front].mean(axis=1) @ towards)]
    hue = np.array(plt.cm.viridis(0.9 * number / len(drawn))[:3])
    colour = hue * np.clip(0.7 + 0.3 * normal[front] @ light, 0, 1)[:, None]
    axes.add_collection(
        PolyCollection(triangles[front] @ screen.T, facecolors=colour, edgecolors=colour, linewidths=0.3)
    )
axes.set_aspect("equal")
axes.autoscale_view()
axes.set_axis_off()
figure.savefig(options.picture, dpi=110, bbox_inches="tight")
print(f"{len(drawn)} moments from {time[drawn[0]]:.3f} to {time[drawn[-1]]:.3f} s")
