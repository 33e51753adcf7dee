# SPDX-License-Identifier: BSD-2-Clause
"""Puts deliberate errors into the source, one at a time, and lists the lines of the manual that fail.

    scripts/verify --errors                  # all; about an hour of processor time
    scripts/verify --errors table friction   # those of these schemes
    scripts/verify --errors --write          # all; also writes tests/verification/errors.md

Builds a copy of the source in out/errors. An error whose result is kept there is not run again while the source is the same.
The status is 1 if an error makes no counted line fail.
"""
import hashlib
import importlib
import json
import shutil
import subprocess
from pathlib import Path

import case
import manual
from deliberate_errors import ERRORS
from ricochet import errors, programs
from ricochet.progress import Progress

PAGE = programs.ROOT / "tests" / "verification" / "errors.md"
INTRODUCTION = """# Deliberate errors

Each row changes one place of the source. `scripts/verify --errors --write` builds the changed programs, runs the named cases of the
[validation manual](README.md), and writes this page. An error is caught if a line fails that passes without it. Lines that hold by
construction do not count.

"""


def copy_source(folder):
    """Copies the tracked files into `folder` and leaves equal files untouched. Returns a hash of the sources."""
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=programs.ROOT, check=True, capture_output=True, text=True
    )
    digest = hashlib.sha256()
    for name in filter(None, listed.stdout.split("\0")):
        content, copy = (programs.ROOT / name).read_bytes(), folder / name
        if name.endswith((".cpp", ".hpp", ".py", ".txt", ".cmake")):
            digest.update(name.encode() + content)
        if not copy.is_file() or copy.read_bytes() != content:
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(content)
            copy.chmod((programs.ROOT / name).stat().st_mode)
    return digest.hexdigest()


def build(folder, targets):
    done = subprocess.run(
        ["cmake", "--build", folder / "build", "--target", *targets], capture_output=True, text=True
    )
    if done.returncode != 0:
        raise errors.SolverError(f"build: {done.stdout[-2000:]}")


def failures(name, folder):
    """What fails in a case of the manual: texts of counted lines, or why it stopped."""
    module = importlib.import_module(f"cases.{name}")
    found = case.run(name, module, folder / name)
    if found["stopped"]:
        return [f"stops: {found['stopped']}"], len(found["checks"])
    counted = [check for check in found["checks"] if check["rests_on"] != "construction"]
    return [check["what"] for check in counted if not check["holds"]], len(counted)


def caught(error, folder, usual):
    """Lines that fail with the error, by case. `usual` are those that fail without it, by case."""
    path = folder / error.file
    right = path.read_text()
    if right.count(error.right) != 1:
        raise errors.InputError(
            f"{error.file}: {right.count(error.right)} places read {error.right!r}. Correct deliberate_errors.py."
        )
    kernels = "ricochet-kernel" in error.programs
    cases = folder / ("cases-of-the-error" if kernels else "cases")
    shutil.rmtree(folder / "cases-of-the-error", ignore_errors=True)
    path.write_text(right.replace(error.right, error.wrong))
    try:
        build(folder, error.programs)
        lines = {}
        for name in error.cases:
            failing, counted = failures(name, cases)
            lines[name] = [[what for what in failing if what not in usual[name]], counted]
        return lines
    finally:
        path.write_text(right)


def prepared(folder, wanted):
    """Builds the correct programs and runs the cases with them. Returns the known failures by case."""
    if not (folder / "build" / "build.ninja").is_file():
        options = ["-G", "Ninja", "-DRICOCHET_TESTS=OFF", "-DRICOCHET_PYTHON=OFF"]
        subprocess.run(
            ["cmake", "-S", folder, "-B", folder / "build", *options], check=True, stdout=subprocess.DEVNULL
        )
    build(folder, ["ricochet-contact", "ricochet-kernel"])
    programs.BIN = folder / "build" / "bin"
    names = list(dict.fromkeys(name for error in wanted for name in error.cases))
    return {name: failures(name, folder / "cases")[0] for name in names}


def rows(results):
    for error, lines in results:
        texts = [
            f"`{name}`: {len(failing)} of {counted}, e.g. {failing[0]}"
            for name, (failing, counted) in lines.items()
            if failing
        ]
        yield [
            error.scheme,
            error.kind,
            error.what,
            f"`{error.file}`",
            "; ".join(texts) if texts else "**nothing**",
        ]


def add_arguments(parser):
    parser.add_argument("scheme", nargs="*", help="those of these schemes (default: all)")
    parser.add_argument("--out", type=Path, default=Path("out/errors"), metavar="DIR", help="of the copy")
    parser.add_argument("--write", action="store_true", help="write tests/verification/errors.md")


def run(options):
    known = {word for error in ERRORS for word in error.scheme.replace(",", "").split()}
    if unknown := [word for word in options.scheme if word not in known]:
        raise errors.InputError(f"{unknown[0]}: no such scheme: {', '.join(sorted(known))}")
    wanted = [e for e in ERRORS if not options.scheme or set(e.scheme.split()) & set(options.scheme)]
    folder = options.out.resolve()
    mark, kept_file = copy_source(folder), folder / "results.json"
    kept = json.loads(kept_file.read_text()) if kept_file.is_file() else {}
    usual, results = None, []
    bar = Progress(len(wanted))
    for error in wanted:
        key = hashlib.sha256((mark + repr(error)).encode()).hexdigest()
        already = key in kept
        if not already:
            usual = usual or prepared(folder, wanted)
            kept[key] = caught(error, folder, usual)
            kept_file.write_text(json.dumps(kept, indent=1))
        results.append((error, kept[key]))
        bar.advance(f"{error.scheme}: {error.what}", already=already)
    head = ["law or scheme", "kind", "error", "in", "lines that fail"]
    text = "\n".join(manual.table(head, list(rows(results)))) + "\n"
    print(text)
    if options.write:
        PAGE.write_text(INTRODUCTION + text)
    return 0 if all(any(failing for failing, _ in lines.values()) for _, lines in results) else 1
