# SPDX-License-Identifier: BSD-2-Clause
"""The film of a run as a binary glTF file."""
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.files import write, writing
from ricochet.films import arrows as arrow_shapes
from ricochet.films.arrows import Arrow, arrows_of, directions, turns_to
from ricochet.films.bodies import FilmBody, continuous
from ricochet.films.colours import Colours
from ricochet.films.document import Document, xyzw
from ricochet.films.fields import QUANTITIES, colour_field
from ricochet.interchange.rotations import quaternion_of
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.moving_surfaces import amplification, moving_surfaces
from ricochet.pictures.obstacles import shown_obstacles
from ricochet.pictures.planes import normals_of, upward
from ricochet.pictures.style import GREY, NORMAL, colour_of, prefixed
from ricochet.pictures.viewpoint import clearest
from ricochet.result_file import expected

MOMENTS = 1200  # maximum number of snapshots, evenly spaced
LASTS = 10.0  # longest film, unless the factor is given [s]
TARGETS = 16  # morph targets of a body
ARROW = 0.4  # length of the longest arrow, relative to the diagonal of the box around the bodies
CLEAR = 0.6  # opacity of bodies in which arrows are
GLASS = 0.3  # opacity of obstacles, so that bodies and arrows are seen from below
POOR = 0.05  # error of shapes or colours, relative to the largest value, of which a warning reports


@dataclass
class Choice:
    """What a film shows.

    magnify: factor on the displacement by elastic modes; none: 1 if that is visible, otherwise a round number.
    colour: a key of QUANTITIES; none: the colours of the bodies.
    slow: seconds of the film for each second of the run; none: a round number with which it lasts up to 10 s.
    targets: morph targets of a body. With a colour, one half of them are fields of the colour.
    opacity: of the bodies, from 0 to 1; none: 1, or 0.6 if two bodies touch, because arrows are then inside of them.
    """

    magnify: float | None = None
    colour: str | None = None
    slow: float | None = None
    targets: int = TARGETS
    opacity: float | None = None


@dataclass
class Film:
    """The content of a file, and lines that state what it shows and how accurately."""

    content: bytes = b""
    lines: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def state(self, name: str, text: str) -> None:
        self.lines.append(f"{name:<20}{text}")

    def judge(self, what: str, of: str, relative: float) -> None:
        if relative > POOR:
            self.warnings.append(
                f"{what} of {of} miss up to {100 * relative:.2g} % of the largest value: give more --targets"
            )


def write_film(path: Path, out: Path | None, kernels: Path | None, choice: Choice) -> tuple[Path, Film]:
    """Writes the film of the result file `path`, by default as <slug>.glb beside it, and returns its path. Raises InputError,
    one line, if the result has no snapshots or lacks what the colours need.

    @param kernels  folder of the kernels (default: that of the result)
    """
    with expected(path):
        result = LoadedResult(path)
        film = film_of(result, kernels or path.parent, choice)
        out = out or path.parent / f"{result.slug}.glb"
    with writing(out, "FILE.glb"):
        write(out, film.content)
    return out, film


def film_of(result: LoadedResult, kernels: Path, choice: Choice) -> Film:
    """The film of a result. Raises InputError, as `write_film`."""
    found = moving_surfaces(result, kernels)
    if isinstance(found, str):
        raise InputError(f"{result.path}: {found}: a film shows snapshots of surfaces")
    surfaces, all_times = found
    chosen = np.arange(0, len(all_times), -(-len(all_times) // MOMENTS))
    time = all_times[chosen]
    slow = choice.slow or slowness(float(time[-1] - time[0]))
    magnify = choice.magnify
    if magnify is None:
        during = chosen[result.during(time)]
        magnify = amplification(max(surface.largest_strain(during) for surface in surfaces.values()))
    tints = choice.targets // 2 if choice.colour else 0
    scenes = result.scene.get("bodies", {})
    bodies = {
        name: FilmBody(
            surface, chosen, 1 / len(surfaces), scenes.get(name, {}), magnify, choice.targets - tints
        )
        for name, surface in surfaces.items()
    }
    colours = colours_of(result, kernels, bodies, time, choice.colour, tints) if choice.colour else None
    arrows, left_out = arrows_of(result, time, bodies)
    opacity = choice.opacity or (CLEAR if any(arrow.inside for arrow in arrows) else 1.0)
    film = Film()
    film.state("film", timing(time, slow, len(all_times)))
    box = box_around(bodies)
    document = Document(result.title, (time - time[0]) * slow, quaternion_of(base_of(result, bodies, arrows)))
    add_obstacles(document, result, chosen, box)
    film.state("deformation", f"{magnify:g} times as large" if magnify != 1 else "true to scale")
    for name, body in bodies.items():
        material = document.material(name, "#ffffff" if colours else colour_of(result, name), opacity)
        add_body(document, film, name, body, material, colours)
    newton_per_metre = add_arrows(document, arrows, ARROW * float(np.linalg.norm(box[1] - box[0])))
    film.state("arrows", arrows_line(arrows, left_out, newton_per_metre))
    film.content = document.file(
        {
            "title": result.title,
            "run": result.run,
            "seconds_per_second": slow,
            "start_s": float(time[0]),
            "magnification": magnify,
            "error_m": {name: body.shapes.error for name, body in bodies.items()},
            "newton_per_metre": newton_per_metre,
            "colour": colours and colours.extras(),
        }
    )
    return film


def colours_of(
    result: LoadedResult, kernels: Path, bodies: dict[str, FilmBody], time: Array, what: str, most: int
) -> Colours:
    """The colours of the bodies by a field, a key of QUANTITIES, each with at most `most` fields."""
    fields = {name: colour_field(what, result, kernels, name, body, time) for name, body in bodies.items()}
    return Colours(QUANTITIES[what], fields, most)


def slowness(duration: float) -> float:
    """The largest of 1, 2, 5, 10, … times as slow with which a run [s] makes a film of up to 10 s."""
    most = LASTS / duration if duration > 0 else 1.0
    ten = 10.0 ** np.floor(np.log10(most))
    return max(1.0, float(max(factor for factor in (1, 2, 5) if factor <= most / ten * (1 + 1e-9)) * ten))


def timing(time: Array, slow: float, snapshots: int) -> str:
    if snapshots == 1:
        return "one snapshot, without motion"
    some = f"{len(time)} of {snapshots}" if len(time) < snapshots else f"{snapshots}"
    how = "as fast as the run" if slow == 1 else f"{slow:g} times as slow as the run"
    return f"{(time[-1] - time[0]) * slow:.3g} s, {how}, {some} snapshots"


def box_around(bodies: dict[str, FilmBody]) -> tuple[Array, Array]:
    """The corners of a box around the bodies over the whole film, without their deformation [m]."""
    low, high = [], []
    for body in bodies.values():
        if body.surface.poses:
            corners = body.surface.reach()
            low.append(corners[0])
            high.append(corners[1])
            continue
        place = body.place @ body.surface.rotation.T
        low.append(place.min(axis=0) + body.translation.min(axis=0))
        high.append(place.max(axis=0) + body.translation.max(axis=0))
    return np.min(low, axis=0), np.max(high, axis=0)


def base_of(result: LoadedResult, bodies: dict[str, FilmBody], arrows: list[Arrow]) -> Array:
    """(3,3) rotation from the axes of the world to right, up and towards the viewer, which are x, y and z of glTF."""
    start = [
        (body.place @ body.surface.placement(int(body.chosen[0]))[0].T + body.translation[0], body.element)
        for body in bodies.values()
    ]
    touched = np.array([arrow.place[0] for arrow in arrows]).reshape(-1, 3)
    normals = list(normals_of(result.scene).values())
    return clearest(start, touched, tilted=True, up=upward(result.scene), normals=normals).base


def add_body(
    document: Document, film: Film, name: str, body: FilmBody, material: int, colours: Colours | None
) -> None:
    """Adds a body: its mesh, its node and their motion."""
    shapes = body.shapes
    tint = colours.tints[name] if colours else None
    mesh = document.mesh(
        name,
        body.place,
        body.element,
        material,
        tint.start if tint else None,
        shapes.fields,
        tint.fields if tint else None,
    )
    weights = np.concatenate([shapes.amplitudes] + ([tint.basis.amplitudes] if tint else []), axis=1)
    document.weigh(mesh, weights[0], len(shapes.fields))
    node = document.node(name, mesh, translation=body.translation[0], rotation=xyzw(body.rotation[0]))
    document.animate(node, "translation", body.translation)
    document.animate(node, "rotation", xyzw(body.rotation))
    document.animate(node, "weights", weights)
    size, unit = prefixed(shapes.error, "m")
    film.state(
        f"  {name}"[:19],
        f"shapes: {len(shapes.fields)}, which miss at most {100 * shapes.relative:.2g} % of the largest displacement "
        f"({shapes.error * size:.3g} {unit} as drawn)",
    )
    film.judge("the shapes", name, shapes.relative)
    if colours and tint:
        factor, unit = prefixed(colours.top, colours.quantity.unit)
        film.state(
            "",
            f"fields of colour: {len(tint.fields)}, which miss at most {100 * tint.basis.relative:.2g} %: {colours.quantity.name}, "
            f"0 to {colours.top * factor:.3g} {unit}",
        )
        film.judge("the colours", name, tint.basis.relative)


def add_obstacles(
    document: Document, result: LoadedResult, chosen: NDArray[np.int64], box: tuple[Array, Array]
) -> None:
    """Adds the part of each half-space that is near the bodies, and the other obstacles, at the snapshots `chosen`. Of shapes,
    the side that bodies touch is seen."""
    for name, obstacle in shown_obstacles(result.file, result.scene, *box).items():
        middle = np.zeros(3) if obstacle.poses else obstacle.node.mean(axis=0)
        glass = document.material(name, GREY, GLASS, both=obstacle.normal is not None)
        mesh = document.mesh(name, obstacle.node - middle, obstacle.element, glass)
        if obstacle.poses is None:
            document.node(name, mesh, translation=middle)
            continue
        position, attitude = obstacle.poses.position[chosen], continuous(obstacle.poses.attitude[chosen])
        node = document.node(name, mesh, translation=position[0], rotation=xyzw(attitude[0]))
        document.animate(node, "translation", position)
        document.animate(node, "rotation", xyzw(attitude))


def add_arrows(document: Document, arrows: list[Arrow], longest: float) -> float | None:
    """Adds an arrow for each contact point. Returns the force of an arrow that is 1 m long [N]; None without arrows.

    @param longest  length of the longest arrow [m]
    """
    largest = max((float(np.linalg.norm(arrow.force, axis=1).max()) for arrow in arrows), default=0.0)
    if not largest:
        return None
    place, element = arrow_shapes.mesh()
    mesh = document.mesh("force", place, element, document.material("force", NORMAL))
    for arrow in arrows:
        size = np.linalg.norm(arrow.force, axis=1) * longest / largest
        turn = xyzw(turns_to(directions(arrow.force)))
        at_start = size[:1] if arrow.keys[0] == 0 else np.zeros(1)
        scale = np.repeat(size[:, None], 3, axis=1)
        node = document.node(
            arrow.name, mesh, translation=arrow.place[0], rotation=turn[0], scale=np.repeat(at_start, 3)
        )
        document.animate(node, "translation", arrow.place, arrow.keys)
        document.animate(node, "rotation", turn, arrow.keys)
        document.animate(node, "scale", scale, arrow.keys)
    return largest / longest


def arrows_line(arrows: list[Arrow], left_out: float, newton_per_metre: float | None) -> str:
    if newton_per_metre is None:
        return "none, as no snapshot has a contact force"
    rest = f"; points without one have {100 * left_out:.2g} % of the impulse" if left_out > 1e-3 else ""
    return f"{len(arrows)}, of contact forces: 1 m for {newton_per_metre:.4g} N{rest}"
