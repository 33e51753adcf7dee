# SPDX-License-Identifier: BSD-2-Clause
"""Writes the page of measured impacts, measurements.md: the cases of the manual that rest on experiments, and a picture of all
their lines. All figures come from the results of the cases."""
from manual import number, short, table

INTRODUCTION = """# Measured impacts

Published experiments beside Ricochet: {cases} experiments, {lines} lines, of which {hold} lie within the measured scatter or the stated
bound. Nothing is fitted here: bodies and materials are those of the publication, or have the usual values where it gives none. Where
the authors found constants from the record that is compared, the case says so. Each case states what was read from its source, and
how. `scripts/verify --long --manual` writes this page with the
[validation manual](README.md), which contains the same cases with their commands.

![Deviation of ours from each measured value, over its bound](figures/measurements.png)

*Deviation of ours from each measured value, over its bound. Points in the band lie within the measured scatter or the stated bound;
those outside are hollow.*
"""
FARTHEST = 3.2  # deviations beyond are drawn at the edge


def experiments(cases):
    """(name, module, found, lines) of the cases that rest on experiments. `lines` are those that compare with a measurement."""
    for name, module, found in cases:
        if module.RESTS_ON == "experiment":
            yield name, module, found, [c for c in found["checks"] if c["rests_on"] == "experiment"]


def deviation(check):
    """Signed deviation over the bound."""
    share = check["error"] / check["bound"]
    return share if check["ours"] >= check["reference"] else -share


def draw(cases, bench):
    """Draws every line of every experiment with the tools of `bench`, and saves measurements.png in its folder."""
    from case import BLUE, GREY

    wall = list(experiments(cases))
    rows = sum(len(lines) + 1.6 for *_, lines in wall)
    figure, ax = bench.figure(height=0.6 + 0.155 * rows)
    figure.set_size_inches(8.6, figure.get_size_inches()[1])
    ax.axvspan(-1, 1, color=GREY, alpha=0.15, linewidth=0)
    ax.axvline(0, color=GREY, linewidth=0.8)
    ticks, labels, y = [], [], 0.0
    for _, module, _, lines in wall:
        ax.text(-FARTHEST, y, module.TITLE, fontsize=8, fontweight="bold", va="center")
        for check in lines:
            y += 1
            x = deviation(check)
            ax.plot(
                min(max(x, -FARTHEST), FARTHEST),
                y,
                "o" if abs(x) <= FARTHEST else (">" if x > 0 else "<"),
                color=BLUE,
                markerfacecolor=BLUE if check["holds"] else "white",
                markersize=4,
            )
            ticks.append(y)
            labels.append(check["what"])
        y += 1.6
    ax.set_yticks(ticks, labels, fontsize=6.5)
    ax.set(xlim=(-FARTHEST - 0.1, FARTHEST + 0.1), ylim=(y - 0.6, -1))
    ax.set_xlabel("(ours − measured) / bound")
    ax.grid(axis="y", visible=False)
    bench.save(figure, "all measured values")


def section(name, module, found, lines):
    """One experiment: source, description, lines and figures."""
    text = [f"## {module.TITLE}", "", f"Source: {module.SOURCE}", "", module.__doc__.strip(), ""]
    rows = []
    for check in lines:
        error = short(check["error"]) + (" abs." if check["absolute"] and check["reference"] else "")
        reason = f"{check['reason']}. {check['known']}" if check["known"] else check["reason"]
        values = [number(check["reference"]), number(check["ours"]), error, short(check["bound"])]
        rows.append([check["what"], *values, "yes" if check["holds"] else "**no**", reason])
    text += table(["quantity", "measured", "ours", "difference", "bound", "within", "bound and reason"], rows)
    text += ["", f"Commands and further lines: [case `{name}`](README.md).", ""]
    for figure in found["figures"]:
        text += [f"![{figure['caption']}](figures/{figure['file']})", "", f"*{figure['caption']}*", ""]
    return text


def write(path, cases):
    """Writes the page to `path`. `cases` are (name, module, found) in the order of the manual."""
    wall = list(experiments(cases))
    checks = [check for *_, lines in wall for check in lines]
    hold = sum(check["holds"] for check in checks)
    text = [INTRODUCTION.format(cases=len(wall), lines=len(checks), hold=hold)]
    for one in wall:
        text += section(*one)
    path.write_text("\n".join(text).rstrip() + "\n")
