# SPDX-License-Identifier: BSD-2-Clause
"""The surfaces of a drawing or mesh in gmsh: triangles for pictures, and measures of the drawing itself, which no mesh rounds off."""
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ricochet.arrays import Array, Floats

try:
    import gmsh
except ImportError:
    gmsh = None

INSTALLED = gmsh is not None
AROUND = 24  # triangles around a full circle: a picture needs no more
SMALLEST = 1 / 400  # of the size of the drawing, so that small fillets get few triangles
SURE = 1e-6  # relative error of extents, far below the four digits that are shown
SEWN = (".step", ".stp", ".brep", ".iges", ".igs")
TOLERANCES = (1e-9, 1e-7, 1e-6, 1e-5)  # of the drawing, by which its faces are joined
WAYS = np.concatenate([np.eye(3), -np.eye(3)])  # towards both ends of each axis
# These end on their curves: along each of their straight lines, no coordinate has an inner maximum.
RULED = ("Plane", "Cylinder", "Cone", "Plane surface")


@dataclass
class Surface:
    """A surface. Lengths are in the units of the file."""

    number: int
    groups: list[str]
    kind: str  # such as "plane", "B-spline", or "mesh" without geometry
    element: Array  # (T,3) its triangles
    area: float
    low: Floats  # (3) extent along the axes
    high: Floats
    centre: Floats  # (3) of area
    normal: Floats | None  # (3) outward, of a plane that bounds one volume


@dataclass
class Drawing:
    """All surfaces, with nodes (V,3) that they share."""

    node: Floats
    surfaces: list[Surface]

    def corners(self, surface: Surface) -> Floats:
        """(T,3,3) corners of the triangles of a surface."""
        found: Floats = self.node[surface.element]
        return found


def normals(corners: Floats) -> Floats:
    """(T,3) normals of triangles. Their length is twice the area."""
    found: Floats = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return found


# ---- Triangles ----


def kinds(surface: int) -> Iterator[tuple[int, int, list[int]]]:
    """Yields the element type, the number of nodes of an element, and the corners of the triangles that
    represent it."""
    for kind in gmsh.model.mesh.getElements(2, surface)[0]:
        _, _, _, nodes, _, corners = gmsh.model.mesh.getElementProperties(kind)
        for corner in [[0, 1, 2]] if corners == 3 else [[0, 1, 2], [0, 2, 3]]:
            yield kind, nodes, corner


def triangles(surface: int) -> tuple[Array, Floats]:
    """(T,3) numbers of the corners of the triangles on a surface, and their places (T,3,3)."""
    tags, places = [np.empty((0, 3), int)], [np.empty((0, 3, 3))]
    for kind, count, corner in kinds(surface):
        # A mesh of another program may have the nodes of a surface as nodes of the volume.
        tag, xyz, _ = gmsh.model.mesh.getNodesByElementType(kind, surface, returnParametricCoord=False)
        tags.append(tag.reshape(-1, count)[:, corner].astype(int))
        places.append(xyz.reshape(-1, count, 3)[:, corner])
    return np.concatenate(tags), np.concatenate(places)


def mesh_coarsely() -> None:
    """Meshes the surfaces finely enough for a picture."""
    low, high = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", AROUND)
    gmsh.option.setNumber("Mesh.MeshSizeMin", SMALLEST * float(np.linalg.norm(high - low)))
    gmsh.model.mesh.generate(2)


# ---- Measures ----


def peaks(at: Callable[[Floats], Floats], low: float, high: float) -> Floats:
    """(6,3) the points of a curve that lie farthest along WAYS. `at` gives the points (n,3) of parameters (n)."""
    along = np.tile(np.linspace(low, high, 129), (6, 1))
    for _ in range(4):  # each round narrows the parameters by 8, and the error of a smooth peak by 64
        points = at(along.ravel()).reshape(6, -1, 3)
        best = np.einsum("kpi,ki->kp", points, WAYS).argmax(axis=1)
        each, last = np.arange(6), along.shape[1] - 1
        first, end = along[each, np.maximum(best - 1, 0)], along[each, np.minimum(best + 1, last)]
        found = points[each, best]
        along = np.linspace(first, end, 17, axis=1)
    return found


def of_curve(curve: int) -> Floats:
    """(6,3) `peaks` of a curve of the drawing."""
    (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
    return peaks(lambda along: gmsh.model.getValue(1, curve, along).reshape(-1, 3), low, high)


def climbed(surface: int, start: Floats, step: Floats, way: Floats) -> Floats:
    """(3) the point where a climb along `way` on a surface ends. It starts at the parameters `start` (2), halves its
    steps (2) where none leads farther, and never leaves the surface."""
    around = np.array([[x, y] for x in (-1, 0, 1) for y in (-1, 0, 1) if x or y])
    here, place, least = start, gmsh.model.getValue(2, surface, start), step / 2**12
    for _ in range(200):
        if np.all(step < least):
            break
        tried = here + around * step
        points = gmsh.model.getValue(2, surface, tried.ravel()).reshape(-1, 3)
        gain = (points - place) @ way
        for k in np.argsort(-gain):
            if gain[k] > 0 and gmsh.model.isInside(2, surface, tried[k]):
                here, place = tried[k], points[k]
                break
        else:
            step = step / 2
    found: Floats = place
    return found


def extent(surface: int, corners: Floats, curves: dict[int, Floats]) -> tuple[Floats, Floats]:
    """The extent of a surface. That of its triangles is too small where it is curved, and the box of gmsh too large where
    it is a torus or has splines; between both, peaks are sought on its curves and on the surface.

    @param curves  peaks of curves that are known, to which those of this surface are added
    """
    known = corners.reshape(-1, 3)
    if (2, surface) not in gmsh.model.occ.getEntities(2):
        return known.min(axis=0), known.max(axis=0)
    for _, curve in gmsh.model.getBoundary([(2, surface)], oriented=False):
        if curve not in curves:
            curves[curve] = of_curve(curve)
        known = np.concatenate([known, curves[curve]])
    box = np.array(gmsh.model.getBoundingBox(2, surface))
    slack = SURE * float(np.linalg.norm(box[3:] - box[:3])) + 2e-7  # gmsh adds 1e-7
    most = np.concatenate([box[3:], -box[:3]])
    reached = (known @ WAYS.T).max(axis=0)
    if gmsh.model.getType(2, surface) not in RULED and len(corners):
        low, high = gmsh.model.getParametrizationBounds(2, surface)
        step = (np.array(high) - low) / np.sqrt(len(corners))
        for k in np.flatnonzero(most - reached > slack):
            farthest = known[np.argmax(known @ WAYS[k])]
            start = gmsh.model.getParametrization(2, surface, farthest)
            reached[k] = max(reached[k], climbed(surface, start, step, WAYS[k]) @ WAYS[k])
    return -reached[3:], reached[:3]


def kind_of(surface: int) -> str:
    """The kind of a surface in words."""
    kind: str = gmsh.model.getType(2, surface)
    words = {"Discrete surface": "mesh", "Surface of Revolution": "revolution", "BSpline surface": "B-spline"}
    return words.get(kind, kind.lower().removesuffix(" surface") or "other")


def sides() -> dict[int, int]:
    """1 for each surface whose triangles face out of the only volume that it bounds, -1 if they face into it."""
    found: dict[int, list[int]] = {}
    for _, volume in gmsh.model.getEntities(3):
        for _, signed in gmsh.model.getBoundary([(3, volume)], oriented=True):
            found.setdefault(abs(signed), []).append(1 if signed > 0 else -1)
    return {surface: signs[0] for surface, signs in found.items() if len(signs) == 1}


# ---- The drawing ----


def sew_faces(path: Path) -> None:
    """Reads a drawing of loose faces again and joins them, as ricochet-kernel does (src/mesh/sew.cpp), so that faces have its
    numbers. Those that enclose no volume stay loose."""
    if gmsh.model.getEntities(3) or not gmsh.model.getEntities(2):
        return
    low, high = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
    for option in ("Geometry.OCCSewFaces", "Geometry.OCCMakeSolids"):
        gmsh.option.setNumber(option, 1)
    for tolerance in TOLERANCES:
        gmsh.option.setNumber("Geometry.Tolerance", tolerance * float(np.linalg.norm(high - low)))
        gmsh.model.remove()
        gmsh.open(str(path))
        if gmsh.model.getEntities(3):
            return


def groups() -> dict[int, list[str]]:
    """Names of physical groups by surface."""
    found: dict[int, list[str]] = {}
    for dim, tag in gmsh.model.getPhysicalGroups(2):
        for surface in gmsh.model.getEntitiesForPhysicalGroup(dim, tag):
            found.setdefault(surface, []).append(gmsh.model.getPhysicalName(dim, tag) or str(tag))
    return found


def measured(
    number: int, element: Array, corners: Floats, side: int | None, curves: dict[int, Floats]
) -> Surface:
    """A surface with its measures: those of the drawing if OpenCASCADE has read it, otherwise those of the mesh."""
    normal = normals(corners)
    twice = np.linalg.norm(normal, axis=1)
    kind, exact = kind_of(number), (2, number) in gmsh.model.occ.getEntities(2)
    low, high = extent(number, corners, curves)
    if exact:
        area, centre = gmsh.model.occ.getMass(2, number), gmsh.model.occ.getCenterOfMass(2, number)
    else:
        area, centre = twice.sum() / 2, twice @ corners.mean(axis=1) / max(twice.sum(), 1e-300)
    towards = None
    if kind == "plane" and side and twice.any():
        towards = side * normal.sum(axis=0) / np.linalg.norm(normal.sum(axis=0))
    return Surface(number, [], kind, element, float(area), low, high, np.array(centre), towards)


def read_here(path: Path) -> Drawing:
    """Reads a drawing or mesh in this process. Raises whatever gmsh raises."""
    gmsh.initialize()
    gmsh.open(str(path))
    if path.suffix.lower() in SEWN:
        sew_faces(path)
    if not gmsh.model.mesh.getElements(2)[0].size:
        mesh_coarsely()
    named, side, curves = groups(), sides(), dict[int, Floats]()
    tags = [tag for _, tag in gmsh.model.getEntities(2)]
    meshed = {tag: triangles(tag) for tag in tags}
    if not meshed:
        return Drawing(np.empty((0, 3)), [])
    numbers, places = (np.concatenate(parts) for parts in zip(*meshed.values()))
    _, first, of = np.unique(numbers, return_index=True, return_inverse=True)
    node, starts = places.reshape(-1, 3)[first], np.cumsum([0, *(len(one) for one, _ in meshed.values())])
    surfaces = []
    for tag, start, (_, corners) in zip(tags, starts, meshed.values()):
        if len(corners):
            element = of.reshape(-1, 3)[start : start + len(corners)]
            surface = measured(tag, element, corners, side.get(tag), curves)
            surface.groups = named.get(tag, [])
            surfaces.append(surface)
    return Drawing(node, surfaces)
