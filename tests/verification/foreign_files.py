# SPDX-License-Identifier: BSD-2-Clause
"""Checks drawings and meshes of other programs, and damaged ones, as bodies of a scene.

    scripts/verify --foreign [--folder DIR …] [--seed S] [--only TEXT] [--order P] [--out DIR]

The files are those of the given folders (default: gmsh's tutorials and demos of the package gmsh-doc, and the data of
occt-misc), a box that python3-meshio and gmsh write in each of their formats, with elements of order 1 and 2, and 50 of
gmsh's scripts, of which a line was lost, repeated, moved or cut, or a number replaced. What a script or drawing includes is
beside it.

A file passes if `ricochet-kernel --check` accepts it, after `ricochet import mesh` if the program advises that, or if either refuses it
in one line, beside warnings, with exit status 2. It fails if a program crashes, hangs, prints more, or calls elements inverted
that gmsh has made from a drawing.

Answers are kept in DIR (default out/foreign), and files that have one are not checked again: after an interruption, the
same command goes on. Remove DIR after a change of the programs. Prints Markdown: the failures, then a table by kind of file.
The status is 1 if a file fails.
"""
import collections
import contextlib
import gzip
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from random_bodies import ended
from ricochet import programs
from ricochet.errors import InputError
from ricochet.programs import ROOT
from ricochet.progress import Progress
from ricochet.studies.records import Store

SCENE = """[bodies.body]
mesh = "{name}"
order = {order}
material = {{ density = 7800, young = 2e11, poisson = 0.3, area = 1e-4 }}
[modes]
count = 10
"""
ADVICE = "run ricochet import mesh"
FOLDERS = Path("/usr/share/doc/gmsh-doc"), Path("/usr/share/opencascade/data")
DRAWINGS = {".geo", ".step", ".stp", ".brep", ".iges", ".igs"}
MESHES = set(
    ".msh .stl .unv .mesh .bdf .nas .vtk .vtu .inp .med .cgns .xml .xdmf .e .f3grid .avs .su2 .node .ele .vol .obj .off "
    ".ply .diff .p3d .pos .dat .key .rad .ir3 .celum .x3d .wrl .h5m .post .ugrid .tec".split()
)
BROKEN = 50
DEADLINE_S = 300
# Of one file; the program ends gmsh before this deadline.
LIMIT = {"RICOCHET_MESH_SECONDS": "120"}

BOX = """SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Physical Volume("box") = {1};
Mesh.MeshSizeMax = 0.5;
"""


def unpacked(source, folder):
    """Copies a tree, in which compressed files are expanded."""
    shutil.copytree(source, folder, dirs_exist_ok=True)
    for packed in folder.rglob("*.gz"):
        with contextlib.suppress(gzip.BadGzipFile):
            packed.with_suffix("").write_bytes(gzip.decompress(packed.read_bytes()))
            packed.unlink()


def write_boxes(folder):
    """The mesh of a box of order 1 and 2, in all formats of gmsh and meshio. A format that a writer does not manage is left
    out: each is written by a process of its own, which may crash."""
    (folder / "box.geo").write_text(BOX)
    by_gmsh = (
        "import gmsh, sys; gmsh.initialize(); gmsh.option.setNumber('General.Terminal', 0); gmsh.open(sys.argv[1]);"
        "gmsh.option.setNumber('Mesh.ElementOrder', int(sys.argv[2])); gmsh.model.mesh.generate(3);"
        "[gmsh.write(name) for name in sys.argv[3:]]"
    )
    by_meshio = "import meshio, sys; meshio.write(sys.argv[3], meshio.read(sys.argv[1]), sys.argv[2])"

    def write(*command, names):
        done = subprocess.run(
            [sys.executable, "-c", *map(str, command), *names],
            cwd=folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for name in names if done.returncode != 0 else ():
            (folder / name).unlink(missing_ok=True)  # incomplete

    listed = subprocess.run(
        [
            sys.executable,
            "-c",
            "import meshio\nfor ending, names in meshio.extension_to_filetypes.items(): print(ending, *names)",
        ],
        capture_output=True,
        text=True,
    )
    if listed.returncode != 0:
        raise InputError("python3-meshio is missing, which writes meshes of other programs: install it")
    formats = [line.split() for line in listed.stdout.splitlines()]
    for order in 1, 2:
        write(by_gmsh, "box.geo", order, names=[f"box{order}.msh"])
        for ending in sorted(MESHES - {".msh"}):
            write(by_gmsh, "box.geo", order, names=[f"gmsh{order}{ending}"])
        for ending, *names in formats:
            for name in names:
                write(by_meshio, f"box{order}.msh", name, names=[f"meshio-{name}-{order}{ending}"])
    for path in folder.iterdir():
        if path.is_file() and not path.stat().st_size:
            path.unlink()


def broken(text, random):
    """A script with one mistake."""
    lines = text.splitlines()
    at, other = (int(n) for n in random.integers(len(lines), size=2))
    numbers = [match.span() for match in re.finditer(r"\b\d+(\.\d*)?\b", text)]
    mistake = random.integers(6)
    if mistake >= 4 and numbers:
        start, end = numbers[random.integers(len(numbers))]
        return text[:start] + str(random.choice(["0", "-1", "1e300", "7", "1e-9", "nan"])) + text[end:]
    if mistake == 0:
        lines.pop(at)
    elif mistake == 1:
        lines.insert(at, lines[other])
    elif mistake == 2:
        lines[at], lines[other] = lines[other], lines[at]
    else:
        lines[at] = lines[at][: random.integers(len(lines[at]) + 1)]
    return "\n".join(lines) + "\n"


def write_broken(folder, seed):
    """Damages scripts of gmsh, each beside the files that it includes."""
    scripts = sorted(folder.rglob("*.geo"))
    for number in range(BROKEN if scripts else 0):
        random = np.random.default_rng([seed, number])
        source = scripts[random.integers(len(scripts))]
        text = broken(source.read_text(errors="replace"), random)
        source.with_name(f"broken-{seed}-{number}.geo").write_text(text)


def outcome(file, order, scratch):
    """(whether it passes, what the program says)"""
    scene = file.with_name(f"{file.name}.ricochet.toml")
    scene.write_text(SCENE.format(name=file.name, order=order))
    command = [programs.BIN / "ricochet-kernel", scene, "--check", "--quiet", "--out", scratch]
    status, said = ended(command, DEADLINE_S, env=os.environ | LIMIT)
    if status == 2 and f"{ADVICE} {file}" in said:
        mesh = file.with_name(f"{file.name}.msh")
        words = [programs.BIN / "ricochet", "import", "mesh", file, "--out", mesh, "--scene", f"{mesh}.toml"]
        status, said = ended(words, DEADLINE_S)
        if status == 0:
            scene.write_text(SCENE.format(name=mesh.name, order=order))
            status, said = ended(command, DEADLINE_S, env=os.environ | LIMIT)
    if status == 0:
        return True, said or "accepted"
    wrong = file.suffix in DRAWINGS and "inverted" in said
    lines = [line for line in said.splitlines() if "warning: " not in line]
    passes = status == 2 and len(lines) == 1 and not wrong
    return passes, said if passes else f"status {status}: {said}"


def collected(given, folder):
    """The files to check, as paths below a new folder."""
    for number, source in enumerate(given.folder):
        if not source.is_dir():
            raise InputError(f"{source}: no such folder: install gmsh-doc and occt-misc, or give --folder")
        unpacked(source, folder / f"{number}-{source.name}")
    write_broken(folder, given.seed)
    boxes = folder / "boxes"
    boxes.mkdir()
    write_boxes(boxes)
    files = (path for path in folder.rglob("*") if path.is_file())
    return sorted(path for path in files if path.suffix.lower() in DRAWINGS | MESHES)


def add_arguments(parser):
    parser.add_argument(
        "--folder", type=Path, nargs="+", default=FOLDERS, help="folders of files (default: above)"
    )
    parser.add_argument("--order", type=int, default=2, help="order of the elements of drawings (default: 2)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the damaged scripts (default: 1)")
    parser.add_argument("--only", default="", metavar="TEXT", help="files whose path contains this")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "foreign", help="(default: out/foreign)")


def run(given):
    store = Store(given.out / f"order-{given.order}.jsonl")
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = [path for path in collected(given, folder) if given.only in str(path.relative_to(folder))]
        progress = Progress(len(files))
        for file in files:
            short = str(file.relative_to(folder))
            digest = hashlib.sha256(file.read_bytes()).hexdigest()[:16]
            row = store.rows.get(f"{short} {digest}")
            already = row is not None
            if not already:
                start = time.monotonic()
                passes, said = outcome(file, given.order, folder / "out")
                row = {"key": f"{short} {digest}", "passes": passes, "said": said.replace(name, "")}
                row = store.add(row | {"seconds": time.monotonic() - start})
            rows.append((short, row))
            progress.advance(short, already=already)
    print("| file | seconds | answer |\n|---|---|---|")
    kinds = collections.defaultdict(lambda: [0, 0, 0, 0.0])
    for short, row in rows:
        kind = kinds[Path(short).suffix.lower()]
        accepted = row["passes"] and (row["said"] == "accepted" or "warning" in row["said"])
        kind[0 if accepted else 1 if row["passes"] else 2] += 1
        kind[3] = max(kind[3], row["seconds"])
        if not row["passes"]:
            said = row["said"].replace("\n", " / ").replace("|", "\\|")
            print(f"| {short} | {row['seconds']:.1f} | {said[:300]} |")
    print("\n| kind | accepted | refused in one line | failed | slowest [s] |\n|---|---|---|---|---|")
    for kind, (accepted, refused, failed, slowest) in sorted(kinds.items()):
        print(f"| {kind} | {accepted} | {refused} | {failed} | {slowest:.1f} |")
    failed = sum(not row["passes"] for _, row in rows)
    print(f"\nFailed: {failed} of {len(rows)}.")
    return failed > 0
