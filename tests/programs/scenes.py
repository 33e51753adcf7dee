# SPDX-License-Identifier: BSD-2-Clause
"""Texts of scenes and geometries for the tests of several folders."""


def scene(bodies, modes, contact, time, obstacles=None, title="", more=""):
    """A scene. Each argument contains the lines of a section.

    @param bodies, obstacles  lines by name; the contact is between all of them, in this order
    @param more  further sections
    """
    sections = {f"bodies.{name}": lines for name, lines in bodies.items()}
    sections |= {f"obstacles.{name}": lines for name, lines in (obstacles or {}).items()}
    between = ", ".join(f'"{name.partition(".")[2]}"' for name in sections)
    sections |= {"modes": modes, "contact": f"between = [{between}]\n{contact}", "time": time}
    lines = [f'title = "{title}"'] * bool(title)
    for name, text in sections.items():
        lines += [f"[{name}]", text.strip()]
    return "\n".join([*lines, more.strip(), ""])


def rod(length=1, elements=10, curve="rod", ends=("left", "right")):
    """A rod along x. `geometry = { elements = … }` in a scene changes the number of elements."""
    return f"""
DefineConstant[elements = {elements}];
Point(1) = {{0, 0, 0}}; Point(2) = {{{length}, 0, 0}}; Line(1) = {{1, 2}};
Transfinite Curve{{1}} = elements + 1;
Physical Curve("{curve}") = {{1}}; Physical Point("{ends[0]}") = {{1}}; Physical Point("{ends[1]}") = {{2}};
"""


def two_rods(title, modes, time, names=("moving", "resting"), length=1, speed=0.01, elements=None, more=""):
    """Two rods of rod.geo with E = ρ = A = 1. The first one moves towards the second and touches it at the start."""
    common = 'mesh = "rod.geo"\norder = 1\nmaterial = { density = 1.0, young = 1.0, area = 1.0 }\n'
    own = (
        f'translate = [{-length}, 0, 0]\nvelocity = [{speed}, 0, 0]\ncontact = "right"\n',
        'contact = "left"\n',
    )
    meshes = [f"geometry = {{ elements = {n} }}\n" for n in elements] if elements else ["", ""]
    bodies = {name: common + lines + mesh for name, lines, mesh in zip(names, own, meshes)}
    return scene(bodies, modes, "direction = [1, 0, 0]", time, title=title, more=more)


def skewed_block(size):
    """A block without right angles, meshed with tetrahedra of this size."""
    return f"""
SetFactory("Built-in");
Point(1) = {{0, 0, 0, {size}}}; Point(2) = {{1.1, 0, 0, {size}}};
Point(3) = {{1.0, 1.3, 0, {size}}}; Point(4) = {{0, 1, 0, {size}}};
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 1}};
Curve Loop(1) = {{1:4}}; Plane Surface(1) = {{1}};
block[] = Extrude {{0, 0, 0.7}} {{ Surface{{1}}; }};
Physical Volume("block") = {{block[1]}};
Physical Surface("foot") = {{1}};
Physical Surface("side") = {{block[2]}};
"""


def sliding_block(more):
    """A block of block.geo, skewed_block(0.5), that lands on an edge, slides and turns by a fraction of a degree."""
    body = """
material = { density = 2.0, young = 3.0, poisson = 0.3 }
velocity = [0.002, 0, -0.002]
rotate_deg = [1, 0, 90]
"""
    contact, time = "gap = 1e-4\nfriction = 0.3", "rate_hz = 400\nduration = 3.0"
    return block_on_floor("Slide", "count = 20", contact, time, body, more)


def block_on_floor(title, modes, contact, time, body="", more=""):
    """A block of block.geo above a floor."""
    material = "material = { density = 2.0, young = 3.0, poisson = 0.3 }"
    lines = f'mesh = "block.geo"\norder = 2\ncontact = "foot"\n{body or material}'
    floor = {"floor": "normal = [0, 0, 1]"}
    return scene({"block": lines}, modes, contact, time, floor, title, more)
