"""Writes the validation manual from what the cases found. Every figure in it comes from there."""
import re

from case import verdict

INTRODUCTION = """# Validation manual

Written by `scripts/verify --manual` from the runs themselves: no figure is typed by hand. Each case says where its reference
comes from, how it was run, what came out, how far that is from the reference, and why the bound is what it is.

    scripts/verify                 # all short cases; what is finished is not computed again
    scripts/verify --long          # the long ones too
    scripts/verify {example}       # one case
    scripts/verify --list

The status is 0 if every line holds. A line marked **FAIL** is a known failure with its reason beside it: it is kept in view, and
the run fails when it is mended and this page is not. Scenes and results stay in `build/verify/<case>/`. An error is relative to the
reference unless it has a unit or the reference is 0. Times are processor seconds
of one run, on {machine}.
"""


def number(value):
    """Five digits, without a tail of zeros."""
    text = f"{value:.5g}"
    return re.sub(r"e([+-])0?(\d)", r"e\1\2", text).replace("e+", "e")


def short(value):
    return re.sub(r"e([+-])0?(\d)", r"e\1\2", f"{value:.2g}")


def row(check):
    error = short(check["error"])
    if check["unit"] and check["absolute"]:
        error += f" {check['unit']}"
    result = "pass" if check["holds"] else "**FAIL**"
    reason = check["reason"] + (f" **Known failure:** {check['known']}" if check["known"] else "")
    unit = f" ({check['unit']})" if check["unit"] else ""
    cells = [check["what"] + unit, number(check["reference"]), number(check["ours"]), error, short(check["bound"]), result, reason]
    return "| " + " | ".join(cells) + " |"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return lines + ["| " + " | ".join(cells) + " |" for cells in rows]


def section(name, module, found):
    lines = [f"## {module.TITLE}", "", f"Case `{name}`{', long' if module.LONG else ''}. Source: {module.SOURCE}", "",
             module.__doc__.strip(), ""]
    commands = list(dict.fromkeys(found["commands"]))
    shown = commands[:4]
    lines += [f"    scripts/verify {name}", "", f"It takes {found['seconds']:.0f} processor seconds and runs {len(commands)} commands"
              + (", among them" if len(commands) > len(shown) else "") + ":" if commands else "", ""]
    lines += [f"    {command}" for command in shown] + [""]
    if found["stopped"]:
        lines += [f"**FAIL**: {found['stopped']}", ""]
    lines += table(["quantity", "reference", "ours", "error", "bound", "", "why this bound"], [])
    lines += [row(check) for check in found["checks"]] + [""]
    for extra in found["tables"]:
        lines += table(extra["head"], extra["rows"]) + [""]
    for figure in found["figures"]:
        lines += [f"![{figure['caption']}](figures/{figure['file']})", "", f"*{figure['caption']}*", ""]
    return lines


def write(path, cases, machine):
    """The manual at `path`; `cases`: (name, module, found) in the order of the manual."""
    lines = [INTRODUCTION.format(machine=machine, example=cases[0][0]), "| case | | lines | result | processor s |", "|---|---|---|---|---|"]
    for name, module, found in cases:
        anchor = re.sub(r"[^\w\- ]", "", module.TITLE.lower()).replace(" ", "-")
        lines.append(f"| `{name}` | [{module.TITLE}](#{anchor}) | {len(found['checks'])} | {verdict(found)} | {found['seconds']:.0f} |")
    lines.append("")
    for case in cases:
        lines += section(*case)
    path.write_text("\n".join(lines).rstrip() + "\n")
