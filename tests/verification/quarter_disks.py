# SPDX-License-Identifier: BSD-2-Clause
"""The paper's two disks, or rings, as a quarter of each by two planes of symmetry, with small elements at the contact."""

GRAVITY, GAP, RADIUS, THICKNESS = 9.81, 0.01, 0.05, 5e-3
SIZE = 2.5e-3  # m, of the elements at the contact unless a scene states it
GEO = """// A quarter of a disk or of a ring, x ≥ 0 and z ≥ 0. Its contact extends from (0, side · radius, 0) up to the angle `reach`.
DefineConstant[
  radius = 0.05, hole = 0, thickness = 5e-3, side = 1, reach = 0.7, size = 2.5e-3, largest = 1e-2
];
SetFactory("Built-in");
Point(1) = {0, 0, 0, largest};
Point(2) = {0, side * radius, 0, size};
Point(3) = {radius * Sin(reach), side * radius * Cos(reach), 0, size};
Point(4) = {radius, 0, 0, largest};
Point(5) = {0, -side * radius, 0, largest};
Circle(2) = {2, 1, 3};
Circle(3) = {3, 1, 4};
Circle(4) = {4, 1, 5};
If (hole > 0)
  Point(6) = {0, -side * hole, 0, largest};
  Point(7) = {hole, 0, 0, largest};
  Point(8) = {0, side * hole, 0, size};
  Line(1) = {8, 2};
  Line(5) = {5, 6};
  Circle(6) = {6, 1, 7};
  Circle(7) = {7, 1, 8};
  Curve Loop(1) = {1:7};
Else
  Line(1) = {1, 2};
  Line(5) = {5, 1};
  Curve Loop(1) = {1:5};
EndIf
Transfinite Curve{2} = Ceil(reach * radius / size - 1e-6) + 1;
Plane Surface(1) = {1};
half[] = Extrude {0, 0, thickness / 2} { Surface{1}; Layers{1}; };
Physical Volume("disk") = {half[1]};
Physical Surface("axis") = {half[2], half[6]};
Physical Surface("contact") = {half[3]};
Physical Surface("far half") = {half[5]};
Physical Surface("middle plane") = {1};
"""
BODY = """
mesh = "disk.geo"
order = 2
material = { density = 11.3e3, young = 10.4e6, poisson = 0.37 }
contact = "contact"
"""
SCENE = f"""[bodies.upper]{BODY}geometry = {{ side = -1 }}
translate = [0, {2 * RADIUS + GAP}, 0]
velocity = [0, -6, 0]
support = {{ "axis" = "x", "middle plane" = "z" }}
[bodies.lower]{BODY}support = {{ "axis" = "x", "middle plane" = "z", "far half" = "xyz" }}
[modes]
up_to_hz = 3000
[contact]
between = ["upper", "lower"]
direction = [0, -1, 0]
[time]
rate_hz = 44100
duration = 0.02
[loads]
gravity = [0, {-GRAVITY}, 0]
"""


def geometry(**names):
    """Settings of the geometry of both bodies."""
    found = []
    for body, side in (("upper", -1), ("lower", 1)):
        values = ",".join(f"{name}={value!r}" for name, value in (names | {"side": side}).items())
        found.append(f"bodies.{body}.geometry={{{values}}}")
    return found


def write(folder):
    """Writes the scene and its geometry. Returns the path of the scene."""
    (folder / "disk.geo").write_text(GEO)
    path = folder / "disks.toml"
    path.write_text(SCENE)
    return path
