# SPDX-License-Identifier: BSD-2-Clause
"""The contact laws side by side: the results of each scheme from the same kernels of one scene.

    scripts/verify --readings meshes/two-rods/two-rods.toml
    scripts/verify --readings meshes/two-disks/two-disks.toml --set 'bodies.upper.velocity=[0,-6,0]'

Prints a Markdown table. Missing kernels are computed first.
"""
import json
import tempfile
from pathlib import Path

import h5py
import numpy as np

from ricochet import programs

READINGS = {
    "compliant": ["contact.scheme=compliant"],
    "impulse, jump": ["contact.scheme=impulse", "contact.admittance=jump"],
    "impulse, difference": ["contact.scheme=impulse", "contact.admittance=difference"],
}


def mean_force(path):
    """Mean force [N] over the middle eight tenths of the time between first and last touch."""
    with h5py.File(path) as file:
        time, force = file["contact/time"][:], file["contact/force"][:].sum(axis=1)
    if len(time) == 0:
        return 0.0
    span = time[-1] - time[0]
    inside = (time > time[0] + 0.1 * span) & (time < time[-1] - 0.1 * span)
    # Steps without a force have no row and count as zeros.
    step = np.diff(time).min() if len(time) > 1 else 1.0
    return float(force[inside].sum() * step / (0.8 * span)) if span > 0 else float(force.mean())


def row(name, s, force):
    def show(value, text):
        return "–" if value is None else text.format(value)

    exits = ", ".join(f"{body} {np.linalg.norm(v):.4g}" for body, v in s["exit_velocity"].items()) or "–"
    cells = [
        name,
        show(s["contact_start_s"], "{:.5g}"),
        show(s["contact_end_s"], "{:.5g}"),
        f"{s['max_active']}",
        f"{s['peak_force_n']:.4g}",
        f"{force:.4g}",
        f"{s['impulse_ns']:.5g}",
        exits,
        show(s["restitution"], "{:.4g}"),
        f"{100 * s['energy_lost_contact']:.3g}",
        f"{s['max_penetration_m']:.2g}",
        f"{len(s['episodes'])}",
    ]
    return "| " + " | ".join(cells) + " |"


HEAD = [
    "reading",
    "start (s)",
    "end (s)",
    "touching at most",
    "peak force (N)",
    "mean force (N)",
    "impulse (N s)",
    "exit speed (m/s)",
    "restitution",
    "energy to contact (%)",
    "penetration (m)",
    "episodes",
]


def add_arguments(parser):
    parser.add_argument("scene", type=Path, metavar="SCENE.toml")
    parser.add_argument("-n", "--ranks", type=int, default=2, help="ranks of ricochet-kernel (default: 2)")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="override a scene key"
    )
    parser.add_argument("--out", type=Path, help="folder of the kernels (default: out/ beside the scene)")


def run(options):
    common = programs.with_set(options.set)
    out = programs.out_folder(options.scene, options.out)
    programs.kernel(options.scene, [*common, "--quiet", "--out", out], options.ranks)
    print("| " + " | ".join(HEAD) + " |\n" + "|---" * len(HEAD) + "|")
    with tempfile.TemporaryDirectory(prefix="ricochet-readings-") as scratch:
        # Results go to a separate folder, in which links lead to the kernels.
        for path in out.glob("*.kernel.h5"):
            (Path(scratch) / path.name).symlink_to(path.resolve())
        for name, sets in READINGS.items():
            arguments = [*common, *programs.with_set([*sets, "title=reading"])]
            programs.contact(options.scene, ["--quiet", "--out", scratch, *arguments])
            found = json.loads((Path(scratch) / "reading.summary.json").read_text())
            print(row(name, found, mean_force(Path(scratch) / "reading.result.h5")), flush=True)
    return 0
