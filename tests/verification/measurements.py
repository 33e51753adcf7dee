# SPDX-License-Identifier: BSD-2-Clause
"""Writes the page of measured impacts, measurements.md: the cases of the manual that rest on experiments, and a picture of all
their lines. All figures come from the results of the cases."""
from manual import number, short, table

INTRODUCTION = """# Measured impacts

Published experiments beside Ricochet: {cases} experiments, {lines} lines, of which {hold} lie within the measured scatter or the stated
bound. Nothing is fitted here: bodies and materials are those of the publication, or have the usual values where it gives none. Where
the authors found constants from the record that is compared, the case says so. Each case states what was read from its source, and
how. `scripts/verify --long --manual` writes this page with the
[validation manual](manual.md), which contains the same cases with their commands.

![Deviation of ours from each measured value, over its bound](figures/measurements.png)

*Deviation of ours from each measured value, over its bound. Points in the band lie within the measured scatter or the stated bound;
those outside are hollow.*
"""
ABSENT = """## Experiments without numbers

Further experiments were sought. The parts of them that could be read contain no numbers to compare with.

- A ball on a beam: Gehr et al. 2022 (arXiv 2207.00795), and *Adv. Mech. Eng.* 2016 (doi 10.1177/1687814016668089), who let a
  steel ball of 70 mm radius fall on a beam of 60 × 27.8 × 780 mm: only the abstracts. The case [`ball_on_beam`](manual.md)
  compares with Timoshenko's theory instead.
- The duration of contact and the restitution against the thickness of a plate: preprint 202511.0633, only the abstract, and
  Koller & Busenhart, nothing. The case [`plate`](manual.md) compares with Zener's theory.
- Rods of unequal length: Cross 2021 (doi 10.1088/1361-6404/ac25d2), only the abstract. His rods disagree with Saint-Venant's
  theory; the case [`unequal_rods`](manual.md) shows that rounded ends do as well.
- The clapper of a church bell: Woodhouse et al. 2012 (doi 10.1155/2012/681787), only the abstract and captions. They found a
  long series of bounces.
- Bars of a marimba: Beaton & Scavone 2019, only the abstract. Dimensions and frequencies of wooden bars that makers published
  lack the shape of the undercut or are those of plain bars, and the constants of their wood.
- A short steel bar that hits a long one at a measured speed v: records in the repository
  UTEP-Dynamic-Materials-Lab/SHPB_Toolkit. In the one that was read (`DKS_20250102_PULSE_LAB_RT_004`), the strain rises over
  the pulse up to 1.41 times the v/(2c) that momentum gives, so its calibration, or the way in which the striker hit, is not
  known well enough.
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
    text += ["", f"Commands and further lines: [case `{name}`](manual.md).", ""]
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
    text.append(ABSENT)
    path.write_text("\n".join(text).rstrip() + "\n")
