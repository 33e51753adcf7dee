# SPDX-License-Identifier: BSD-2-Clause
"""Runs a Markdown page, block by block, in a folder with the layout of this repository.

Visible blocks:

    ```sh                 commands; the folder and variables persist in the next block
    ```python             run by this Python; names persist
    ```text               lines that the output of the previous block must contain in this order; … matches anything
    ```toml path/to/file  the contents of that file

Comments, which are not shown:

    <!-- run: COMMANDS -->      commands that always run
    <!-- quick: COMMANDS -->    commands for quick runs only, which make the example coarser; numbers in outputs are
                                then not compared
    <!-- not run: WHY -->       skips the next block
    <!-- needs: MODULES -->     skips the next block where one of these modules of Python is not installed
"""

import contextlib
import importlib.util
import io
import os
import pathlib
import re
import shutil
import subprocess
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TOLERANCE = 0.02  # of numbers, because meshes differ slightly between versions of gmsh
BLOCK = re.compile(
    r"^```(?P<language>\w+)(?: (?P<info>[^\n]*))?\n(?P<text>.*?)^```$|"
    r"^<!-- (?P<kind>run|quick|not run|needs): ?(?P<command>.*?)-->",
    re.MULTILINE | re.DOTALL,
)
NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


class Failed(Exception):
    """The page does not behave as it describes. The text states the place."""


def blocks(page):
    """(line, kind, info, text) of the blocks and comments of a page, in order."""
    text = page.read_text()
    for found in BLOCK.finditer(text):
        line = text.count("\n", 0, found.start()) + 1
        if found["language"]:
            yield line, found["language"], found["info"] or "", found["text"]
        else:
            yield line, found["kind"], "", found["command"]


def make_folder(folder):
    """Adds the scripts, programs and scenes that pages refer to; the scenes are copies."""
    shutil.copytree(SOURCE / "meshes", folder / "meshes", ignore=shutil.ignore_patterns("out"))
    (folder / "build").mkdir()
    (folder / "build" / "bin").symlink_to(os.environ["RICOCHET_BIN"])
    for name in ("scripts", "docs"):
        (folder / name).symlink_to(SOURCE / name)


def matches(expected, line, compare):
    """Whether the line agrees with the expected one, up to blanks and the tolerance of numbers."""
    parts = re.split(f"({NUMBER}|…|[ ]+)", expected.strip())
    pattern = "".join(
        f"({NUMBER})"
        if re.fullmatch(NUMBER, part)
        else ".*"
        if part == "…"
        else r"\s+"
        if part.isspace()
        else re.escape(part)
        for part in parts
    )
    found = re.fullmatch(pattern, line.strip())
    if not found or not compare:
        return bool(found)
    wanted = [float(part) for part in parts if re.fullmatch(NUMBER, part)]
    return all(
        abs(float(got) - want) <= TOLERANCE * abs(want) + 1e-12 for got, want in zip(found.groups(), wanted)
    )


class Page:
    """A page that runs in `folder`, prepared by make_folder. `names` are the names of its Python code."""

    def __init__(self, path, folder, quick, say=lambda line: None):
        self.path, self.folder, self.quick, self.say = path, folder, quick, say
        self.state = folder / ".state"
        self.state.write_text("")
        self.where, self.output, self.names = folder, "", {"__name__": "page"}
        self.environment = os.environ | {
            "PATH": f"/usr/bin:{os.environ['RICOCHET_BIN']}:{os.environ['PATH']}",
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
            "OMPI_ALLOW_RUN_AS_ROOT": "1",
            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
            "OMPI_MCA_rmaps_base_oversubscribe": "1",
        }

    def run(self, languages=("sh", "python", "text", "toml", "geo")):
        skip = False
        for line, kind, info, text in blocks(self.path):
            if kind == "not run":
                skip = True
            elif kind == "needs":
                skip = not all(map(importlib.util.find_spec, text.split()))
            elif kind == "run" or (kind == "quick" and self.quick):
                self.shell(line, text)
            elif kind in languages and not skip:
                {"sh": self.shell, "python": self.python, "text": self.compare}.get(kind, self.file)(
                    line, text, info
                )
            skip = skip and kind in ("not run", "needs")
        return self

    def fail(self, line, what):
        raise Failed(f"{self.path.relative_to(SOURCE)}:{line}: {what}")

    def shell(self, line, text, info=""):
        begun = time.monotonic()
        script = f"set -euo pipefail\n. {self.state}\n{text}\n"
        script += f"declare -px >{self.state}\npwd >{self.state}.folder\n"
        done = subprocess.run(
            ["bash", "-c", script],
            cwd=self.where,
            env=self.environment,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            check=False,
        )
        if done.returncode != 0:
            self.fail(line, f"status {done.returncode}\n{text}\n{done.stdout}")
        self.output, self.where = done.stdout, pathlib.Path(f"{self.state}.folder").read_text().strip()
        self.say(f"{time.monotonic() - begun:7.1f} s  line {line}: {text.strip().splitlines()[-1]}")

    def python(self, line, text, info=""):
        before, printed = os.getcwd(), io.StringIO()
        os.chdir(self.where)
        try:
            with contextlib.redirect_stdout(printed):
                exec(compile("\n" * line + text, str(self.path), "exec"), self.names)
        except Exception as problem:
            raise Failed(f"{self.path.relative_to(SOURCE)}:{line}: {problem!r}") from problem
        finally:
            os.chdir(before)
        self.output = printed.getvalue()

    def compare(self, line, text, info=""):
        lines = iter(self.output.splitlines())
        for expected in text.splitlines():
            if expected.strip() not in ("", "…") and not any(
                matches(expected, got, not self.quick) for got in lines
            ):
                self.fail(
                    line, f"no such line, or not in this place:\n{expected}\nin the output:\n{self.output}"
                )

    def file(self, line, text, info=""):
        """Checks a shown file against the one in the repository, not against the one that a quick run changed."""
        if info and (SOURCE / info).read_text() != text:
            self.fail(line, f"{info} reads otherwise")
