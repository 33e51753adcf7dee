# SPDX-License-Identifier: BSD-2-Clause
"""Runs Ricochet's programs, under mpirun if necessary, and determines the names of their files and
folders."""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn, cast

from ricochet.errors import InputError, RicochetError, failure

Word = str | Path
Answer = dict[str, Any]  # an answer of ricochet-contact --batch: status, and summary or error
Show = Callable[[str], object]

ROOT = Path(__file__).resolve().parents[2]  # the checkout
WHEEL = Path(__file__).resolve().with_name("bin")  # programs in the package, which only wheels have
OWN = re.compile(r"\s*ricochet-[a-z]+: ")  # starts an error of a program
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def folder_of_programs() -> Path:
    """The folder $RICOCHET_BIN, that of the build of this checkout, that of the wheel, or that of the installed
    programs."""
    named, built = os.environ.get("RICOCHET_BIN"), ROOT / "build" / "bin"
    if named or built.is_dir():
        return Path(named or built)
    if WHEEL.is_dir():
        return WHEEL
    installed = shutil.which("ricochet-contact")
    return Path(installed).parent if installed else built


BIN = folder_of_programs()


# ---- Commands ----


def mpirun(ranks: int) -> list[Word]:
    """The words that start a program on `ranks` ranks, to be placed in front of it. Errors are printed once,
    by the program itself.

    $RICOCHET_LAUNCHER, such as "srun --mpi=pmix -n {ranks}", replaces mpirun.
    """
    launcher = os.environ.get("RICOCHET_LAUNCHER") or "mpirun -q --oversubscribe --bind-to none -n {ranks}"
    try:
        command: list[Word] = list(shlex.split(launcher.replace("{ranks}", str(ranks))))
    except ValueError as error:
        raise InputError(
            f"RICOCHET_LAUNCHER={launcher}: {error}. Give the words of a command and close all quotes."
        ) from None
    if command[:1] == ["mpirun"] and os.geteuid() == 0:
        command.insert(1, "--allow-run-as-root")
    return command


def bound(command: Sequence[Word]) -> list[str]:
    """Extends the command so that it ends with its parent process, even if the parent is killed."""
    return ["setpriv", "--pdeathsig", "TERM", *map(str, command)]


def find(command: Sequence[Word]) -> None:
    """Raises InputError if the program or its launcher is missing."""
    named = os.environ.get("RICOCHET_BIN")
    advice = (
        f"RICOCHET_BIN={named} must be the folder of the programs" if named else "run scripts/build first"
    )
    if BIN == WHEEL:
        advice = (
            "pip does not install it. Install the Debian package ricochet, or copy kernels from elsewhere"
        )
    if not BIN.is_dir():
        raise InputError(f"{BIN}: no such folder of programs: {advice}")
    for word in map(Path, map(str, command)):
        if word.parent == BIN and word.name.startswith("ricochet-") and not word.is_file():
            raise InputError(f"{word}: no such program: {advice}")
    if not shutil.which("setpriv"):
        raise InputError("setpriv: no such program: add the folder of util-linux, /usr/bin, to PATH")
    if not shutil.which(str(command[0])):
        raise InputError(
            f"{command[0]}: no such program: install Open MPI (scripts/setup), "
            "or set RICOCHET_LAUNCHER to another launcher."
        )


def start(command: Sequence[Word], capture: bool = False, quiet: bool = True) -> "subprocess.Popen[str]":
    """Starts a program. `wait` waits for its end.

    @param capture  keep its standard output for `wait`
    @param quiet    print none of its output
    """
    find(command)
    output = subprocess.PIPE if capture else subprocess.DEVNULL if quiet else None
    errors = subprocess.PIPE if quiet else None
    return subprocess.Popen(
        bound(command), env=os.environ | ONE_THREAD, text=True, errors="replace", stdout=output, stderr=errors
    )


def wait(process: "subprocess.Popen[str]", show: Show | None = None) -> str:
    """Waits for the end of a program and returns the standard output that `start` kept.

    `show` is called with each line that a quiet program writes to standard error. Raises InputError if the
    program refuses its input, and SolverError if it fails otherwise. A program that is not quiet has already
    reported the reason.
    """
    lines = []
    with process:
        try:
            for line in process.stderr or ():
                lines.append(line)
                if show:
                    show(line)
            out, _ = process.communicate()
        except BaseException:  # interrupted: the ranks must end too, and remove their temporary files
            process.terminate()
            raise
    status = process.returncode
    if status == 0:
        return out or ""
    if (signal := -status if status < 0 else status - 128) > 0:
        words = map(Path, cast(list[str], process.args))
        program = next(word.name for word in words if word.name.startswith("ricochet-"))
        text = f"{program}: ended by signal {signal}: killed, or out of memory? Repeat it to resume the work."
        raise failure(128 + signal, text)
    raise failure(status, complaint("".join(lines)) if process.stderr else "")


def call(command: Sequence[Word], capture: bool = False) -> str:
    """Runs a program to its end. Returns its standard output if `capture` is set."""
    return wait(start(command, capture, quiet=False))


def replace_this_process(command: Sequence[Word]) -> NoReturn:
    """Replaces this process by the program."""
    find(command)
    os.environ.update(ONE_THREAD)
    os.execvp(command[0], [str(word) for word in command])


def refusal(process: "subprocess.Popen[str]", show: Show | None = None) -> Answer | None:
    """Waits for the end of a quiet program. Returns its error in the form of an answer of --batch, or None if
    it succeeded. An error that the program itself did not report has "died": mpirun ends with status 1 if a
    signal ends it. `show` is called with each line that it writes to standard error."""
    lines: list[str] = []

    def take(line: str) -> None:
        lines.append(line)
        if show:
            show(line)

    try:
        wait(process, take)
    except RicochetError as error:
        if error.status not in (1, 2):
            raise
        answer = {"status": error.status, "error": str(error)}
        return answer if any(map(OWN.match, lines)) else answer | {"died": True}
    return None


def complaint(err: str) -> str:
    """The line of standard error that contains the reason for a failure."""
    lines = [line.strip() for line in err.splitlines() if line.strip()]
    own = [line.split(": ", 1)[1] for line in lines if OWN.match(line)]
    return (own or lines or ["it gave no reason"])[-1]


def main() -> int:
    """Replaces this process by the program of its name: the entry point of ricochet-contact and ricochet-recast in
    wheels. Returns 2 if the program is missing."""
    name = Path(sys.argv[0]).name
    try:
        replace_this_process([BIN / name, *sys.argv[1:]])
    except RicochetError as problem:
        return problem.report(name)


def version() -> str:
    return call([BIN / "ricochet-contact", "--version"], capture=True).split()[-1]


# ---- Scene keys as words ----


def with_set(settings: Iterable[str], out: Word | None = None) -> list[Word]:
    """Command-line arguments that override scene keys, each as KEY=VALUE, and name the folder of kernels and
    results."""
    words: list[Word] = [word for setting in settings for word in ("--set", setting)]
    return words + (["--out", out] if out else [])


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
    """Converts Python values, by key, to the form KEY=VALUE of --set."""
    return [f"{key}={toml(value)}" for key, value in changes.items()]


def changes(words: Iterable[str]) -> dict[str, Any]:
    """Python values, by key, of settings KEY=VALUE: a value is TOML, or a text without quotes."""
    found: dict[str, Any] = {}
    for key, _, value in (word.partition("=") for word in words):
        try:
            found[key] = tomllib.loads(f"value = {value}")["value"]
        except tomllib.TOMLDecodeError:
            found[key] = value
    return found


# ---- The two programs ----


def kernel_program() -> Path:
    """ricochet-kernel, which a wheel does not have: then that on the path, if there is one."""
    elsewhere = shutil.which("ricochet-kernel") if BIN == WHEEL else None
    return Path(elsewhere) if elsewhere else BIN / "ricochet-kernel"


def kernel_command(scene: Word, arguments: Sequence[Word], ranks: int) -> list[Word]:
    return [*mpirun(ranks), kernel_program(), scene, *arguments]


def kernel(scene: Word, arguments: Sequence[Word], ranks: int) -> None:
    """Computes the missing kernels of a scene."""
    call(kernel_command(scene, arguments, ranks))


def contact(scene: Word, arguments: Sequence[Word]) -> None:
    """Computes the impact of a scene."""
    call([BIN / "ricochet-contact", scene, *arguments])


def resolved(scene: Word, arguments: Sequence[Word], program: Path = BIN / "ricochet-contact") -> str:
    """The scene with overrides and defaults, as TOML."""
    return call([program, "--dry-run", scene, *arguments], capture=True)


def slug(title: str) -> str:
    """The start of all file names of a result, derived from the title of the scene."""
    from ricochet import _core  # only here, as most commands need no library

    return _core.slug(title)


def out_folder(scene: Word, out: Word | None = None) -> Path:
    """The folder in which the programs put kernels and results."""
    return Path(out) if out else Path(scene).parent / "out"
