# SPDX-License-Identifier: BSD-2-Clause
"""Draws a result of ricochet-contact: the contact, snapshots of the bodies, and the energy ledger.

    ricochet plot out/two-disks.result.h5 [--out DIR] [--kernels DIR]

Writes <slug>-contact.png, <slug>-energy.png and, when the scene asked for snapshots and views,
<slug>-snapshots.png, and prints their paths. Ends with status 2, and one line, when the result can't be read.
"""
import sys
from pathlib import Path

import numpy as np
from matplotlib.ticker import LogLocator

from ricochet.cli.command_line import Parser
from ricochet.pictures.snapshots import snapshots_picture
from ricochet.pictures.style import DPI, GREY, SHADE, WIDTH, colour_of, largest_of, legend_below, plt, prefixed
from ricochet.result_file import BadInput, Result, expected, skins_of
from ricochet.files import save_picture


def shade_contact(result, ax, scale):
    for start, end in result.spans():
        ax.axvspan(start * scale, end * scale, **SHADE)


# ---- Pictures ----


def force_panel(result, ax, i):
    """Force at point i and the sum of all, over the time of the contact: steps, whose area is the impulse."""
    start, end = result.window()
    ms, time_unit = prefixed(end, "s")
    when, here = result.held(result.force[:, i])
    _, total = result.held(result.force.sum(axis=1))
    scale, shown_unit = prefixed(largest_of(total), "N")
    ax.fill_between(when * ms, here * scale, step="pre", color="#b03a48", alpha=0.25, linewidth=0)
    ax.plot(when * ms, here * scale, drawstyle="steps-pre", color="#b03a48", linewidth=1.4, label="force at the point")
    if len(result.gap) > 1:
        ax.plot(when * ms, total * scale, ":", drawstyle="steps-pre", color=GREY, linewidth=1.5, label=f"sum over {len(result.gap)} points")
    ax.set(ylabel=f"contact force ({shown_unit})", title="Contact force", xlabel=f"time ({time_unit})",
           xlim=(start * ms, end * ms))
    if not result.episodes:
        ax.text(0.5, 0.5, "nothing touched", transform=ax.transAxes, ha="center", color=GREY)


def table_picture(result):
    """What a run by table kernels knows: the gap where the most impulse passes, velocities of free bodies, the force."""
    i = int(np.argmax(result.impulse())) if result.episodes else 0
    ms, _ = prefixed(result.window()[1], "s")
    figure, axes = plt.subplots(3, 1, figsize=(WIDTH, 8.2), sharex=True, layout="constrained")
    when, gap = result.broken(result.gap_now[:, i])
    scale, unit = prefixed(largest_of(gap), "m")
    axes[0].plot(when * ms, gap * scale, color=GREY, label="gap while touching")
    axes[0].set(ylabel=f"gap ({unit})", title="Gap at the point (negative: penetration)")
    changes = [np.ptp(v, axis=0) for v in result.velocity.values()]
    axis = int(np.argmax(np.max(changes, axis=0))) if changes else 0
    scale, unit = prefixed(largest_of(*(v[:, axis] for v in result.velocity.values())), "m/s")
    for body, v in result.velocity.items():
        axes[1].plot(result.time * ms, v[:, axis] * scale, color=colour_of(result, body),
                     label=f"{body}, mean of its mass")
    axes[1].set(ylabel=f"{'xyz'[axis]}-velocity ({unit})", title="Velocity")
    force_panel(result, axes[2], i)
    handles = {}
    for ax in axes:
        shade_contact(result, ax, ms)
        handles |= dict(zip(*reversed(ax.get_legend_handles_labels())))
    handles["in contact"] = plt.Rectangle((0, 0), 1, 1, **SHADE)
    legend_below(figure, handles.values(), handles.keys())
    figure.suptitle(f"{result.title}: contact at point {i + 1} of {len(result.gap)}", fontsize=11)
    return figure


def contact_picture(result):
    """Place and velocity of both sides where the most impulse passes, and the force there, against time."""
    i = int(np.argmax(result.impulse())) if result.episodes else 0
    points = len(result.gap)
    start, end = result.window()
    shown = (result.time >= start) & (result.time <= end)
    t = result.time[shown]
    ms, time_unit = prefixed(end, "s")
    place, speed, *means = result.along_normal(i)
    mean_place, mean_speed = ({body: values[shown] for body, (_, values) in mean.items()} for mean in means)

    figure, axes = plt.subplots(3, 1, figsize=(WIDTH, 8.2), sharex=True, layout="constrained")
    panels = [(axes[0], "m", "place along normal",
               "Place of the two surfaces, from where the second one was (they touch where the lines meet)",
               place, mean_place),
              (axes[1], "m/s", "velocity along normal", "Velocity", speed, mean_speed)]
    for ax, unit, label, title, at_point, mean in panels:
        scale, shown_unit = prefixed(largest_of(*(v for _, v in at_point.values()), *mean.values()), unit)
        for name, (when, values) in at_point.items():
            # What does not move stands behind, broad and pale: the other side lies on it.
            style = {"linewidth": 1.8} if name in result.bodies else {"linewidth": 5, "alpha": 0.3, "zorder": 1.4}
            ax.plot(when * ms, values * scale, color=colour_of(result, name), label=f"{name}, contact point",
                    **style)
            padded = np.concatenate([[np.nan], values, [np.nan]])
            alone = np.isnan(padded[:-2]) & np.isnan(padded[2:])  # an episode of one step
            ax.plot(when[alone] * ms, values[alone] * scale, ".", color=colour_of(result, name))
        for body, values in mean.items():
            ax.plot(t * ms, values * scale, "--", color=colour_of(result, body), linewidth=1, zorder=1.5,
                    label=f"{body}, mean of its mass")
        ax.set(ylabel=f"{label} ({shown_unit})", title=title)
    force_panel(result, axes[2], i)
    for ax in axes:
        shade_contact(result, ax, ms)
    handles = {}
    for ax in (axes[0], axes[2]):
        handles |= dict(zip(*reversed(ax.get_legend_handles_labels())))
    handles["in contact"] = plt.Rectangle((0, 0), 1, 1, **SHADE)
    legend_below(figure, handles.values(), handles.keys())
    where = ", ".join(f"{x:.4g}" for x in result.point[i])
    figure.suptitle(f"{result.title}: contact at point {i + 1} of {points}, at ({where}) m", fontsize=11)
    return figure


def energy_picture(result):
    """Every term of the energy ledger with their sum, and how far the sum strays from its first value."""
    terms = {name: result.energy[name] * (-1 if name == "loads" else 1) for name in result.TERMS}
    ledger = result.energy["total"] + result.energy["damping"] + result.energy["contact"]
    scale_name, reference = "first value", abs(ledger[0])
    if reference <= 1e-12 * largest_of(*terms.values()):  # a drop from rest starts with nothing
        scale_name, reference = "largest term", largest_of(*terms.values())
    ms, time_unit = prefixed(result.time[-1], "s")
    mj, energy_unit = prefixed(largest_of(ledger, *terms.values()), "J")
    t = result.time * ms

    figure, (top, low) = plt.subplots(2, 1, figsize=(WIDTH, 6.2), sharex=True, height_ratios=[2.2, 1],
                                      layout="constrained")
    colours = ["#2b6cb0", "#d2691e", "#3a8f5c", "#8a4fa3", "#8c6d1f", "#b03a48"]
    for (name, values), colour in zip(terms.items(), colours):
        nothing = not np.any(values)
        top.plot(t, values * mj, color=colour, linewidth=1 if nothing else 1.6,
                 label=result.LABELS[name] + (" (0)" if nothing else ""))
    top.plot(t, ledger * mj, color="black", linewidth=1.8, linestyle=(0, (4, 1.5)), label="sum of all")
    top.set(ylabel=f"energy ({energy_unit})", title="Where the energy is")
    stray = np.abs(ledger - ledger[0]) / (reference or 1)
    if np.any(stray):  # a logarithm has no place for exact zeros
        low.semilogy(t[stray > 0], stray[stray > 0], ".", color="black", markersize=2)
        first, last = np.floor(np.log10(stray[stray > 0].min())), np.ceil(np.log10(stray.max()))
        low.set_ylim(10.0**first, 10.0 ** max(last, first + 1))
        low.yaxis.set_major_locator(LogLocator(numticks=6))
    else:
        low.text(0.5, 0.5, "nothing: the sum never changes", transform=low.transAxes, ha="center", color=GREY)
    low.set(ylabel=f"|change of sum| /\n{scale_name}", title="What the ledger fails to account for",
            xlabel=f"time ({time_unit})", xlim=(t[0], t[-1]))
    for ax in (top, low):
        shade_contact(result, ax, ms)
    handles, names = top.get_legend_handles_labels()
    legend_below(figure, [*handles, plt.Rectangle((0, 0), 1, 1, **SHADE)], [*names, "in contact"])
    figure.suptitle(f"{result.title}: energy", fontsize=11)
    return figure


# ---- Program ----


def main():
    parser = Parser(__doc__, "RESULT.h5")
    parser.add_argument("result", type=Path, metavar="RESULT.h5")
    parser.add_argument("--out", type=Path, help="folder of the pictures (default: beside the result)")
    parser.add_argument("--kernels", type=Path, help="folder of the kernels (default: beside the result)")
    options = parser.parse_args()
    folder = options.out or options.result.parent
    written = []

    def save(figure, name):
        path = folder / f"{result.slug}-{name}.png"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            save_picture(figure, path, dpi=DPI)
        except OSError as error:
            raise BadInput(f"{path}: cannot be written ({error.strerror}). Choose another --out.") from None
        plt.close(figure)
        written.append(path)

    try:
        with expected(options.result):
            result = Result(options.result)
            if result.static:
                raise BadInput(f"{options.result}: bodies at rest have no history to draw. Use ricochet report.")
            if result.energy is None:
                save(table_picture(result), "contact")
                print("plot: no energies, no snapshots: table kernels do not tell", file=sys.stderr)
            else:
                save(contact_picture(result), "contact")
                skins, time = skins_of(result, options.kernels or options.result.parent)
                figure = snapshots_picture(result, skins, time) if skins and result.episodes else None
                if figure:
                    save(figure, "snapshots")
                else:
                    why = "no snapshot falls into a contact" if skins else time
                    print(f"plot: no picture of snapshots: {why}", file=sys.stderr)
                save(energy_picture(result), "energy")
    except BadInput as error:
        print(f"plot: {error}", file=sys.stderr)
        return 2
    finally:
        print(*written, sep="\n", end="\n" if written else "")
    return 0
