# SPDX-License-Identifier: BSD-2-Clause
"""Flips single bits of files, and checks that each flip is refused in one line or changes nothing.

    scripts/verify --flips --count 1000 --seed 1

A flipped kernel or table is read by ricochet-contact, whose result must be that of the whole file, byte for byte. Of a flipped
result, the Python package reads all datasets and attributes. With a flipped slice, or plan of slices, ricochet-kernel goes on where it
was killed, and its kernel must be that of an undisturbed run up to round-off. The status is 1 if a flip is silent, or is answered
otherwise.
"""
import argparse
import collections
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

import h5py

from kill_subjects import same_numbers, write_scenes
from ricochet import errors
from ricochet.result_file import File

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ["RICOCHET_BIN"])


def program(name, scene, out):
    """Status and lines of a program."""
    words = [BIN / f"ricochet-{name}", scene, "--out", out, "--quiet"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, done.stderr.splitlines()


#: of dimension scales; its values are in a heap without a checksum, and the package does not read it
UNREAD = "DIMENSION_LIST"


def names_of(path):
    """Names of the datasets with the kinds of their values, and of the attributes with their objects."""
    datasets, attributes = {}, []

    def visit(name, item):
        attributes.extend((name, attribute) for attribute in item.attrs if attribute != UNREAD)
        if isinstance(item, h5py.Dataset):
            datasets[name] = (item.dtype.kind, item.ndim)

    with h5py.File(path) as file:
        attributes.extend(("/", attribute) for attribute in file.attrs)
        file.visititems(visit)
    return datasets, attributes


def values_of(path, datasets, attributes):
    """All that a result holds, as the package reads it. Raises InputError."""
    file = File(path, "ricochet-result")
    try:
        values = [repr(file.attribute(*names)) for names in attributes]
        for name, (kind, dimensions) in datasets.items():
            read = file.texts(name) if kind == "S" else file.array(name, *[None] * dimensions).tobytes()
            values.append(read)
        return values
    finally:
        file.file.close()


def answers(path, count, seed, read):
    """How often flips of a file had each answer."""
    whole, good, found = path.read_bytes(), read(), collections.Counter()
    assert good not in ("refused", "otherwise")
    for number in range(count):
        draw = random.Random(f"{seed}.{number}")
        spoilt = bytearray(whole)
        at, bit = draw.randrange(len(whole)), draw.randrange(8)
        spoilt[at] ^= 1 << bit
        path.write_bytes(spoilt)
        answer = read()
        kind = answer if answer in ("refused", "otherwise") else "harmless" if answer == good else "silent"
        found[kind] += 1
        if kind in ("silent", "otherwise"):
            print(f"{path.name}: flip {seed}.{number}, bit {bit} of byte {at}: {kind}")
    path.write_bytes(whole)
    return found


def by_contact(scene, out):
    """The result of the impact of a scene."""
    for result in out.glob("*.result.h5"):
        result.unlink()
    status, lines = program("contact", scene, out)
    left = list(out.glob("*.result.h5"))
    if status == 0:
        return left[0].read_bytes()
    return "refused" if (status, len(lines)) == (2, 1) and not left else "otherwise"


def by_package(path, names):
    """All that a result holds."""
    try:
        return values_of(path, *names)
    except errors.InputError as refusal:
        return "refused" if "\n" not in str(refusal) else "otherwise"
    except Exception as other:  # the finding
        print(f"{type(other).__name__}: {other}")
        return "otherwise"


class Killed:
    """A run of ricochet-kernel that was killed after its first slices."""

    def __init__(self, folder):
        folder.mkdir()
        write_scenes(folder)
        self.scene, self.out = folder / "kills.toml", folder / "out"
        status, lines = program("kernel", self.scene, self.out)
        assert status == 0, lines
        (self.whole,) = self.out.glob("moving-*.kernel.h5")
        self.whole = self.whole.rename(folder / "whole.kernel.h5")
        self.slices = self.killed()

    def killed(self):
        words = [BIN / "ricochet-kernel", self.scene, "--out", self.out, "--quiet"]
        for _ in range(100):
            process = subprocess.Popen(words, stderr=subprocess.DEVNULL)
            while process.poll() is None and not list(self.out.glob("moving-*.slices/slice-*.h5")):
                time.sleep(0.001)
            process.kill()
            process.wait()
            for slices in self.out.glob("moving-*.slices"):
                return slices.rename(self.scene.parent / slices.name)
            for kernel in self.out.glob("moving-*.kernel.h5"):
                kernel.unlink()
        raise RuntimeError("no run of ricochet-kernel was killed while it had slices")

    def kernel(self):
        """What becomes of a run that goes on from the slices."""
        for old in self.out.glob("moving-*.kernel.h5"):
            old.unlink()
        shutil.copytree(self.slices, self.out / self.slices.name)
        status, lines = program("kernel", self.scene, self.out)
        if status:
            return "refused" if (status, len(lines)) == (2, 1) else "otherwise"
        (kernel,) = self.out.glob("moving-*.kernel.h5")
        return "whole" if same_numbers(kernel, self.whole) else "other"


def files_and_readers(folder):
    """For each kind of file: a file, its share of the flips, and its reader."""
    rods, table = folder / "rods", folder / "table"
    shutil.copytree(SOURCE / "meshes/two-rods", rods)
    scene, out = rods / "two-rods.toml", rods / "out"
    for one in ("kernel", "contact"):
        assert program(one, scene, out)[0] == 0
    kernel, result = sorted(out.glob("*.kernel.h5"))[0], next(out.glob("*.result.h5"))
    yield "kernel", kernel, 0.3, lambda: by_contact(scene, out)
    assert not isinstance(by_contact(scene, out), str)
    names = names_of(result)
    yield "result", result, 0.3, lambda: by_package(result, names)
    shutil.copytree(SOURCE / "meshes/two-rods-analytic", table)
    subprocess.run([sys.executable, table / "table.py"], check=True, capture_output=True)
    sampled = table / "out"
    yield "table", sampled / "rods.table.h5", 0.3, lambda: by_contact(
        table / "two-rods-analytic.toml", sampled
    )
    run = Killed(folder / "killed")
    yield "plan", run.slices / "plan.h5", 0.02, run.kernel
    yield "slice", next(run.slices.glob("slice-*.h5")), 0.08, run.kernel


def add_arguments(parser: argparse.ArgumentParser):
    parser.add_argument(
        "--count", type=int, default=1000, help="flips, three tenths in each kind of file (default: 1000)"
    )
    parser.add_argument(
        "--only", help="kind of file, which gets all flips: kernel, result, table, plan or slice"
    )
    parser.add_argument("--seed", default="1", help="seed (default: 1)")


def run(options):
    found = {}
    with tempfile.TemporaryDirectory(prefix="ricochet-flips-") as name:
        for kind, path, share, read in files_and_readers(pathlib.Path(name)):
            if options.only in (None, kind):
                count = options.count if options.only else round(share * options.count)
                found[kind] = of_kind = answers(path, count, options.seed, read)
                print(f"{kind}: " + ", ".join(f"{n} {answer}" for answer, n in sorted(of_kind.items())))
    return int(any(of_kind["silent"] or of_kind["otherwise"] for of_kind in found.values()))
