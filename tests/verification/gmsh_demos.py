# SPDX-License-Identifier: BSD-2-Clause
"""Checks the geometries of gmsh's tutorials and demos with elements of order 2, as bodies of a scene.

    scripts/verify --geometries [--folder DIR] [--order P]

Needs the package gmsh-doc. A geometry passes if `ricochet-kernel --check` accepts it, or refuses it in one line for a
reason that the geometry has: it contains no volume or line, needs a file that is not there, or gmsh cannot mesh it. It
fails if the program crashes, takes longer than five minutes, or refuses curved elements that gmsh has made. Prints
Markdown. The status is 1 if a geometry fails.
"""
import gzip
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from ricochet import programs
from ricochet.errors import InputError

SCENE = """[bodies.body]
mesh = "{name}"
order = {order}
material = {{ density = 7800, young = 2e11, poisson = 0.3, area = 1e-4 }}
[modes]
count = 10
"""
REASONS = (
    "no volume",
    "holds no volume or line elements",
    "no such file",
    ": gmsh: ",
    '"Pyramid',
)


def add_arguments(parser):
    parser.add_argument(
        "--folder",
        type=Path,
        default=Path("/usr/share/doc/gmsh-doc"),
        help="folder of the .geo files (default: that of gmsh-doc)",
    )
    parser.add_argument("--order", type=int, default=2, help="order of the elements (default: 2)")


def unpacked(source, folder):
    """Copies the files into a folder, where compressed ones are expanded. Returns the .geo files."""
    shutil.copytree(source, folder, dirs_exist_ok=True)
    for packed in folder.rglob("*.gz"):
        packed.with_suffix("").write_bytes(gzip.decompress(packed.read_bytes()))
        packed.unlink()
    return sorted(folder.rglob("*.geo"))


def outcome(geo, order):
    """(whether it passes, what the program says)"""
    scene = geo.with_suffix(".ricochet.toml")
    scene.write_text(SCENE.format(name=geo.name, order=order))
    command = [programs.BIN / "ricochet-kernel", scene, "--check", "--quiet", "--out", geo.parent / "out"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=300)
    except subprocess.TimeoutExpired:
        return False, "takes longer than five minutes"
    said = done.stderr.strip()
    if done.returncode == 0:
        return True, said or "accepted"
    known = any(reason in said for reason in REASONS) and "inverted" not in said
    return done.returncode == 2 and said.count("\n") == 0 and known, said or f"status {done.returncode}"


def run(given):
    if not given.folder.is_dir():
        raise InputError(f"{given.folder}: no such folder: install gmsh-doc, or give --folder")
    failed = 0
    print("| geometry | passes | seconds | answer |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for geo in unpacked(given.folder, Path(folder) / "gmsh"):
            start = time.monotonic()
            passes, said = outcome(geo, given.order)
            failed += not passes
            seconds = time.monotonic() - start
            print(f"| {geo.name} | {'yes' if passes else 'NO'} | {seconds:.1f} | {said} |", flush=True)
    print(f"\nFailed: {failed}.")
    return failed > 0
