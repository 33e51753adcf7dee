# SPDX-License-Identifier: BSD-2-Clause
"""Takes a scene from mesh to pictures: kernels, impact, figures, page. What is there and up to date is not done again.

    ricochet run meshes/two-disks/two-disks.toml
    ricochet run -n 4 meshes/two-disks/two-disks.toml --set title=fast --set 'bodies.upper.velocity=[0,-6,0]'

The options --set, --accuracy and --out are those of ricochet-kernel and ricochet-contact.
"""
import subprocess
import sys
import tomllib
from pathlib import Path

import h5py

from ricochet import programs
from ricochet.cli.command_line import Parser, ranks


def newer(target, *sources):
    """Whether `target` exists and none of the sources changed after it."""
    return target.exists() and all(source.stat().st_mtime <= target.stat().st_mtime for source in sources)


def current(result, scene):
    """Whether the result file is of this resolved scene, these kernels and this program, and all of its run is there."""
    if not result.exists() or not Path(str(result).removesuffix(".result.h5") + ".summary.json").exists():
        return False
    try:
        with h5py.File(result) as file:
            kernels = [result.parent / group.attrs["kernel"].decode() for group in file["bodies"].values()]
            same = file.attrs["scene"].decode() == scene
    except (OSError, KeyError, AttributeError, TypeError):  # not one that ricochet-contact wrote
        return False
    return same and newer(result, programs.BIN / "ricochet-contact", *kernels)


def main():
    parser = Parser(__doc__, "SCENE.toml")
    parser.add_argument("scene", type=Path, metavar="SCENE.toml")
    parser.add_argument("-n", "--ranks", type=ranks, default=2, help="ranks of ricochet-kernel (default: 2)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a scene key")
    parser.add_argument("--accuracy", metavar="X", help="relative error that the main results may have")
    parser.add_argument("--out", type=Path, help="folder of kernels, results and pictures (default: out/ beside the scene)")
    options = parser.parse_args()
    arguments = [a for setting in options.set for a in ("--set", setting)]
    arguments += ["--accuracy", options.accuracy] if options.accuracy else []
    arguments += ["--out", options.out] if options.out else []
    out = programs.out_folder(options.scene, options.out)
    try:
        scene = programs.resolved(options.scene, arguments)
        slug = programs.slug(scene)
        programs.kernel(options.scene, arguments, options.ranks)
        result = out / f"{slug}.result.h5"
        if current(result, scene):
            print(f"{result}: up to date")
        else:
            programs.contact(options.scene, arguments)
    except programs.Failed as failure:
        return failure.status
    drawn = [("report", f"{slug}.report.html")]
    if tomllib.loads(scene)["contact"]["scheme"] != "static":  # bodies at rest have no history to draw
        drawn.insert(0, ("plot", f"{slug}-energy.png"))
    for name, last in drawn:
        if newer(out / last, result, Path(__file__)):
            print(f"{out / last}: up to date")
        elif status := subprocess.run([sys.executable, "-P", "-m", "ricochet", name, result]).returncode:
            return status
    return 0
