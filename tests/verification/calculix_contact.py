# SPDX-License-Identifier: BSD-2-Clause
"""Impacts with CalculiX (`ccx`): writes the input from the meshes of Ricochet's bodies, runs it, and reads the forces and the
motion.

Bodies are second-order tetrahedra (C3D10), half-spaces one fixed C3D8 each. Contact of two bodies or of a body and a half-space is
that of *CONTACT PAIR, TYPE=SURFACE TO SURFACE, with linear penalties of pressure and, with friction, of stick; steps are those
of *DYNAMIC, DIRECT."""
import dataclasses
import hashlib
import shutil

import numpy as np

from ricochet import timing
from ricochet.errors import InputError, SolverError
from ricochet.interchange.elements import TETRAHEDRON

# gmsh and CalculiX number the last two nodes of a tetrahedron of order 2 in opposite order.
CALCULIX_NODES = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]
TETRAHEDRON_OF_GMSH = 11  # of order 2
# For the mass: exact on straight elements, for the product of a coordinate and a shape function.
QUADRATURE = "Gauss6"
AREA_LINE = 7  # of the statistics of a contact, after the force, the centre, and the moment about it, with a title each
OBSTACLE_FACE = "S2"  # opposite to the one through the first four nodes


def need():
    """Raises InputError if ccx is missing."""
    if not shutil.which("ccx"):
        raise InputError("ccx: no such program: scripts/setup --peers installs CalculiX")


@dataclasses.dataclass
class Body:
    """A body in world axes. Nodes and elements are numbered from 0."""

    name: str
    node: np.ndarray  # (n,3) m
    element: np.ndarray  # (e,10) nodes, in the order of CalculiX
    contact: np.ndarray  # (f,3) corner nodes of the facets that may touch
    supported: dict  # nodes (h) by component of the displacement, 0 to 2
    material: dict  # density [kg/m³], young [Pa], poisson
    velocity: list  # initial velocity [m/s]
    weight: np.ndarray  # (n) kg: the mean velocity is weight @ v / mass
    moment: np.ndarray  # (n,3) kg m: weight times position relative to the centre
    centre: np.ndarray  # (3) m
    inertia: np.ndarray  # (3,3) kg m², about the centre

    @property
    def mass(self):
        return float(self.weight.sum())

    def faces(self):
        """The contact as pairs of an element and the name of its face, S1 to S4."""
        found = {}
        for e, nodes in enumerate(self.element):
            for k, corners in enumerate(TETRAHEDRON.faces, 1):
                found[frozenset(nodes[list(corners)].tolist())] = e, f"S{k}"
        return [found[frozenset(facet.tolist())] for facet in self.contact]

    def mean_velocity(self, v):
        """Mean over the mass [m/s] of velocities (n,3) of the nodes."""
        return self.weight @ v / self.mass

    def spin(self, v):
        """Angular velocity [rad/s]: the inverse of the inertia times the angular momentum."""
        momentum = np.array(
            [self.moment[:, k - 2] @ v[:, k - 1] - self.moment[:, k - 1] @ v[:, k - 2] for k in range(3)]
        )
        return np.linalg.solve(self.inertia, momentum)


def mesh_file(geo, parameters, order, path):
    """Meshes a .geo as Ricochet does, and writes a .msh that both codes read."""
    import gmsh

    gmsh.initialize(readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        # DefineConstant keeps a value that is already there.
        text = "".join(f"{name} = {value!r};\n" for name, value in parameters.items())
        wrapper = path.with_name(f"{path.name}.geo")
        wrapper.write_text(f'{text}Merge "{geo.resolve()}";\n')
        gmsh.open(str(wrapper))
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


def rotation(degrees):
    """Matrix (3,3) of rotations about the fixed axes x, then y, then z."""
    found = np.eye(3)
    for k, angle in enumerate(np.radians(degrees)):
        turn, (i, j) = np.eye(3), ((k + 1) % 3, (k + 2) % 3)
        turn[i, i] = turn[j, j] = np.cos(angle)
        turn[j, i], turn[i, j] = np.sin(angle), -np.sin(angle)
        found = turn @ found
    return found


def body_of(path, name, table):
    """The body of a .msh. @param table  its table of the resolved scene; a body that is turned may have no supports"""
    import gmsh

    turn = rotation(table["rotate_deg"])
    if table["support"] and not np.array_equal(turn, np.eye(3)):
        raise InputError(f"{path}: CalculiX is given supports along the axes of the world only")
    gmsh.initialize(readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        tags, positions, _ = gmsh.model.mesh.getNodes()
        kinds, _, elements = gmsh.model.mesh.getElements(3)
        if list(kinds) != [TETRAHEDRON_OF_GMSH]:
            raise InputError(f"{path}: CalculiX is given tetrahedra of order 2 only")
        row = np.full(int(tags.max()) + 1, -1)
        row[tags.astype(int)] = np.arange(len(tags))
        node = positions.reshape(-1, 3) @ turn.T + table["translate"]
        element = row[elements[0].astype(int)].reshape(-1, 10)
        groups = {gmsh.model.getPhysicalName(d, tag): (d, tag) for d, tag in gmsh.model.getPhysicalGroups(2)}

        def facets(group):
            entities = gmsh.model.getEntitiesForPhysicalGroup(*groups[group])
            of = [gmsh.model.mesh.getElements(2, entity)[2][0] for entity in entities]
            return row[np.concatenate(of).astype(int)].reshape(-1, 6)

        supported = {}
        for group, axes in table["support"].items():
            for component in map("xyz".index, axes):
                supported[component] = np.union1d(supported.get(component, []), facets(group)).astype(int)
        contact = np.concatenate([facets(group) for group in table["contact"]])[:, :3]
        points, weights = gmsh.model.mesh.getIntegrationPoints(TETRAHEDRON_OF_GMSH, QUADRATURE)
        shape = gmsh.model.mesh.getBasisFunctions(TETRAHEDRON_OF_GMSH, points, "Lagrange")[1]
        volume = gmsh.model.mesh.getJacobians(TETRAHEDRON_OF_GMSH, points)[1]
    finally:
        gmsh.finalize()
    shape = np.array(shape).reshape(len(weights), 10)
    mass = table["material"]["density"] * np.array(volume).reshape(len(element), -1) * weights  # (e,g) kg
    place = np.einsum("ga,eax->egx", shape, node[element])
    centre = np.einsum("eg,egx->x", mass, place) / mass.sum()
    place -= centre
    square = np.einsum("eg,egx,egy->xy", mass, place, place)
    weight, moment = np.zeros(len(node)), np.zeros((len(node), 3))
    np.add.at(weight, element, mass @ shape)
    np.add.at(moment, element, np.einsum("eg,egx,ga->eax", mass, place, shape))
    return Body(
        name,
        node,
        element[:, CALCULIX_NODES],
        contact,
        supported,
        table["material"],
        table["velocity"],
        weight,
        moment,
        centre,
        np.trace(square) * np.eye(3) - square,
    )


@dataclasses.dataclass
class HalfSpace:
    """A rigid obstacle: one fixed C3D8 of this size [m] below the surface through `point`."""

    name: str
    point: list
    normal: list
    size: float

    def nodes(self):
        """Positions (8,3) [m] of the nodes. The last four are on the surface."""
        normal = np.array(self.normal) / np.linalg.norm(self.normal)
        first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        around = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        surface = np.array([self.point + self.size * (a * first + b * second) for a, b in around])
        return np.concatenate([surface - self.size * normal, surface])


@dataclasses.dataclass
class Contact:
    """Surfaces that may touch and their law."""

    dependent: str  # name of a body: its facets carry the points of contact
    independent: str  # name of a body or half-space
    penalty: float  # N/m³: pressure over penetration
    friction: float = 0.0
    stick: float = 0.0  # N/m³: shear over slip of points that stick

    def law(self):
        friction = f"*FRICTION\n{number(self.friction)},{number(self.stick)}\n" if self.friction else ""
        return (
            "*SURFACE INTERACTION, NAME=LAW\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n"
            f"{number(self.penalty)}\n{friction}"
        )


@dataclasses.dataclass
class Steps:
    """Fixed increments."""

    step: float  # s
    duration: float  # s
    alpha: float = -0.05  # of Hilber, Hughes and Taylor; -0.05 is the default of CalculiX
    gravity: tuple = ()  # (3) m/s²; none if empty


def number(x):
    """CalculiX reads at most 20 characters of a number."""
    return f"{x:.12e}"


def listed(name, keyword, numbers):
    return f"*{keyword}, {keyword}={name}\n" + "".join(f"{n},\n" for n in numbers)


def weight(bodies, gravity):
    """The cards of the weight of all bodies."""
    size = float(np.linalg.norm(gravity))
    if not size:
        return ""
    along = ",".join(number(g / size) for g in gravity)
    return "*DLOAD\n" + "".join(f"E{body.name},GRAV,{number(size)},{along}\n" for body in bodies)


def deck(bodies, obstacles, contact, steps):
    """The input of ccx. Nodes and elements are numbered from 1, body by body, then the obstacles."""
    text, nodes, elements, ends = [], 0, 0, []
    for body in bodies:
        name = body.name
        text.append(f"*NODE, NSET=N{name}\n")
        text += (f"{nodes + n},{','.join(map(number, x))}\n" for n, x in enumerate(body.node, 1))
        text.append(f"*ELEMENT, TYPE=C3D10, ELSET=E{name}\n")
        text += (
            f"{elements + e},{','.join(str(nodes + n + 1) for n in row)}\n"
            for e, row in enumerate(body.element, 1)
        )
        density, young, poisson = (number(body.material[key]) for key in ("density", "young", "poisson"))
        text.append(f"*MATERIAL, NAME=M{name}\n*ELASTIC\n{young},{poisson}\n*DENSITY\n{density}\n")
        text.append(f"*SOLID SECTION, ELSET=E{name}, MATERIAL=M{name}\n*SURFACE, NAME=S{name}\n")
        text += (f"{elements + e + 1},{face}\n" for e, face in body.faces())
        for component, supported in body.supported.items():
            text.append(listed(f"H{component}{name}", "NSET", nodes + supported + 1))
            text.append(f"*BOUNDARY\nH{component}{name},{component + 1}\n")
        ends += [f"N{name},{k},{number(v)}\n" for k, v in enumerate(body.velocity, 1)]
        nodes, elements = nodes + len(body.node), elements + len(body.element)
    for obstacle in obstacles:
        name = obstacle.name
        text.append(f"*NODE, NSET=N{name}\n")
        text += (f"{nodes + n},{','.join(map(number, x))}\n" for n, x in enumerate(obstacle.nodes(), 1))
        text.append(f"*ELEMENT, TYPE=C3D8, ELSET=E{name}\n")
        text.append(f"{elements + 1},{','.join(str(nodes + n) for n in range(1, 9))}\n")
        text.append(f"*SOLID SECTION, ELSET=E{name}, MATERIAL=M{bodies[0].name}\n")
        text.append(f"*BOUNDARY\nN{name},1,3\n*SURFACE, NAME=S{name}\n{elements + 1},{OBSTACLE_FACE}\n")
        nodes, elements = nodes + 8, elements + 1
    pair = f"S{contact.dependent},S{contact.independent}"
    text.append(
        f"{contact.law()}*CONTACT PAIR, INTERACTION=LAW, TYPE=SURFACE TO SURFACE\n{pair}\n"
        f"*INITIAL CONDITIONS, TYPE=VELOCITY\n{''.join(ends)}"
        f"*STEP, INC=1000000\n*DYNAMIC, DIRECT, ALPHA={steps.alpha}\n"
        f"{number(steps.step)},{number(steps.duration)}\n{weight(bodies, steps.gravity)}"
        f"*CONTACT PRINT, SLAVE=S{contact.dependent}, MASTER=S{contact.independent}\nCF\n"
    )
    for body in bodies:
        text.append(
            f"*EL PRINT, ELSET=E{body.name}, TOTALS=ONLY\nELKE,ELSE\n*NODE PRINT, NSET=N{body.name}\nV\n"
        )
    text.append("*END STEP\n")
    return "".join(text)


def blocks(text):
    """Yields heading, time [s] and lines of each block of a .dat file."""
    heading, time, lines = None, 0.0, []
    for line in text.splitlines():
        if " and time " in line:
            if heading:
                yield heading, time, lines
            heading, _, stamp = line.strip().partition(" and time ")
            time, lines = float(stamp), []
        elif line.strip():
            lines.append(line)
    if heading:
        yield heading, time, lines


def read(text, bodies):
    """What a .dat file of `deck` contains: `time` (k) [s] of the increments; at these times `force` (k,3) [N] on the dependent
    body, `area` (k) [m²] of its facets that is pressed, and `energy` (k) [J], kinetic and strain; at the end `velocity` and
    `spin` of each body, (3) [m/s] and [rad/s].
    """
    time, force, area, energy, last = [], [], [], {}, {}
    for heading, when, lines in blocks(text):
        if heading.startswith("statistics"):
            time.append(when)
            force.append([float(word) for word in lines[1].split()[:3]])
            area.append(float(lines[AREA_LINE].split()[0]))
        elif "energy" in heading:
            energy[when] = energy.get(when, 0.0) + float(lines[0])
        else:
            last[heading.split()[-1]] = lines
    found = {"time": time, "force": force, "area": area, "energy": [energy[when] for when in time]}
    found |= {"velocity": {}, "spin": {}}
    for body in bodies:
        v = np.array([line.split()[1:] for line in last.get(f"N{body.name}".upper(), [])], float)
        if len(v):
            found["velocity"][body.name] = body.mean_velocity(v).tolist()
            found["spin"][body.name] = body.spin(v).tolist()
    return found


def run(folder, bodies, obstacles, contact, steps, cache):
    """Runs ccx with one thread unless the cache has this input. Returns the data of `read` with wall and processor time [s]
    and `complete`: False if ccx stopped before the end. A run that a signal ended is an error, and is not cached.
    """
    text = deck(bodies, obstacles, contact, steps)
    entry = cache.entry({"input_sha256": hashlib.sha256(text.encode()).hexdigest(), "threads": 1})
    if not entry["runs"]:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "impact.inp").write_text(text)
        done = timing.timed(["ccx", "-i", "impact"], folder)
        if done.status < 0:
            raise SolverError(f"ccx: ended by signal {-done.status}")
        printed = folder / "impact.dat"
        found = read(printed.read_text() if printed.is_file() else "", bodies)
        if not found["time"]:
            raise SolverError(f"ccx: computes nothing: {done.text[-500:]}")
        found |= {"seconds": done.seconds, "cpu_seconds": done.cpu_seconds}
        found |= {"complete": found["time"][-1] > steps.duration - steps.step / 2}
        entry["runs"].append(found)
        cache.save()
    return entry["runs"][0]
