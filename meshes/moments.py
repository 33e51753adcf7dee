#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Draws moments of bodies that turn, from a result with snapshots and kernels with views:

    meshes/moments.py meshes/tumble/out/tumble.result.h5 tumble.png
    meshes/moments.py meshes/dominoes/out/dominoes.result.h5 dominoes.png --apart 6

A body is drawn at moments near the floor that follow each other after equal motions, from blue to green. With --apart, bodies in
colours of their own are drawn at moments side by side."""
import argparse
from pathlib import Path

import h5py
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

COUNT = 24  # moments in one picture
HIGHEST = 0.06  # m: moments higher above the floor are not drawn in it
TILT = np.radians(16)  # from above


class Body:
    """Nodes (K,V,3) of a surface at the times of the snapshots, in the world, and its triangles (E,3)."""

    def __init__(self, file, folder, name):
        position, attitude = (file[f"pose/{name}/{part}"][:][:, None] for part in ("position", "attitude"))
        with h5py.File(folder / file[f"bodies/{name}"].attrs["kernel"].decode()) as kernel:
            node, self.element = kernel["view/node"][:] - kernel["body/centre"][:], kernel["view/element"][:]
        w, axis = attitude[..., :1], attitude[..., 1:]
        across = np.cross(axis, node)
        self.place = position + node + 2 * (w * across + np.cross(axis, across))


def draw(axes, screen, triangles, hue):
    """Draws triangles (E,3,3) in colours (E,3), those at the back first."""
    towards, light = np.cross(*screen), np.array([0.4, -0.5, 0.77])
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    front = np.flatnonzero(normal @ towards > 0)
    front = front[np.argsort(triangles[front].mean(axis=1) @ towards)]
    colour = hue[front] * np.clip(0.7 + 0.3 * normal[front] @ light, 0, 1)[:, None]
    axes.add_collection(
        PolyCollection(triangles[front] @ screen.T, facecolors=colour, edgecolors=colour, linewidths=0.3)
    )


def floor(axes, screen, place):
    low, high = (f(place.reshape(-1, 3), axis=0) for f in (np.min, np.max))
    corners = zip((low[0], high[0], high[0], low[0]), (low[1], low[1], high[1], high[1]))
    axes.add_collection(
        PolyCollection([np.array([[*c, 0] for c in corners]) @ screen.T], facecolor="#dddbd3")
    )


def one_picture(axes, body):
    """Returns the numbers of the moments."""
    screen = np.array([[0, 1, 0], [-np.sin(TILT), 0, np.cos(TILT)]])  # from +x; right is y
    near = body.place[:, :, 2].min(axis=1) < HIGHEST
    moved = np.linalg.norm(np.diff(body.place, axis=0), axis=2).mean(axis=1) * near[1:]
    path = np.concatenate([[0], np.cumsum(moved)])
    drawn = np.unique(np.searchsorted(path, np.linspace(0, path[-1], COUNT + 1)[1:]))
    floor(axes, screen, body.place[drawn])
    for number, k in enumerate(drawn):
        triangles = body.place[k][body.element]
        hue = np.tile(plt.cm.viridis(0.9 * number / len(drawn))[:3], (len(triangles), 1))
        draw(axes, screen, triangles, hue)
    return drawn


def side_by_side(axes, bodies, time):
    """Returns the numbers of the moments."""
    screen = np.array([[1, 0, 0], [0, np.sin(TILT), np.cos(TILT)]])  # from −y; right is x
    drawn = np.linspace(0, len(time) - 1, axes.size).astype(int)
    everything = np.concatenate([body.place[drawn].reshape(-1, 3) for body in bodies])
    for panel, k in zip(axes.flat, drawn):
        floor(panel, screen, everything)
        triangles = [body.place[k][body.element] for body in bodies]
        hue = [np.tile(plt.cm.tab10(number)[:3], (len(t), 1)) for number, t in enumerate(triangles)]
        draw(panel, screen, np.concatenate(triangles), np.concatenate(hue))
        panel.set_title(f"{1e3 * time[k]:.0f} ms", fontsize=10)
        panel.update_datalim(everything @ screen.T)  # the same limits for all
    return drawn


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("result", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--apart", type=int, metavar="N", help="draw N moments side by side")
    options = parser.parse_args()
    with h5py.File(options.result) as file:
        bodies = [Body(file, options.result.parent, name) for name in file["pose"]]
        time = file["snapshots/time"][:]
    if options.apart:
        figure, axes = plt.subplots(-(-options.apart // 3), 3, figsize=(10, 1.7 * -(-options.apart // 3)))
        drawn = side_by_side(axes, bodies, time)
    else:
        figure, axes = plt.subplots(figsize=(10, 3.6))
        drawn = one_picture(axes, *bodies)
    for panel in figure.axes:
        panel.set_aspect("equal")
        panel.autoscale_view()
        panel.set_axis_off()
    figure.savefig(options.picture, dpi=110, bbox_inches="tight")
    print(f"{len(drawn)} moments from {time[drawn[0]]:.3f} to {time[drawn[-1]]:.3f} s")


if __name__ == "__main__":
    main()
