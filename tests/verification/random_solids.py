# SPDX-License-Identifier: BSD-2-Clause
"""Geometries of the solids that random checks draw."""

SHAPES = {
    "box": "Box(1) = {{-{x}/2, -{y}/2, 0, {x}, {y}, {z}}};",
    "cylinder": "Cylinder(1) = {{0, 0, 0, 0, 0, {z}, {x}/2}};",
    "ball": "Sphere(1) = {{0, 0, {x}/2, {x}/2}};",
    "bracket": "Box(1) = {{-{x}/2, -{y}/2, 0, {x}, {y}, {z}/4}}; Box(2) = {{-{x}/2, -{y}/2, 0, {x}/4, {y}, {z}}};"
    " BooleanUnion(3) = {{ Volume{{1}}; Delete; }}{{ Volume{{2}}; Delete; }};",
}
GEO = """SetFactory("OpenCASCADE");
{shape}
Mesh.MeshSizeMax = {size};
Mesh.MeshSizeMin = {smallest};
Physical Volume("body") = Volume{{:}};
Physical Surface("skin") = Surface{{:}};
Physical Surface("foot") = {{1}};
"""


def geometry(kind, x, y, z, size, smallest=0):
    """Text of a .geo file for a solid with these sizes and element sizes [m]. Its group `skin` is the whole surface,
    `foot` one face."""
    return GEO.format(shape=SHAPES[kind].format(x=x, y=y, z=z), size=size, smallest=smallest)
