# SPDX-License-Identifier: BSD-2-Clause
"""Stress of the plate of NAFEMS LE10 (`cases/notches.py`) at rest under pressure, and of its lowest modes, on the same tetrahedra of order 2.

Both codes have the same stiffness, as the frequencies show. CalculiX extrapolates the stress from the integration points of each element to its nodes and
averages there; Ricochet fits polynomials to the displacement around the node. `recovery.py`, which shares no code with Ricochet, does the same with the
displacement of CalculiX, so that its stress and that of Ricochet differ by the solutions alone."""
import warnings

import h5py
import numpy as np

import calculix_contact
import recovery
import ricochet
from benchmarks import calculix
from case import rms
from cases import notches
from programs import scene_of
from ricochet import timing
from ricochet.errors import SolverError

TITLE = "Stress on the same mesh"

SIZES = (0.2, 0.1)  # m
NODES, MODES = 40, 3
FRD_ORDER = [0, 1, 2, 4, 5, 3]  # of ours in xx, yy, zz, xy, yz, zx
SAME = 0.01  # allowed difference of stresses by the same recovery, relative to the largest one
RIM = (3.25, 2.75)  # half axes of the outer ellipse [m]


def scene_text(size, places):
    gauges = {f"{k}": place for k, place in enumerate(places)}
    text = notches.scene(
        "le10",
        0.3,
        '{ "on x" = "y", "on y" = "x", rim = "xy", middle = "z" }',
        "on x",
        'group = "top"\nvector = [0, 0, -1e6]',
        gauges,
    )
    text = text.replace('"le10.geo"', f'"le10-{size:g}.msh"').replace("count = 3", f"count = {MODES}")
    return f'title = "le10-{size:g}"\n' + text


def body_of(path):
    """The plate, whose curve "middle" is held as well."""
    table = {
        "rotate_deg": [0, 0, 0],
        "translate": [0, 0, 0],
        "support": {"on x": "y", "on y": "x", "rim": "xy"},
        "contact": ["top"],
        "material": {"density": 1000.0, "young": 210e9, "poisson": 0.3},
        "velocity": [0, 0, 0],
    }
    body = calculix_contact.body_of(path, "plate", table)
    x, y, z = body.node.T
    on_rim = np.abs(np.hypot(x / RIM[0], y / RIM[1]) - 1) < 1e-6
    body.supported[2] = np.flatnonzero(on_rim & (np.abs(z - 0.3) < 1e-9))
    return body


def chosen(body):
    """Nodes (NODES) that are compared: corners of elements, half of them inside and half on the border, away from the supports on lines."""
    corners = np.unique(body.element[:, :4])
    x, y, z = body.node[corners].T
    outside = np.hypot(x / 2, y) ** 2 - 1 < 1e-6
    border = (np.abs(z - 0.6) < 1e-9) | (z < 1e-9) | outside
    free = (np.hypot(x / RIM[0], y / RIM[1]) < 0.9) & (x > 0.1) & (y > 0.1)
    random = np.random.default_rng(1)
    sets = [corners[free & ~border], corners[free & border]]
    return [np.sort(random.choice(nodes, min(NODES // 2, len(nodes)), replace=False)) for nodes in sets]


def input_of(body):
    """The input of CalculiX: a static step and one of frequencies."""
    lines = ["*NODE, NSET=all"]
    lines += [f"{k + 1}, {x:.17g}, {y:.17g}, {z:.17g}" for k, (x, y, z) in enumerate(body.node)]
    lines += ["*ELEMENT, TYPE=C3D10, ELSET=plate"]
    lines += [", ".join(str(n) for n in (e + 1, *(nodes + 1))) for e, nodes in enumerate(body.element)]
    young, poisson, density = (body.material[key] for key in ("young", "poisson", "density"))
    lines += ["*MATERIAL, NAME=steel", "*ELASTIC", f"{young}, {poisson}", "*DENSITY", f"{density}"]
    lines += ["*SOLID SECTION, ELSET=plate, MATERIAL=steel", "*BOUNDARY"]
    for component, nodes in body.supported.items():
        lines += [f"{n + 1}, {component + 1}, {component + 1}" for n in nodes]
    lines += ["*STEP", "*STATIC", "*DLOAD"]
    lines += [f"{e + 1}, P{face[1:]}, 1e6" for e, face in body.faces()]
    files = ["*NODE FILE", "U", "*EL FILE", "S", "*END STEP"]
    lines += [*files, "*STEP", "*FREQUENCY", f"{MODES}", *files]
    return "\n".join(lines) + "\n"


def fields_of(path, name, nodes, width):
    """Values (nodes,width) of a field, DISP or STRESS, of each result in a .frd file."""
    found, values = [], None
    for line in path.read_text().splitlines():
        if line.startswith(" -4"):
            values = np.zeros((nodes, width)) if line.split()[1] == name else None
            if values is not None:
                found.append(values)
        elif line.startswith(" -1") and values is not None:
            values[int(line[3:13]) - 1] = [float(line[k : k + 12]) for k in range(13, 13 + 12 * width, 12)]
    return found


def theirs(folder, body, places):
    """Stresses (places,6) at rest and in the lowest modes, averaged by CalculiX and recovered from its displacement, and the frequencies
    of the modes [Hz]. @param places  numbers of corners"""
    folder.mkdir(exist_ok=True)
    (folder / "plate.inp").write_text(input_of(body))
    done = timing.timed(["ccx", "-i", "plate"], folder)
    path, count = folder / "plate.frd", len(body.node)
    averaged, moved = fields_of(path, "STRESS", count, 6), fields_of(path, "DISP", count, 3)
    if len(averaged) != 1 + MODES or len(moved) != 1 + MODES:
        raise SolverError(f"ccx: {len(averaged)} results in place of {1 + MODES}: {done.text[-1000:]}")
    young, poisson = body.material["young"], body.material["poisson"]
    recovered = [recovery.stresses(body.node, body.element, places, field, young, poisson) for field in moved]
    return (
        [field[places][:, FRD_ORDER] for field in averaged],
        recovered,
        calculix.frequencies_of(folder / "plate.dat"),
    )


def ours(folder, size, places):
    """Stresses (n,6) of the places at rest and in the lowest modes, normalised by mass, and the frequencies of these [Hz]."""
    scene = folder / f"le10-{size:g}.toml"
    scene.write_text(scene_text(size, places))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the benchmark holds a line
        kernels = ricochet.kernels(scene_of(scene), 1, folder)
        result = ricochet.impact(scene_of(scene), folder)
    with h5py.File(kernels["body"].path) as kernel:
        frequency = kernel["modes/angular_frequency"][:MODES] / (2 * np.pi)
        modes = np.array([kernel[f"gauges/{k}/stress/shape"][:] for k in range(len(places))])
    at_rest = np.array([result.gauges[f"{k}"].stress[-1] for k in range(len(places))])
    return [at_rest] + [modes[:, :, n] for n in range(MODES)], frequency


def differences(stress, other, inside):
    """Root mean squares of the difference inside and on the border, relative to the largest stress."""
    other = other * np.sign((stress * other).sum())  # modes have any sign
    apart = np.abs(stress - other) / np.abs(stress).max()
    return rms(apart[:inside]), rms(apart[inside:])


def run(folder, cache, figure):
    """Compares both codes on each mesh, and prints a table."""
    geo = folder / "le10.geo"
    geo.write_text(notches.LE10)
    print("| size (m) | load | frequency, difference | recovery | stress inside | stress on the border |")
    print("|---|---|---|---|---|---|")
    for size in SIZES:
        path = folder / f"le10-{size:g}.msh"
        calculix_contact.mesh_file(geo, {"size": size}, 2, path)
        body = body_of(path)
        inside, border = chosen(body)
        compared = np.concatenate([inside, border])
        mine, frequency = ours(folder, size, body.node[compared])
        *found, other_frequency = theirs(folder / f"calculix-{size:g}", body, compared)
        for name, others in zip(("its own", "the same"), found):
            for k, (stress, other) in enumerate(zip(mine, others)):
                within, outside = differences(stress, other, len(inside))
                load, off = (
                    ("pressure at rest", "")
                    if k == 0
                    else (f"mode {k}", f"{frequency[k - 1] / other_frequency[k - 1] - 1:.1e}")
                )
                print(
                    f"| {size:g} | {load} | {off} | {name} | {100 * within:.2g} % | {100 * outside:.2g} % |"
                )
                if name == "the same" and max(within, outside) > SAME:
                    raise SolverError(
                        f"{load}: stresses by the same recovery differ by more than {100 * SAME:g} %"
                    )
    print()
