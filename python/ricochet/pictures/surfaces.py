# SPDX-License-Identifier: BSD-2-Clause
"""A picture of the surfaces of a drawing from above and from below, with their numbers where those have room."""
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from ricochet.arrays import Array, Floats
from ricochet.drawing import Drawing
from ricochet.files import save_picture
from ricochet.pictures.colouring import borders, map_colours
from ricochet.pictures.viewpoint import View, nearest, spread

CELLS = 700  # along the longer side of a view
ROOM = (4, 6)  # half of the width of a digit and of its height, in cells
PALETTE = ("#2b6cb0", "#d2691e", "#3a8f5c", "#8a4fa3", "#8c6d1f", "#b03a48")  # those of bodies on pages
TOP, UP = np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0])


def seen(drawing: Drawing, view: View) -> tuple[Array, Floats]:
    """What each cell of a picture shows: the index of a surface, or -1, and its depth in cells, towards the eye. (h,w)
    each, from below."""
    turned = drawing.node @ view.turn().T
    used = np.concatenate([one.element.ravel() for one in drawing.surfaces])
    low, high = turned[used].min(axis=0), turned[used].max(axis=0)
    cell = max(float((high - low)[:2].max()), 1e-300) / CELLS
    turned = (turned - low) / cell + [2, 2, 0]  # a margin
    wide, tall = (np.ceil((high - low)[:2] / cell) + 5).astype(int)
    depth, shown = np.full(tall * wide, -np.inf), np.full(tall * wide, -1)
    for k, one in enumerate(drawing.surfaces):
        points = spread(turned, one.element, 0.5)
        place = points[:, 1].astype(int) * wide + points[:, 0].astype(int)
        own = nearest(place, points[:, 2], tall * wide)
        before = own > depth
        depth[before], shown[before] = own[before], k
    return shown.reshape(tall, wide), depth.reshape(tall, wide)


def same(shown: Array, x: int, y: int) -> Array:
    """Whether the cells at the distance (x, y) on both sides show the same."""
    ahead, behind = (np.roll(shown, way, (0, 1)) for way in ((y, x), (-y, -x)))
    both: Array = (shown == ahead) & (shown == behind)
    return both


def places(shown: Array, letters: list[int]) -> dict[int, tuple[int, int]]:
    """Where the numbers of surfaces have room, in cells (x, y): within the largest part of a surface that all cells of a
    number have around them. `letters`: their digits."""
    found = {}
    inner = shown.copy()
    for _ in range(ROOM[1]):  # no cell nearer to the border than half the height of a digit
        whole = same(inner, 1, 0) & same(inner, 0, 1) & same(inner, 1, 1) & same(inner, 1, -1)
        inner = np.where(whole, inner, -1)
    for k in np.unique(inner[inner >= 0]):
        mask = inner == k
        for aside in range(ROOM[0], ROOM[0] * letters[k] + 1, ROOM[0]):
            mask = mask & (np.roll(shown, aside, 1) == k) & (np.roll(shown, -aside, 1) == k)
        y, x = np.nonzero(mask)
        if len(x):
            nearest = np.argmin((x - np.median(x)) ** 2 + (y - np.median(y)) ** 2)
            found[int(k)] = int(x[nearest]), int(y[nearest])
    return found


def paint(ax: Axes, drawing: Drawing, colours: list[int], view: View) -> None:
    """Draws a view: pale colours, lighter where they face the eye, and dark borders."""
    shown, depth = seen(drawing, view)
    there = shown >= 0
    slope = np.hypot(*np.gradient(np.where(there, depth, 0)))
    pale = 0.5 + 0.5 * np.array([to_rgb(PALETTE[colour % len(PALETTE)]) for colour in colours])
    image = np.ones((*shown.shape, 3))
    light = 0.65 + 0.35 / np.hypot(1, slope)
    image[there] = pale[shown[there]] * light[there, None]
    image[~(same(shown, 1, 0) & same(shown, 0, 1))] *= 0.35
    ax.imshow(image, origin="lower", interpolation="antialiased")
    ax.set_axis_off()
    numbers = [str(one.number) for one in drawing.surfaces]
    for k, (x, y) in places(shown, [len(number) for number in numbers]).items():
        ax.text(x, y, numbers[k], ha="center", va="center_baseline", fontsize=8)


def save_surfaces(drawing: Drawing, path: Path, title: str) -> None:
    """Writes the picture. Raises OSError."""
    colours = map_colours([borders(one.element) for one in drawing.surfaces])
    figure = Figure(figsize=(12, 6))
    for k, (name, elevation) in enumerate((("above", 0.6), ("below", -0.6))):
        ax = figure.add_subplot(1, 2, k + 1)
        paint(ax, drawing, colours, View(TOP, UP, 0.6, elevation))
        ax.set_title(f"{title} from {name}", loc="left", fontsize=10)
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=0.94, wspace=0.02)
    save_picture(figure, path, dpi=100)
