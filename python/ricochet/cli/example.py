# SPDX-License-Identifier: BSD-2-Clause
"""Copies a scene of the package with the kernels of its bodies, so that its impact runs at once and without ricochet-kernel.

    ricochet example                                     # lists the examples
    ricochet example bell
    ricochet run bell/bell.toml                          # force, sound, pictures and page
    ricochet export --web bell/bell.toml -o bell.html    # a page on which the bell is struck
"""
import argparse
import shutil
from pathlib import Path

from ricochet.errors import InputError

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", nargs="?", metavar="NAME", help="of the example (default: list all)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="new folder of the scene (default: NAME)")


def described(name: str) -> str:
    """What the example is, from the first line of its scene."""
    return (EXAMPLES / name / f"{name}.toml").read_text("utf-8").splitlines()[0].strip("# .")


def run(options: argparse.Namespace) -> None:
    names = sorted(path.parent.name for path in EXAMPLES.glob("*/*.toml"))
    if options.name is None:
        print("\n".join(f"{name}    {described(name)}" for name in names))
        return
    if options.name not in names:
        raise InputError(f"{options.name}: no such example: choose from {', '.join(names)}")
    folder = options.out or Path(options.name)
    try:
        shutil.copytree(EXAMPLES / options.name, folder)
    except FileExistsError:
        raise InputError(f"{folder}: is there already. Choose another folder with --out.") from None
    except (shutil.Error, OSError) as error:
        raise InputError(
            f"{folder}: cannot be written ({error}). Choose another folder with --out."
        ) from None
    print(folder / f"{options.name}.toml")
