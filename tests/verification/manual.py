# SPDX-License-Identifier: BSD-2-Clause
"""Writes the validation manual. All figures in it come from the results of the cases."""
import re

from case import BASES, INDEPENDENT, verdict

INTRODUCTION = """# Validation manual

`scripts/verify --long --manual` writes this page from the runs themselves; no result is typed by hand. Each case states the source of its
reference, the commands, the results, their errors, and the reason for each bound.

    scripts/verify                 # all short cases; finished cases are not computed again
    scripts/verify --long          # also the long ones
    scripts/verify bars sphere     # these cases
    scripts/verify --list

The exit status is 0 if every line passes or is a known failure, one whose reason is established and stated beside it. A known failure
that passes makes the run fail, so that this page is corrected. Scenes and results stay in `build/verify/<case>/`. Errors are
relative to the reference, except where the reference is 0 or the error is marked "abs.". Times are processor seconds of one run, on {machine}.
Further tests cover the [ends of the range of each setting](#extremes) and [deliberate errors](#deliberate-errors) in the program.
[Measured impacts](measurements.md) is the page of the published experiments.

{count}
"""


def number(value):
    """Five digits without trailing zeros."""
    text = f"{value:.5g}"
    return re.sub(r"e([+-])0?(\d)", r"e\1\2", text).replace("e+", "e")


def short(value):
    return re.sub(r"e([+-])0?(\d)", r"e\1\2", f"{value:.2g}")


def row(check):
    error = short(check["error"]) + (" abs." if check["absolute"] and check["reference"] else "")
    result = "pass" if check["holds"] else "**FAIL**"
    reason = check["reason"] + (f" **Known failure:** {check['known']}" if check["known"] else "")
    cells = [
        check["what"],
        number(check["reference"]),
        number(check["ours"]),
        error,
        short(check["bound"]),
        result,
        check["rests_on"],
        reason,
    ]
    return "| " + " | ".join(cells) + " |"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return lines + ["| " + " | ".join(cells) + " |" for cells in rows]


def section(name, module, found):
    lines = [
        f"## {module.TITLE}",
        "",
        f"Case `{name}`{', long' if module.LONG else ''}. Source: {module.SOURCE}",
        "",
        module.__doc__.strip(),
        "",
    ]
    commands = list(dict.fromkeys(found["commands"]))
    shown = commands[:4]
    lines += [
        f"    scripts/verify {name}",
        "",
        f"It takes {found['seconds']:.1f} s of processor time and runs {len(commands)} "
        + ("command" if len(commands) == 1 else "commands")
        + (", among them" if len(commands) > len(shown) else "")
        + ":"
        if commands
        else "",
        "",
    ]
    lines += [f"    {command}" for command in shown] + [""]
    if found["stopped"]:
        lines += [f"**FAIL**: {found['stopped']}", ""]
    lines += table(["quantity", "reference", "ours", "error", "bound", "", "rests on", "why this bound"], [])
    lines += [row(check) for check in found["checks"]] + [""]
    for extra in found["tables"]:
        lines += table(extra["head"], extra["rows"]) + [""]
    for figure in found["figures"]:
        lines += [f"![{figure['caption']}](figures/{figure['file']})", "", f"*{figure['caption']}*", ""]
    return lines


def extremes(path):
    """Section on the table of extremes at `path`, with the number of lines of each kind."""
    kinds = {}
    for line in path.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if line.startswith("| ") and cells[0] != "what":
            kinds.setdefault(cells[0], []).append(cells[-1] == "pass")
    passed = [result for results in kinds.values() for result in results]
    lines = [
        "## Extremes",
        "",
        "`scripts/verify --extremes` tests the ends of the range of each setting, one case per line of [a table](extremes.md). It "
        f"has {len(passed)} lines: {sum(passed)} pass, {len(passed) - sum(passed)} fail.",
        "",
    ]
    return lines + table(
        ["extremes of", "lines", "pass"],
        [[kind, str(len(results)), str(sum(results))] for kind, results in kinds.items()],
    )


def deliberate_errors(path):
    """Section on the table of deliberate errors at `path`."""
    rows = [line.strip("|").split(" | ") for line in path.read_text().splitlines() if line.count(" | ") > 4]
    caught = {tuple(cell.strip() for cell in cells[:3]) for cells in rows[1:]}
    return [
        "## Deliberate errors",
        "",
        "`scripts/mutants --errors` puts wrong forces, signs, R, modes and steps into the contact laws and schemes, one after another, and "
        f"finds which lines of this page fail: [a table](errors.md) of {len(caught)} errors in {len({scheme for scheme, *_ in caught})} laws "
        "and schemes. Each makes a line fail or stops the case.",
        "",
    ]


def count_of(checks):
    """The sentence and the table at the top of the manual: how many lines there are, and on what they rest."""
    counted = [check for check in checks if check["rests_on"] != "construction"]
    independent = [check for check in counted if check["rests_on"] in INDEPENDENT]
    failing = [check for check in counted if not check["holds"]]
    known = sum(bool(check["known"]) for check in failing)
    lines = [
        f"**{len(independent)} of {len(counted)} lines rest on something independent of Ricochet.** {len(counted) - len(failing)} "
        f"pass, {len(failing)} fail, {known} of them known failures. {len(checks) - len(counted)} further lines hold by "
        "construction; they are shown, but not counted.",
        "",
    ]
    rows = []
    for basis, meaning in BASES.items():
        of_basis = [check for check in checks if check["rests_on"] == basis]
        passed = sum(check["holds"] for check in of_basis)
        rows.append([basis, meaning, str(len(of_basis)), str(passed), str(len(of_basis) - passed)])
    return "\n".join(lines + table(["lines that rest on", "", "lines", "pass", "fail"], rows))


def write(path, cases, machine):
    """Writes the manual to `path`. `cases` are (name, module, found) in the order of the manual."""
    count = count_of([check for _, _, found in cases for check in found["checks"]])
    lines = [
        INTRODUCTION.format(machine=machine, count=count),
        "| case | | pass | fail | result | processor s |",
        "|---|---|---|---|---|---|",
    ]
    for name, module, found in cases:
        anchor = re.sub(r"[^\w\- ]", "", module.TITLE.lower()).replace(" ", "-")
        lines.append(
            f"| `{name}` | [{module.TITLE}](#{anchor}) | "
            f"{sum(c['holds'] for c in found['checks'])} | {sum(not c['holds'] for c in found['checks'])} | {verdict(found)} | "
            f"{found['seconds']:.1f} |"
        )
    lines.append("")
    for case in cases:
        lines += section(*case)
    lines += extremes(path.with_name("extremes.md")) + [""]
    lines += deliberate_errors(path.with_name("errors.md"))
    path.write_text("\n".join(lines).rstrip() + "\n")
