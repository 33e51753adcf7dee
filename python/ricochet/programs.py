# SPDX-License-Identifier: BSD-2-Clause
"""Runs Ricochet's programs, under mpirun where needed, and names the files and folders that they use."""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ricochet.errors import InputError, ProgramError

Word = str | Path
Answer = dict[str, Any]  # of ricochet-contact --batch: status, and summary or error

ROOT = Path(__file__).resolve().parents[2]  # of a checkout
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def folder_of_programs() -> Path:
    """$RICOCHET_BIN, the build of this checkout, or the folder of the installed programs."""
    named, built, installed = (
        os.environ.get("RICOCHET_BIN"),
        ROOT / "build" / "bin",
        shutil.which("ricochet-contact"),
    )
    if named or built.is_dir() or not installed:
        return Path(named or built)
    return Path(installed).parent


BIN = folder_of_programs()


# ---- Commands ----


def mpirun(ranks: int) -> list[Word]:
    """The words before a program that start it on `ranks` ranks. Errors appear once, from the program itself.

    $RICOCHET_LAUNCHER, such as "srun --mpi=pmix -n {ranks}", replaces mpirun.
    """
    if launcher := os.environ.get("RICOCHET_LAUNCHER"):
        try:
            return list(shlex.split(launcher.replace("{ranks}", str(ranks))))
        except ValueError as error:
            raise InputError(
                f"RICOCHET_LAUNCHER={launcher}: {error}. Give the words of a command and close all quotes."
            ) from None
    command: list[Word] = ["mpirun", "-q", "--oversubscribe", "-n", str(ranks)]
    return command + ["--allow-run-as-root"] * (os.geteuid() == 0)


def bound(command: Sequence[Word]) -> list[str]:
    """The command, to be ended with its parent process, even if that one is killed."""
    return ["setpriv", "--pdeathsig", "TERM", *map(str, command)]


def find(command: Sequence[Word]) -> None:
    """Raises InputError if the program, or its launcher, is missing."""
    if not BIN.is_dir():
        raise InputError(f"{BIN}: no programs there. Run scripts/build first.")
    for word in map(Path, map(str, command)):
        if word.parent == BIN and word.name.startswith("ricochet-") and not word.is_file():
            raise InputError(
                f"{word}: no such program. Run scripts/build first, "
                "or set RICOCHET_BIN to the folder of the programs."
            )
    if not shutil.which(str(command[0])):
        raise InputError(
            f"{command[0]}: no such program: install Open MPI (scripts/setup), "
            "or set RICOCHET_LAUNCHER to another launcher."
        )


def call(command: Sequence[Word], capture: bool = False, quiet: bool = False) -> str:
    """Runs a program to its end and returns its standard output if `capture` is set.

    With `quiet`, the reason of a failure is only in the ProgramError; otherwise the program reports it.
    """
    find(command)
    with subprocess.Popen(
        bound(command),
        env=os.environ | ONE_THREAD,
        text=True,
        errors="replace",
        stdout=subprocess.PIPE if capture else None,
        stderr=subprocess.PIPE if quiet else None,
    ) as process:
        try:
            out, err = process.communicate()
        except BaseException:  # interrupted: the ranks have to end too, and remove their temporary files
            process.terminate()
            raise
    if quiet and process.returncode in (1, 2):
        raise ProgramError(process.returncode, complaint(err))
    if err:
        print(err, end="", file=sys.stderr)
    if process.returncode != 0:
        killed = -process.returncode if process.returncode < 0 else process.returncode - 128
        if killed > 0:
            names = (Path(str(word)).name for word in command)
            program = next(name for name in names if name.startswith("ricochet-"))
            print(
                f"{program}: ended by signal {killed}: killed, or out of memory? "
                "The same command resumes the work.",
                file=sys.stderr,
            )
        raise ProgramError(exit_status(process.returncode))
    return out or ""


def exit_status(returncode: int) -> int:
    """Of a process that may have ended by a signal, as shells count it."""
    return returncode if returncode > 0 else 128 - returncode


def start(command: Sequence[Word]) -> "subprocess.Popen[str]":
    """Starts a program; `refusal` waits for its end."""
    find(command)
    return subprocess.Popen(
        bound(command),
        env=os.environ | ONE_THREAD,
        text=True,
        errors="replace",
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )


def refusal(process: "subprocess.Popen[str]") -> Answer | None:
    """Waits for a program; returns its error in the form of an answer of --batch, or None if it succeeded."""
    _, err = process.communicate()
    if process.returncode in (1, 2):
        return {"status": process.returncode, "error": complaint(err)}
    if process.returncode != 0:
        print(err, end="", file=sys.stderr)
        raise ProgramError(exit_status(process.returncode))
    return None


def complaint(err: str) -> str:
    """The line of standard error that gives the reason why a program failed."""
    lines = [line.strip() for line in err.splitlines() if line.strip()]
    own = [line.split(": ", 1)[1] for line in lines if re.match("ricochet-[a-z]+: ", line)]
    return (own or lines or ["it gave no reason"])[-1]


def version() -> str:
    return call([BIN / "ricochet-contact", "--version"], capture=True).split()[-1]


# ---- Scene keys as words ----


def with_set(settings: Iterable[str]) -> list[str]:
    """Words of a command that override scene keys; `settings`: KEY=VALUE each."""
    return [word for setting in settings for word in ("--set", setting)]


def toml(value: Any) -> str:
    if isinstance(value, dict):
        names = (key if re.fullmatch("[A-Za-z0-9_-]+", key) else toml(key) for key in value)
        return "{" + ",".join(f"{name}={toml(item)}" for name, item in zip(names, value.values())) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(toml, value)) + "]"
    if isinstance(value, float):
        return repr(value)  # TOML writes inf and nan in the same way
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def settings(changes: Mapping[str, Any]) -> list[str]:
    """KEY=VALUE, the form that --set takes, for Python values by key."""
    return [f"{key}={toml(value)}" for key, value in changes.items()]


# ---- The two programs ----


def kernel(scene: Word, arguments: Sequence[Word] = (), ranks: int = 2, quiet: bool = False) -> None:
    """Computes the kernels of a scene that do not exist yet."""
    call([*mpirun(ranks), BIN / "ricochet-kernel", scene, *arguments], quiet=quiet)


def contact(scene: Word, arguments: Sequence[Word] = ()) -> None:
    """Computes the impact of a scene."""
    call([BIN / "ricochet-contact", scene, *arguments])


def resolved(scene: Word, arguments: Sequence[Word] = (), program: str = "ricochet-contact") -> str:
    """The scene with overrides and defaults, as TOML."""
    return call([BIN / program, "--dry-run", scene, *arguments], capture=True)


def slug(title: str) -> str:
    """The start of the names of all files of a result, made from the scene's title."""
    return re.sub("[^a-z0-9]+", "-", title.lower()).strip("-") or "scene"


def slug_of(resolved_scene: str) -> str:
    return slug(tomllib.loads(resolved_scene)["title"])


def out_folder(scene: Word, out: Word | None = None) -> Path:
    """Where the programs put kernels and results."""
    return Path(out) if out else Path(scene).parent / "out"
