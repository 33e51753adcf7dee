# SPDX-License-Identifier: BSD-2-Clause
"""Extreme settings: the ends of the range of every option, compared with closed forms and conservation laws.

    scripts/verify --extremes                     # all; writes docs/validation/extremes.md
    scripts/verify --extremes --check             # all; compares the table's cases instead of writing it
    scripts/verify --extremes speeds damping      # only these kinds, without the table; --list prints all kinds

A line of the table states one case: the setting, the expected result, the bound on the error and the error
found. The status is 1 if a line exceeds its bound. The tests must be built: scripts/build --strict.
"""
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import extreme_accuracy
import extreme_contact
import extreme_impacts
import extreme_models
from extreme_bench import Bench, Row, Unexpected
from ricochet import programs
from ricochet.programs import ROOT

TABLE = ROOT / "docs" / "validation" / "extremes.md"
HEAD = """# Extremes

Made by `scripts/verify --extremes`; CI runs `scripts/verify --extremes --check`. The expected result of each
case follows from a closed form, a conservation law or the same run in other units, or the program refuses the
setting in one line with status 2. *Found* is the error (relative, where there is a scale), or 0 for a refusal
as expected; a case fails if it exceeds its bound.

Settings are those of the scenes in `tests/verification/extreme_bench.py`, a block with E = ρ = side = 1 that
meets the floor and two rods with c = 1, both at a hundredth of the wave speed, with the change that the line
states.

The cases are in `extreme_*.py` of `tests/verification/` (programs, as a user runs them) and in
`tests/contact/extremes.cpp` (the library).

| what | set | must be | bound | found | |
|---|---|---|---|---|---|
"""


def stepping(_):
    """Step lengths, damping, single precision and millions of steps, in the library."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "rows.json"
        done = subprocess.run(
            [programs.BIN / "test_contact_core", "--gtest_filter=Extreme*", f"--gtest_output=json:{out}"],
            capture_output=True,
            text=True,
            env=os.environ | programs.ONE_THREAD,
        )
        if not out.exists():
            raise Unexpected(f"status {done.returncode}: {done.stderr.strip()}")
        tests = [test for suite in json.loads(out.read_text())["testsuites"] for test in suite["testsuite"]]
    for test in tests:
        for number in sorted(
            int(key.split("_")[1]) for key in test if key.startswith("row_") and key.endswith("_bound")
        ):
            # GoogleTest writes each byte of a character separately.
            setting, oracle, bound, found = (
                test[f"row_{number}_{key}"].encode("latin-1").decode()
                for key in ("setting", "oracle", "bound", "found")
            )
            yield Row(setting, oracle, float(bound), float(found))
    failed = [test["name"] for test in tests if "failures" in test]
    yield Row(f"{len(tests)} tests of stepping", "all pass", 0, len(failed))


ALL = [
    *extreme_models.ALL,
    *extreme_impacts.ALL,
    *extreme_accuracy.ALL,
    *extreme_contact.ALL,
    stepping,
]


def rows_of(kind):
    """(rows, seconds) of a kind of extreme. A case that aborts becomes a failing row."""
    started, rows = time.monotonic(), []
    with tempfile.TemporaryDirectory(prefix="ricochet-extremes-") as folder:
        try:
            for row in kind(Bench(folder)):
                rows.append(row)
        except (Unexpected, OSError, KeyError, ValueError) as error:
            line = " ".join(str(error).split())[:300]
            rows.append(
                Row(
                    f"behind {rows[-1].case}" if rows else "its first case",
                    f"no failure: {line}",
                    0,
                    math.nan,
                )
            )
    return rows, time.monotonic() - started


def passes(row):
    return row.found <= row.bound  # false for NaN


def label(kind):
    return kind.__name__.replace("_", " ")


def line(kind, row):
    found = "0" if row.found == 0 else f"{row.found:.0e}"
    verdict = "pass" if passes(row) else "**FAIL**"
    return f"| {label(kind)} | {row.case} | {row.oracle} | {row.bound:g} | {found} | {verdict} |"


def cases_of(lines):
    return [line.split(" | ")[:3] for line in lines]


def written(kinds):
    """Lines of the table for these kinds."""
    starts = tuple(f"| {label(kind)} |" for kind in kinds)
    return [line for line in TABLE.read_text().splitlines() if line.startswith(starts)]


def add_arguments(parser):
    parser.add_argument("kinds", nargs="*", metavar="KIND", help="these only")
    parser.add_argument(
        "--check", action="store_true", help="do not write the table; its cases must be those that run"
    )
    parser.add_argument("--list", action="store_true", help="list the kinds and stop")
    parser.add_argument("--jobs", type=int, default=1, help="kinds that run at a time (default: 1)")


def run(options):
    known = {kind.__name__: kind for kind in ALL}
    if options.list:
        for name, kind in known.items():
            print(f"{name:20}{kind.__doc__.splitlines()[0]}")
        return 0
    unknown = [name for name in options.kinds if name not in known]
    if unknown:
        print(
            f"verify: {unknown[0]}: no such kind: scripts/verify --extremes --list names them",
            file=sys.stderr,
        )
        return 2
    kinds = [kind for kind in ALL if not options.kinds or kind.__name__ in options.kinds]
    lines, failures, total = [], 0, 0.0
    with ThreadPoolExecutor(options.jobs) as pool:
        for kind, (rows, seconds) in zip(kinds, pool.map(rows_of, kinds)):
            total += seconds
            missed = [row for row in rows if not passes(row)]
            failures += len(missed)
            lines += [line(kind, row) for row in rows]
            print(f"{kind.__name__:20}{len(rows):3} cases, {len(missed)} fail, {seconds:.1f} s", flush=True)
            for row in missed:
                print(f"  {row.case}: {row.oracle}: {row.found:g}, bound {row.bound:g}", flush=True)
    print(f"{len(lines)} cases, {failures} fail, {total:.0f} s")
    if options.check and cases_of(lines) != cases_of(written(kinds)):
        print(
            f"{TABLE.relative_to(ROOT)} differs from the cases that ran: scripts/verify --extremes writes it"
        )
        return 1
    if not options.kinds and not options.check:
        TABLE.write_text(HEAD + "\n".join(lines) + "\n")
        print(TABLE)
    return 1 if failures else 0
