"""Runs Ricochet's programs from scripts: under mpirun where it is due, with the folders and names that they use."""

import json
import os
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import titles

ROOT = Path(__file__).resolve().parents[2]


def folder_of_programs():
    """$RICOCHET_BIN, what scripts/build made beside these scripts, or what is installed."""
    built, installed = ROOT / "build" / "bin", shutil.which("ricochet-contact")
    if "RICOCHET_BIN" in os.environ or built.is_dir() or not installed:
        return Path(os.environ.get("RICOCHET_BIN", built))
    return Path(installed).parent


BIN = folder_of_programs()


class Failed(Exception):
    """A program that ended with `status`; it has said why."""

    def __init__(self, status):
        super().__init__(f"status {status}")
        self.status = status


def mpirun(ranks):
    """The start of a command on `ranks` ranks, one thread each; quiet: what goes wrong is said once, by the program. $RICOCHET_LAUNCHER, such as "srun --mpi=pmix -n {ranks}",
    takes the place of mpirun, which lets root in only when told to."""
    if launcher := os.environ.get("RICOCHET_LAUNCHER"):
        return shlex.split(launcher.replace("{ranks}", str(ranks)))
    command = ["mpirun", "-q", "--oversubscribe", "-n", str(ranks)]
    return command + ["--allow-run-as-root"] * (os.geteuid() == 0)


def bound(command):
    """The command of a process that is told to end when its parent dies, even by SIGKILL."""
    return ["setpriv", "--pdeathsig", "TERM", *map(str, command)]


def call(command, capture=False):
    """Runs a program to its end."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    if not BIN.is_dir():
        print(f"{BIN}: no programs there. Run scripts/build first.", file=sys.stderr)
        raise Failed(2)
    with subprocess.Popen(bound(command), env=environment, text=True, stdout=subprocess.PIPE if capture else None) as process:
        try:
            out, _ = process.communicate()
        except BaseException:  # interrupted: its ranks, too, are to end, with their temporary files gone
            process.terminate()
            raise
    if process.returncode != 0:
        killed = -process.returncode if process.returncode < 0 else process.returncode - 128
        if killed > 0:
            program = next(Path(word).name for word in map(str, command) if Path(word).name.startswith("ricochet-"))
            print(f"{program}: ended by signal {killed}. Was it killed, or did memory run out? The same command goes on.", file=sys.stderr)
        raise Failed(process.returncode if process.returncode > 0 else 128 - process.returncode)
    return out


def version():
    return call([BIN / "ricochet-contact", "--version"], capture=True).split()[-1]


def with_set(settings):
    """As words of a command."""
    return [word for setting in settings for word in ("--set", setting)]


def toml(value):
    if isinstance(value, dict):
        return "{" + ",".join(f"{key}={toml(item)}" for key, item in value.items()) + "}"
    return json.dumps(value)


def settings(changes):
    """KEY=VALUE, as --set takes it, of Python values by key."""
    return [f"{key}={toml(value)}" for key, value in changes.items()]


def kernel(scene, arguments=(), ranks=2):
    """Computes the kernels that are not there yet."""
    call(mpirun(ranks) + [BIN / "ricochet-kernel", scene, *arguments])


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
