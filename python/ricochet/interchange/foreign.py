# SPDX-License-Identifier: BSD-2-Clause
"""Mesh files of other programs: which module reads which, and what becomes of them."""
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ricochet.errors import InputError
from ricochet.interchange import abaqus, cgns, med, msh, nastran, unstructured, unv, vtk
from ricochet.interchange.draft import Offer
from ricochet.interchange.faces import Faces, Groups, groups_of
from ricochet.interchange.mesh import Mesh

DECKS = {".inp": abaqus.read, **dict.fromkeys((".bdf", ".nas", ".dat", ".fem"), nastran.read)}
MESHES: dict[str, Callable[[Path], Mesh]] = {
    **dict.fromkeys((".med", ".mmed", ".rmed"), med.read),
    **dict.fromkeys((".vtu", ".vtk"), vtk.read),
    **{".unv": unv.read, ".cgns": cgns.read},
    **dict.fromkeys(
        (".xdmf", ".xmf", ".e", ".exo", ".ex2", ".xml", ".vol", ".mesh", ".meshb"), unstructured.read
    ),
    **dict.fromkeys((".su2", ".f3grid", ".avs", ".node", ".ele", ".h5m", ".ugrid"), unstructured.read),
}
DIRECT = {
    **dict.fromkeys((".geo", ".step", ".stp", ".brep", ".iges", ".igs", ".stl"), "is a drawing"),
    ".msh": "is a mesh of gmsh",
}


@dataclass
class Import:
    """A mesh in gmsh's order, with its groups and what a deck states for a scene."""

    mesh: Mesh
    faces: Faces
    groups: Groups
    names: dict[str, str]  # the group of each set of nodes
    offer: Offer | None

    def write(self, path: Path) -> None:
        """Writes the .msh. Raises OSError."""
        msh.write(path, self.mesh, self.faces, self.groups)


def read(path: Path, length: float, mass: float) -> Import:
    """Reads the file by its ending and converts its units to SI: lengths in units of `length` [m], masses in units of
    `mass` [kg]. Raises InputError and OSError."""
    ending, offer = path.suffix.lower(), None
    if ending in DIRECT:
        raise InputError(f'{path}: {DIRECT[ending]}: name it in a scene as it is, mesh = "{path.name}"')
    if ending in DECKS:
        mesh, offer = DECKS[ending](path)
    elif ending in MESHES:
        mesh = MESHES[ending](path)
    else:
        known = ", ".join((*DECKS, *MESHES))
        raise InputError(f'{path}: "{ending}" is no kind of mesh that is read: name one of {known}')
    mesh.check()
    mesh.order_nodes()
    if added := mesh.complete():
        mesh.warn(
            f"its elements lack nodes in the middle of quadrangles: {added} were added on the same shape, so the body "
            "is less stiff than that of 20-node bricks and 15-node wedges"
        )
    mesh.node = mesh.node * length
    if offer:
        offer.materials = {name: one.in_units(length, mass) for name, one in offer.materials.items()}
    faces = Faces(mesh)
    groups, names = groups_of(mesh, faces)
    for name in offer.supports if offer else ():
        if name not in names:
            mesh.warn(f'the support of "{name}" holds no node of a solid: the scene lacks it')
    return Import(mesh, faces, groups, names, offer)
