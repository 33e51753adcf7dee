# SPDX-License-Identifier: BSD-2-Clause
"""Flips single bits of kernels and results, and checks that each flip is refused in one line or changes nothing.

    scripts/verify --flips --count 1000 --seed 1

A flipped kernel is read by ricochet-contact, whose result must be that of the whole kernel, byte for byte. Of a flipped result, the
Python package reads all datasets and attributes. The status is 1 if a flip is silent, or is answered otherwise.
"""
import argparse
import collections
import os
import pathlib
import random
import shutil
import subprocess
import tempfile

import h5py

from ricochet import errors
from ricochet.result_file import File

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ["RICOCHET_BIN"])


def program(name, folder):
    """Status and lines of a program with the scene of `folder`."""
    words = [BIN / f"ricochet-{name}", folder / "two-rods.toml", "--out", folder / "out", "--quiet"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, done.stderr.splitlines()


def names_of(path):
    """Names of the datasets with the kinds of their values, and of the attributes with their objects."""
    datasets, attributes = {}, []

    def visit(name, item):
        attributes.extend((name, attribute) for attribute in item.attrs)
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


def add_arguments(parser: argparse.ArgumentParser):
    parser.add_argument(
        "--count", type=int, default=1000, help="flips, half of them in kernels (default: 1000)"
    )
    parser.add_argument("--seed", default="1", help="seed (default: 1)")


def run(options):
    with tempfile.TemporaryDirectory(prefix="ricochet-flips-") as name:
        folder = pathlib.Path(name)
        shutil.copytree(SOURCE / "meshes/two-rods", folder, dirs_exist_ok=True)
        for one in ("kernel", "contact"):
            assert program(one, folder)[0] == 0
        (kernel, *_), (result,) = (
            sorted((folder / "out").glob(f"*.{kind}.h5")) for kind in ("kernel", "result")
        )

        def by_contact():
            result.unlink(missing_ok=True)
            status, lines = program("contact", folder)
            if status == 0:
                return result.read_bytes()
            return "refused" if (status, len(lines)) == (2, 1) and not result.exists() else "otherwise"

        names = names_of(result)

        def by_package():
            try:
                return values_of(result, *names)
            except errors.InputError as refusal:
                return "refused" if "\n" not in str(refusal) else "otherwise"
            except Exception as other:  # the finding
                print(f"{type(other).__name__}: {other}")
                return "otherwise"

        found = {
            "kernel": answers(kernel, options.count // 2, options.seed, by_contact),
            "result": answers(result, options.count - options.count // 2, options.seed, by_package),
        }
    for kind, of_kind in found.items():
        print(f"{kind}: " + ", ".join(f"{n} {answer}" for answer, n in sorted(of_kind.items())))
    return int(any(of_kind["silent"] or of_kind["otherwise"] for of_kind in found.values()))
