# SPDX-License-Identifier: BSD-2-Clause
"""The picture of a contact at several moments: the forces, and the bodies from the viewpoint with the best
view of the contact."""
import textwrap
from collections.abc import Iterable

import matplotlib
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.obstacles import ShownObstacle, shown_obstacles
from ricochet.pictures.planes import normals_of, upward
from ricochet.pictures.moving_surfaces import MovingSurface, amplification
from ricochet.pictures.style import WIDTH, colour_of, fit, largest_of, legend_below, normals, prefixed
from ricochet.pictures.viewpoint import clearest

MOMENTS = 9
FLOOR, GHOST = "#dedbd3", "#8a8a8a"
LIGHT = np.array([0.35, 0.5, 0.8]) / np.linalg.norm(
    [0.35, 0.5, 0.8]
)  # towards it, as right, up and towards the viewer
COLOURS = matplotlib.colormaps["viridis"]


def snapshots_picture(result: LoadedResult, surfaces: dict[str, MovingSurface], time: Array) -> Figure | None:
    """Draws the contact with the largest impulse; of bodies that turn and touch several times, the motion from the first
    touch to the last one. Returns None if there is no snapshot of it."""
    total = result.forces.per_row()
    impulse_of = [total[first:stop].sum() for first, stop in result.episodes]
    longest = int(np.argmax(impulse_of))
    half = result.spacing / 2
    turning = any(surface.poses for surface in surfaces.values())
    whole = turning and len(result.episodes) > 1
    if whole:
        start, end = result.spans()[0][0], result.spans()[-1][0]
        before, after = int(np.searchsorted(time, start)) - 1, int(np.searchsorted(time, end))
        during = np.arange(max(before, 0), min(after + 1, len(time)))
    else:
        start, end = result.spans()[longest]
        during = np.flatnonzero((time > start + half) & (time <= end + half))
    if len(during) == 0:
        return None
    spread = np.linspace(0, len(during) - 1, 60).astype(int)
    some = during[np.unique(spread)]
    strain = max(surface.strain(k) for surface in surfaces.values() for k in some)
    amplify = 1 if whole else amplification(strain)
    chosen = during[moments(drawn_path(surfaces, during, amplify), MOMENTS)]
    places = [{body: surface.at(k, amplify) for body, surface in surfaces.items()} for k in chosen]
    ghosts = [{body: surface.at(k, 0) for body, surface in surfaces.items()} for k in chosen]
    scene, planes = result.scene, normals_of(result.scene)
    solid = any(surface.element.shape[1] == 3 for surface in surfaces.values())
    first = {body: surface.at(during[0]) for body, surface in surfaces.items()}
    view = clearest(
        [(first[body], surface.element) for body, surface in surfaces.items()],
        touched(result, surfaces, during[0], result.episodes[longest]),
        tilted=bool(planes) and solid,  # otherwise the upper side of a floor is not seen
        up=upward(scene),
        normals=list(planes.values()),
    )
    turn = view.turn()

    def outline(body: str, cell: int) -> NDArray[np.int64]:
        return unhidden(surfaces[body], ghosts[cell][body] @ turn.T)

    outlines = {body: outline(body, 0) for body in surfaces}
    shown = [place for moment in places + ghosts * (amplify != 1) for place in moment.values()]
    everything = np.concatenate(shown) @ turn.T
    low, high = everything.min(axis=0)[:2], everything.max(axis=0)[:2]
    if high[1] - low[1] < 0.02 * (high[0] - low[0]):  # a rod is a line, so add space above and below it
        low[1], high[1] = low[1] - 0.1 * (high[0] - low[0]), high[1] + 0.1 * (high[0] - low[0])
    margin = 0.04 * (high - low).max()
    shape = (high[1] - low[1] + 2 * margin) / (high[0] - low[0] + 2 * margin)
    resting = np.concatenate(shown if turning else list(first.values()))
    box = resting.min(axis=0), resting.max(axis=0)
    if len(planes) > 1 and (up := upward(scene)) is not None:  # the walls of a box would cover what is in it
        planes = {name: normal for name, normal in planes.items() if normal @ up > 0.1} or planes
    obstacles = {
        name: obstacle
        for name, obstacle in shown_obstacles(result.file, scene, *box).items()
        if obstacle.normal is None or name in planes
    }

    # Bars are drawn beside tall pictures and below wide ones.
    beside, rows = shape > 1.3 and not whole, -(-len(chosen) // 3)
    width = WIDTH / 3 * (0.5 if beside else 1)
    height = width * min(shape, 2.2)
    figure = Figure(
        figsize=(WIDTH, rows * (height + (0.4 if beside or whole else 1.3)) + 1.0), layout="constrained"
    )
    if whole:
        grid = figure.add_gridspec(rows, 3)
    elif beside:
        grid = figure.add_gridspec(rows, 6, width_ratios=[1.1, 0.9] * 3)
    else:
        grid = figure.add_gridspec(2 * rows, 3, height_ratios=[height, 0.9] * rows)
    ms, time_unit = prefixed(end, "s")
    # Few moments of a motion fall into a touch.
    forces = (
        None
        if whole
        else Forces(result, [int(np.argmin(np.abs(result.contact_time - time[k]))) for k in chosen])
    )
    fields = [{body: surface.deformations(int(k)) for body, surface in surfaces.items()} for k in chosen]
    # Sharp dents, of fewer than one node in a hundred, would leave no colours to the rest.
    most = max(float(np.percentile(field, 99)) for at in fields for field in at.values())
    bodies = []
    for cell, k in enumerate(chosen):
        r, c = divmod(cell, 3)
        ax = figure.add_subplot(grid[r, c] if whole else grid[r, 2 * c] if beside else grid[2 * r, c])
        paint_obstacles(ax, obstacles.values(), int(k), turn)
        bodies.append(ax)
        paint(ax, result, surfaces, places[cell], turn, fields[cell], most)
        if amplify != 1:
            for body, edges in outlines.items():
                if surfaces[body].poses:
                    edges = outline(body, cell)
                flat = (ghosts[cell][body] @ turn.T)[:, :2]
                ax.add_collection(LineCollection(flat[edges], colors=GHOST, linewidths=0.7, zorder=3))
        fit(ax, low, high, margin)
        ax.set_title(f"{time[k] * ms:#.4g} {time_unit}")
        if cell == 0:
            scale_bar(ax, low[0], low[1] - margin / 2, high[0] - low[0])
        if forces:
            below = figure.add_subplot(grid[r, 2 * c + 1] if beside else grid[2 * r + 1, c])
            forces.draw(below, cell, labelled=(cell + 3 >= len(chosen), c == 0))
    handles: list[Rectangle | Line2D] = [
        Line2D([], [], color=colour_of(result, body), linewidth=2) for body in surfaces
    ]
    names = [f"edges of {body}" if solid else body for body in surfaces]
    if solid and most > 0:
        colour_bar(figure, bodies, most)
    if amplify != 1:
        handles.append(Line2D([], [], color=GHOST, linewidth=0.8))
        names.append("without deformation")
    if obstacles:
        handles.append(Rectangle((0, 0), 1, 1, color=FLOOR))
        names.append(", ".join(obstacles) if len(obstacles) <= 4 else "obstacles")
    legend_below(figure, handles, names)
    scale = "true to scale" if amplify == 1 else f"deformation drawn {amplify:,.0f} times as large"
    count = "one moment" if len(chosen) == 1 else f"{len(chosen)} moments"
    if result.low_pass and forces:
        scale += f"; forces: low-pass {result.low_pass:g} Hz"
    figure.suptitle(
        f"{result.title}: {count} of the {'motion' if whole else 'contact'}\n{scale}", fontsize=11
    )
    return figure


def drawn_path(surfaces: dict[str, MovingSurface], during: NDArray[np.int64], amplify: float) -> Array:
    """(S,r) coordinates of the snapshots `during`, in which the Euclidean distance of two snapshots is the root mean
    square distance of the nodes as drawn [m]. Bodies with poses deform in their own axes here, so that poses and
    deformation contribute one by one."""
    parts, nodes = [], sum(len(surface.node) for surface in surfaces.values())
    for surface in surfaces.values():
        weights = surface.weights(amplify)
        shape = surface.shape.reshape(-1, len(weights))
        # Converted to double precision in parts to save memory.
        pieces = [piece.astype(float) * weights for piece in np.array_split(shape, len(shape) // 10_000 + 1)]
        values, vectors = np.linalg.eigh(sum(piece.T @ piece for piece in pieces) / nodes)
        parts.append(surface.coordinates[during] @ (vectors * np.sqrt(np.maximum(values, 0))))
        if surface.poses:
            # x = [A, position] · [X − centre, 1] along each axis of the world
            arm = np.column_stack([surface.node - surface.poses.centre, np.ones(len(surface.node))])
            values, vectors = np.linalg.eigh(arm.T @ arm / nodes)
            turned = np.concatenate([surface.poses.rotation, surface.poses.position[:, :, None]], axis=2)
            moved = turned[during] @ (vectors * np.sqrt(np.maximum(values, 0)))
            parts.append(moved.reshape(len(during), -1))
    return np.concatenate(parts, axis=1)


def touched(
    result: LoadedResult, surfaces: dict[str, MovingSurface], k: int, episode: tuple[int, int]
) -> Array:
    """(·,3) where points touch [m]: with finite rotations, in an episode; otherwise in the run, at the poses of
    snapshot k."""
    if len(found := result.places_in(*episode)):
        return found
    points = result.point_a.copy()
    for i in np.flatnonzero(result.impulse() > 0):
        body = next((name for name in result.sides_names(i) if name in surfaces), None)
        if body:
            points[i] = surfaces[body].carried(points[i], k)
    return np.asarray(points[result.impulse() > 0])


def moments(path: Array, most: int) -> NDArray[np.int64]:
    """At most `most` rows of a path (S,r), from the first on. Each is the first row that is at least a distance d away
    from the one before, with the largest d that leaves enough rows."""

    def walk(distance: float) -> list[int]:
        found = [0]
        while len(found) < most:
            away = np.linalg.norm(path[found[-1] + 1 :] - path[found[-1]], axis=1)
            beyond = np.flatnonzero(away >= distance)
            if not len(beyond):
                break
            found.append(found[-1] + 1 + int(beyond[0]))
        return found

    near, far = 0.0, 2 * float(np.linalg.norm(path - path[0], axis=1).max())
    for _ in range(40):
        middle = (near + far) / 2
        near, far = (middle, far) if len(walk(middle)) == min(most, len(path)) else (near, middle)
    return np.array(walk(near))


def unhidden(surface: MovingSurface, seen: Array) -> NDArray[np.int64]:
    """(·,2) edges of the outline that no triangle of the body hides. `seen`: (V,3) nodes as right, up, towards the viewer."""
    edges = surface.rim(seen[:, :2])
    if surface.element.shape[1] == 2:
        return edges
    first, second, third = np.moveaxis(seen[surface.element], 1, 0)
    one, two = second - first, third - first
    double = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]  # twice the area
    flat = np.abs(double) < 1e-300
    least, near = 1e-6, 1e-3 * np.ptp(seen, axis=0).max()

    def hidden(point: Array) -> bool:
        way = point - first
        with np.errstate(divide="ignore", invalid="ignore"):
            s = (way[:, 0] * two[:, 1] - way[:, 1] * two[:, 0]) / double
            t = (one[:, 0] * way[:, 1] - one[:, 1] * way[:, 0]) / double
            inside = (s > least) & (t > least) & (s + t < 1 - least) & ~flat
            return bool(np.any(inside & (s * one[:, 2] + t * two[:, 2] > way[:, 2] + near)))

    return edges[[not hidden(point) for point in seen[edges].mean(axis=1)]]


def shaded(colour: Array, normal: Array) -> Array:
    """(n,3) colours of triangles with these unit normals (n,3)."""
    return colour * (0.62 + 0.38 * np.abs(normal @ LIGHT))[:, None]


def paint_obstacles(ax: Axes, obstacles: Iterable[ShownObstacle], k: int, turn: Array) -> None:
    """Paints obstacles at snapshot k behind the bodies, from back to front. Of shapes, the side that bodies touch is seen."""
    corners, faces = [], []
    for obstacle in obstacles:
        corner = (obstacle.at(k) @ turn.T)[obstacle.element]
        normal = normals(corner)
        face = np.tile(to_rgb(FLOOR), (len(corner), 1))
        if obstacle.normal is None:
            front = normal[:, 2] > 0
            corner, face = corner[front], shaded(face[front], normal[front])
        corners.append(corner)
        faces.append(face)
    if corners:
        corner, face = np.concatenate(corners), np.concatenate(faces)
        order = np.argsort(corner[:, :, 2].mean(axis=1), kind="stable")
        ax.add_collection(
            PolyCollection(
                list(corner[order, :, :2]),
                facecolors=face[order],
                edgecolors=face[order],
                linewidths=0.3,
                zorder=0,
            )
        )


def paint(
    ax: Axes,
    result: LoadedResult,
    surfaces: dict[str, MovingSurface],
    places: dict[str, Array],
    turn: Array,
    fields: dict[str, Array],
    most: float,
) -> None:
    """Paints triangles and outlines from back to front: triangles by a field of the nodes from 0 to `most`, outlines in the
    colour of the body."""
    patches, depth, face, edge, width = [], [], [], [], []
    # Where flat bodies overlap slightly, the later one is in front. Outlines are in front of their surfaces.
    near = 0.02 * np.ptp(np.concatenate(list(places.values())), axis=0).max()
    for number, (body, surface) in enumerate(surfaces.items()):
        seen: Array = places[body] @ turn.T
        colour: Array = np.array(to_rgb(colour_of(result, body)))
        outline = surface.rim(seen[:, :2])
        line = surface.element.shape[1] == 2
        if not line:
            corner = seen[surface.element]
            share = fields[body][surface.element].mean(axis=1) / (most or 1)
            colours = shaded(COLOURS(share)[:, :3], normals(corner))
            patches += list(corner[:, :, :2])
            depth += list(corner[:, :, 2].mean(axis=1) + number * near)
            face += list(colours)
            edge += list(colours)
            width += [0.3] * len(corner)
        patches += list(seen[outline][:, :, :2])
        depth += list(seen[outline][:, :, 2].mean(axis=1) + (len(surfaces) + 1) * near)
        face += [colour] * len(outline)
        edge += [colour] * len(outline)
        width += [4 if line else 1.0] * len(outline)
    order = np.argsort(depth, kind="stable")
    patches, face, edge, width = ([values[k] for k in order] for values in (patches, face, edge, width))
    ax.add_collection(PolyCollection(patches, facecolors=face, edgecolors=edge, linewidths=width))


def colour_bar(figure: Figure, axes: list[Axes], most: float) -> None:
    """The scale of deformations from 0 to `most` [m], above the bodies."""
    factor, unit = prefixed(most, "m")
    colours = ScalarMappable(Normalize(0, most * factor), COLOURS)
    figure.colorbar(
        colours, ax=axes, location="top", shrink=0.4, aspect=40, extend="max", label=f"deformation ({unit})"
    )


def scale_bar(ax: Axes, left: float, bottom: float, wide: float) -> None:
    length = 10.0 ** np.floor(np.log10(0.5 * wide))
    m, unit = prefixed(length, "m")
    ax.plot([left, left + length], [bottom, bottom], color="black", linewidth=2)
    ax.text(left + length, bottom, f"  {length * m:g} {unit}", va="center", fontsize=8)


class Forces:
    """Panels of force by point. The horizontal axis is the number of the point if the points lie on a line in
    this order. Otherwise it is the position along the contact or the distance from the first touch."""

    def __init__(self, result: LoadedResult, rows: list[int]) -> None:
        order, where, what = result.positions()
        self.force = result.forces.of_rows(np.array(rows), np.arange(len(order)))
        self.scale, self.unit = prefixed(largest_of(self.force), "N")
        self.top = 1.08 * largest_of(self.force) * self.scale or 1
        numbers = np.arange(1, len(order) + 1)
        self.numbered = len(order) == 1 or (
            what.startswith("position") and np.all(np.abs(np.diff(order)) == 1)
        )
        if self.numbered:
            self.where, self.label = numbers, "number of the contact position"
            return
        self.force = self.force[:, order]
        far = 1.6 * np.abs(where[result.impulse()[order] > 0]).max() or np.abs(where).max()
        shown = np.abs(where) <= far  # points farther away are open
        factor, unit = prefixed(far, "m")
        self.force, self.where, self.label = self.force[:, shown], where[shown] * factor, f"{what} ({unit})"

    def draw(self, ax: Axes, row: int, labelled: tuple[bool, bool]) -> None:
        force = self.force[row] * self.scale
        if self.numbered:
            ax.bar(self.where, force, width=0.8 if len(force) < 60 else 1, color="#b03a48")
            ax.set_xlim(0.4, len(force) + 0.6)
            if len(force) <= 3:
                ax.set_xticks(self.where)
            else:
                ax.xaxis.get_major_locator().set_params(integer=True)
        else:
            ax.vlines(self.where, 0, force, color="#b03a48", linewidth=2)
            ax.plot(self.where, force, ".", color="#b03a48", markersize=4)
        ax.set_ylim(0, self.top)
        ax.grid(axis="x", visible=False)
        if labelled[0]:
            ax.set_xlabel(textwrap.fill(self.label, 18))  # a panel is not wider
        if labelled[1]:
            ax.set_ylabel(f"force ({self.unit})")
        else:
            ax.set_yticklabels([])
