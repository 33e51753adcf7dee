# SPDX-License-Identifier: BSD-2-Clause
"""Runs Ricochet's programs from scripts: under mpirun where it is due, with the folders and names that they use."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

from ricochet import titles

ROOT = Path(__file__).resolve().parents[2]
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def folder_of_programs():
    """$RICOCHET_BIN, what scripts/build made beside these scripts, or what is installed."""
    named, built, installed = os.environ.get("RICOCHET_BIN"), ROOT / "build" / "bin", shutil.which("ricochet-contact")
    if named or built.is_dir() or not installed:
        return Path(named or built)
    return Path(installed).parent


BIN = folder_of_programs()


class Failed(Exception):
    """A program that ended with `status`; it has said why, or `error` does."""

    def __init__(self, status, error=""):
        super().__init__(f"status {status}")
        self.status, self.error = status, error


def refuse(text):
    print(text, file=sys.stderr)
    raise Failed(2)


def mpirun(ranks):
    """The start of a command on `ranks` ranks, one thread each; quiet: what goes wrong is said once, by the program. $RICOCHET_LAUNCHER, such as "srun --mpi=pmix -n {ranks}",
    takes the place of mpirun, which lets root in only when told to."""
    if launcher := os.environ.get("RICOCHET_LAUNCHER"):
        try:
            return shlex.split(launcher.replace("{ranks}", str(ranks)))
        except ValueError as error:
            refuse(f"RICOCHET_LAUNCHER={launcher}: {error}. Give a command's words, quotes closed.")
    command = ["mpirun", "-q", "--oversubscribe", "-n", str(ranks)]
    return command + ["--allow-run-as-root"] * (os.geteuid() == 0)


def bound(command):
    """The command of a process that is told to end when its parent dies, even by SIGKILL."""
    return ["setpriv", "--pdeathsig", "TERM", *map(str, command)]


def find(command):
    """Refuses a command whose program, or launcher, is not there."""
    if not BIN.is_dir():
        refuse(f"{BIN}: no programs there. Run scripts/build first.")
    for word in map(Path, map(str, command)):
        if word.parent == BIN and word.name.startswith("ricochet-") and not word.is_file():
            refuse(f"{word}: no such program. Run scripts/build first, or let RICOCHET_BIN name the folder of the programs.")
    if not shutil.which(str(command[0])):
        refuse(f"{command[0]}: no such program: install Open MPI (scripts/setup), or let RICOCHET_LAUNCHER name another launcher.")


def call(command, capture=False, quiet=False):
    """Runs a program to its end. @param quiet  of a refusal, or a computation that broke down, only Failed.error tells"""
    find(command)
    with subprocess.Popen(bound(command), env=os.environ | ONE_THREAD, text=True, errors="replace", stdout=subprocess.PIPE if capture else None,
                          stderr=subprocess.PIPE if quiet else None) as process:
        try:
            out, err = process.communicate()
        except BaseException:  # interrupted: its ranks, too, are to end, with their temporary files gone
            process.terminate()
            raise
    if quiet and process.returncode in (1, 2):
        raise Failed(process.returncode, complaint(err))
    if err:
        print(err, end="", file=sys.stderr)
    if process.returncode != 0:
        killed = -process.returncode if process.returncode < 0 else process.returncode - 128
        if killed > 0:
            program = next(Path(word).name for word in map(str, command) if Path(word).name.startswith("ricochet-"))
            print(f"{program}: ended by signal {killed}. Was it killed, or did memory run out? The same command goes on.", file=sys.stderr)
        raise Failed(process.returncode if process.returncode > 0 else 128 - process.returncode)
    return out


def start(command):
    """A program whose end `refusal` waits for."""
    find(command)
    return subprocess.Popen(bound(command), env=os.environ | ONE_THREAD, text=True, errors="replace", stdout=subprocess.DEVNULL,
                            stderr=subprocess.PIPE)


def refusal(process):
    """What a program that has been started was refused or broke down with, as an answer of --batch; None of success."""
    _, err = process.communicate()
    if process.returncode in (1, 2):
        return {"status": process.returncode, "error": complaint(err)}
    if process.returncode != 0:
        print(err, end="", file=sys.stderr)
        raise Failed(process.returncode if process.returncode > 0 else 128 - process.returncode)
    return None


def complaint(err):
    """The line of standard error that says why a program ended."""
    lines = [line.strip() for line in err.splitlines() if line.strip()]
    own = [line.split(": ", 1)[1] for line in lines if re.match("ricochet-[a-z]+: ", line)]
    return (own or lines or ["it did not say why"])[-1]


def version():
    return call([BIN / "ricochet-contact", "--version"], capture=True).split()[-1]


def with_set(settings):
    """As words of a command."""
    return [word for setting in settings for word in ("--set", setting)]


def toml(value):
    if isinstance(value, dict):
        return "{" + ",".join(f"{key if re.fullmatch('[A-Za-z0-9_-]+', key) else toml(key)}={toml(item)}"
                              for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(toml, value)) + "]"
    if isinstance(value, float):
        return repr(value)  # inf and nan, too, are as TOML has them
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def settings(changes):
    """KEY=VALUE, as --set takes it, of Python values by key."""
    return [f"{key}={toml(value)}" for key, value in changes.items()]


def kernel(scene, arguments=(), ranks=2, quiet=False):
    """Computes the kernels that are not there yet."""
    call(mpirun(ranks) + [BIN / "ricochet-kernel", scene, *arguments], quiet=quiet)


def contact(scene, arguments=()):
    call([BIN / "ricochet-contact", scene, *arguments])


def resolved(scene, arguments=()):
    """The scene with overrides and defaults, as TOML."""
    return call([BIN / "ricochet-contact", "--dry-run", scene, *arguments], capture=True)


def slug(resolved_scene):
    """What the names of the scene's results begin with."""
    return titles.slug(tomllib.loads(resolved_scene)["title"])


def out_folder(scene, out=None):
    return Path(out) if out else Path(scene).parent / "out"
