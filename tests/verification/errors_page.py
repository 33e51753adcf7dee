# SPDX-License-Identifier: BSD-2-Clause
"""What deliberate errors do to the lines of the manual, as text and as a page."""
import re
from typing import NamedTuple

import manual
from written_sites import KINDS

HEAD = """# Deliberate errors

Written by `scripts/mutants --errors --manual`. Each line of the table states an error that was put into the program, and which lines of
the [manual](manual.md) then fail in which case, out of those that hold without the error. Lines that hold by construction are not among
them; the last column states how many of them still hold. *Strongest* is the failing line with the largest error relative to its bound.
The changes themselves are in `tests/mutants/deliberate_errors.toml`.

"""


class Effect(NamedTuple):
    """What an error does to a case."""

    name: str
    stopped: str | None
    failing: list  # (line without the error, line with it, or None if it is missing)
    construction: int  # lines that hold by construction without the error
    still: int  # how many of them hold with it

    @property
    def caught(self):
        return bool(self.stopped or self.failing)


def numbered(checks):
    """Lines by their text; equal texts are numbered."""
    out = {}
    for check in checks:
        number = sum(what == check["what"] for what, _ in out)
        out[check["what"], number] = check
    return out


def effect(name, right, wrong):
    """@param right, wrong  results of the case without and with the error"""
    ours = numbered(wrong["checks"])
    lines = [(check, ours.get(key)) for key, check in numbered(right["checks"]).items() if check["holds"]]
    fails = [(check, other) for check, other in lines if other is None or not other["holds"]]
    of_construction = sum(check["rests_on"] == "construction" for check, _ in lines)
    lost = sum(check["rests_on"] == "construction" for check, _ in fails)
    counted = [(check, other) for check, other in fails if check["rests_on"] != "construction"]
    # Without folders of this machine, and not longer than a line.
    stopped = wrong["stopped"] and re.sub(r"(?<![\w.])/\S*/", "", wrong["stopped"])[:160]
    if stopped:  # the lines after the stop are missing, not wrong
        counted = [(check, other) for check, other in counted if other]
        lost = sum(other is not None and check["rests_on"] == "construction" for check, other in fails)
    return Effect(name, stopped, counted, of_construction, of_construction - lost)


def strongest(failing):
    """The failing line with the largest error relative to its bound, with the error."""
    return max(
        (other for _, other in failing if other),
        key=lambda other: other["error"] / other["bound"] if other["bound"] else 0,
        default=None,
    )


def describe(error, effects):
    """Lines for the terminal."""
    yield f"{error.name}: {error.what}"
    for one in effects:
        worst = strongest(one.failing)
        text = f"{len(one.failing)} lines fail" + (f", stops: {one.stopped}" if one.stopped else "")
        text += f"; strongest: {value(worst)}" if worst else ""
        text += f"; {one.still} of {one.construction} by construction hold" if one.construction else ""
        yield f"  {one.name}: {text if one.caught else 'NOT CAUGHT'}"


def value(check):
    return f"{check['what']}: {manual.number(check['ours'])} in place of {manual.number(check['reference'])}"


def rows(error, effects):
    """Rows of the table, one for each case."""
    for one in effects:
        worst = strongest(one.failing)
        strong = (
            f"{value(worst)} (error {manual.short(worst['error'])}, bound {manual.short(worst['bound'])})"
            if worst
            else ""
        )
        stops = f"the case stops: {one.stopped}" if one.stopped else ""
        kept = f"{one.still} of {one.construction}" if one.construction else "–"
        yield [
            error.folder,
            error.kind,
            error.what,
            f"`{error.site.file}`",
            f"`{one.name}`",
            str(len(one.failing)),
            "; ".join(filter(None, (strong, stops))).replace("|", "\\|"),
            kept,
        ]


def write(path, written, results):
    """Writes the page. @param results  pairs of error and effects"""
    head = [
        "law or scheme",
        "kind",
        "error",
        "file",
        "case",
        "lines that fail",
        "strongest",
        "by construction, hold",
    ]
    lines = manual.table(["law or scheme", ""], [[name, text] for name, text in written.schemes.items()])
    lines += [""] + manual.table(head, [row for result in results for row in rows(*result)])
    lines += ["", "## Kinds without an error", ""]
    order = {scheme: k for k, scheme in enumerate(written.schemes)}
    none = sorted(written.none.items(), key=lambda item: (order[item[0][0]], KINDS.index(item[0][1])))
    lines += manual.table(["law or scheme", "kind", "why"], [[*key, reason] for key, reason in none])
    path.write_text(HEAD + "\n".join(lines) + "\n")
