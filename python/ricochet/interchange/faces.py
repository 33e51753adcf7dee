# SPDX-License-Identifier: BSD-2-Clause
"""Faces of the solids of a mesh, and the groups that a .msh gets: of solids, of faces and of points."""
from dataclasses import dataclass, field

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.interchange import elements
from ricochet.interchange.mesh import Mesh


@dataclass
class Groups:
    """Members of each group by name: places in mesh.solid_number, faces, nodes. No two groups share a name."""

    solids: dict[str, Array] = field(default_factory=dict)
    faces: dict[str, Array] = field(default_factory=dict)
    points: dict[str, Array] = field(default_factory=dict)


class Faces:
    """Each face of the solids once. `corner` (F,4): its sorted corners, −1 before those of a triangle; `outer` (F):
    whether it belongs to one solid only."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        sides = [(size, face) for size in mesh.solids for face in elements.SOLIDS[size].faces]
        corners = [padded(mesh.solids[size][:, list(face)]) for size, face in sides]
        self.corner, first, count = np.unique(
            np.concatenate(corners), axis=0, return_index=True, return_counts=True
        )
        self.outer = count == 1
        # Where each face was found: its kind, and the row of its solid in the block of this kind.
        kind = np.repeat(np.arange(len(sides)), [len(rows) for rows in corners])
        row = np.concatenate([np.arange(len(rows)) for rows in corners])
        self.sides, self.kind, self.row = sides, kind[first], row[first]

    def nodes(self, faces: Array) -> list[tuple[Array, Array]]:
        """The faces by number of nodes: their places in `faces`, and (m,k) nodes in gmsh's order."""
        found: dict[int, list[tuple[Array, Array]]] = {}
        for kind, (size, face) in enumerate(self.sides):
            here = np.flatnonzero(self.kind[faces] == kind)
            if here.size:
                columns = elements.face_nodes(size, face)
                rows = self.mesh.solids[size][self.row[faces[here]]][:, columns]
                found.setdefault(len(columns), []).append((here, rows))
        return [
            (np.concatenate([here for here, _ in same]), np.concatenate([rows for _, rows in same]))
            for same in found.values()
        ]

    def find(self, corners: Array) -> Array:
        """The face of each row of corners (m,4), −1 if no solid has it."""
        rows, same = np.unique(np.concatenate([self.corner, padded(corners)]), axis=0, return_inverse=True)
        place = np.full(len(rows), -1)
        place[same.ravel()[: len(self.corner)]] = np.arange(len(self.corner))
        found: Array = place[same.ravel()[len(self.corner) :]]
        return found

    def covering(self, nodes: Array, skin: Array, rows: list[tuple[Array, Array]]) -> Array | None:
        """The outer faces that consist of these nodes, if together they have all of them. `rows`: those of the skin."""
        inside = np.zeros(len(self.mesh.node), bool)
        inside[nodes] = True
        held = []
        for places, faces in rows:
            whole = inside[faces].all(axis=1)
            held.append(skin[places[whole]])
            nodes = np.setdiff1d(nodes, faces[whole])
        return None if nodes.size else np.sort(np.concatenate(held))


def padded(corners: Array) -> Array:
    """(m,4) sorted corners, −1 before those of triangles."""
    rows = np.full((len(corners), 4), -1)
    rows[:, : corners.shape[1]] = corners
    return np.sort(rows, axis=1)


def free_name(name: str, suffix: str, taken: set[str], mesh: Mesh) -> str:
    """A name that no other group has. One group of the mesh file has one name, whatever its dimension."""
    if '"' in name or not name.isprintable() or not 0 < len(name.encode()) <= 120:
        raise InputError(
            f"{mesh.path}: set {name[:40]!a} can't be the name of a group: give it at most 120 printable characters "
            "without quotes"
        )
    free = name
    while free in taken:
        free += suffix
    if free != name:
        mesh.warn(f'two sets are called "{name}": the one of{suffix} is the group "{free}"')
    taken.add(free)
    return free


def groups_of(mesh: Mesh, faces: Faces) -> tuple[Groups, dict[str, str]]:
    """The groups of a mesh, and the name of the group of each set of nodes. A set whose nodes are those of outer
    faces becomes a group of these faces, which may touch; any other one a group of points. Nodes and faces
    of no solid are left out."""
    groups, taken = Groups(), set[str]()
    names: dict[str, str] = {}
    for name, solids in mesh.solid_groups.items():
        groups.solids[free_name(name, " solids", taken, mesh)] = np.unique(solids)
    for name, corners in mesh.facet_groups.items():
        found = np.unique(faces.find(corners))
        if found.size and found[0] < 0:
            mesh.warn(f'"{name}": the surface elements that are no face of a solid are left out')
            found = found[1:]
        if found.size:
            groups.faces[free_name(name, " faces", taken, mesh)] = found
    add_node_sets(mesh, faces, groups, names, taken)
    add_whole(mesh, groups, taken)
    return groups, names


def add_node_sets(mesh: Mesh, faces: Faces, groups: Groups, names: dict[str, str], taken: set[str]) -> None:
    used = np.zeros(len(mesh.node), bool)
    for rows in mesh.solids.values():
        used[rows] = True
    skin = np.flatnonzero(faces.outer)
    nodes_of_skin = faces.nodes(skin)
    for name, members in mesh.node_groups.items():
        nodes = np.unique(members[used[members]])
        if not nodes.size:
            continue
        covered = faces.covering(nodes, skin, nodes_of_skin)
        names[name] = name
        if covered is not None and np.array_equal(covered, groups.faces.get(name, ())):
            continue
        if name in groups.solids and np.array_equal(nodes, mesh.nodes_of(groups.solids[name])):
            continue
        names[name] = free_name(name, " nodes", taken, mesh)
        if covered is None:
            groups.points[names[name]] = nodes
        else:
            groups.faces[names[name]] = covered


def add_whole(mesh: Mesh, groups: Groups, taken: set[str]) -> None:
    """Adds a group of all solids if some belong to none: a scene takes them for no part of the body otherwise."""
    solids = np.arange(len(mesh.solid_number))
    if np.setdiff1d(solids, np.concatenate([*groups.solids.values(), np.empty(0, int)])).size:
        groups.solids[free_name("whole", " body", taken, mesh)] = solids
