# SPDX-License-Identifier: BSD-2-Clause
"""Tools for the cases of the validation manual: running scenes, comparing, fitting orders, drawing.

A case is a module in cases/ with TITLE, SOURCE, RESTS_ON, LONG, a docstring for the manual, and run(bench: Bench)."""
import os
import traceback
import warnings
from pathlib import Path

import h5py
import numpy as np

import ricochet
from programs import scene_of
from ricochet import errors, programs


# What the reference of a line rests on. The first three do not depend on Ricochet.
BASES = {
    "experiment": "measured by others",
    "published": "a number or a statement that others have published",
    "theory": "a closed form, or a computation that shares no formula with Ricochet",
    "ourselves": "other results of Ricochet: consistency, symmetry, convergence",
    "construction": "holds whatever the forces are, or concerns the reference alone",
}
INDEPENDENT = ("experiment", "published", "theory")


class Stopped(Exception):
    """A case that cannot continue. The text is one line."""


def kernel_of(result, body):
    """The open kernel file of a body of the run."""
    with h5py.File(result.path) as file:
        name = file[f"bodies/{body}"].attrs["kernel"].decode()
    return h5py.File(result.path.parent / name)


def nothing(stopped=None):
    """The results of a case that has computed nothing yet, or that stopped."""
    return {"checks": [], "tables": [], "commands": [], "figures": [], "stopped": stopped, "seconds": 0.0}


class Bench:
    """The workspace of a case. `found` contains the results for the manual. `rests_on` (a key of BASES) holds for each line of the case
    that does not give its own.
    """

    def __init__(self, name, folder, rests_on="theory"):
        self.name, self.folder, self.rests_on = name, folder, rests_on
        self.found = nothing()
        self.runs = 0

    # ---- Running ----

    def write(self, name, text):
        """Writes a file in the folder of the case."""
        path = self.folder / name
        path.write_text(text)
        return path

    def call(self, shown, work, *arguments):
        """Computes through the package, and records the command that does the same."""
        if not programs.BIN.is_dir():
            raise Stopped(f"{programs.BIN}: no programs there. Run scripts/build first.")
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # the summary has them too
                found = work(*arguments)
        except errors.RicochetError as error:
            raise Stopped(f"{shown}: {error}") from None
        self.found["commands"].append(shown.replace(f"{self.folder}/", ""))
        return found

    def shown(self, path):
        path = Path(path)
        return path.relative_to(programs.ROOT) if path.is_relative_to(programs.ROOT / "meshes") else path.name

    def kernel(self, scene, *sets, ranks=1, body=None, out="out"):
        """Computes the missing kernels of the scene. Returns the open kernel file of `body` if it is given."""
        text = f"mpirun -n {ranks} ricochet-kernel {self.shown(scene)}" + self.words(sets)
        found = self.call(text, ricochet.kernels, scene_of(scene, *sets), ranks, self.folder / out)
        return h5py.File(found[body].path) if body else None

    def contact(self, scene, *sets, out="out"):
        """The result of one impact under a title of its own."""
        self.runs += 1
        text = f"ricochet-contact {self.shown(scene)}" + self.words(sets)
        return self.call(
            text, ricochet.impact, scene_of(scene, *sets, f"title=run-{self.runs}"), self.folder / out
        )

    def words(self, sets):
        return "".join(f" --set '{value}'" for value in sets)

    def impact(self, scene, *sets, ranks=1):
        self.kernel(scene, *sets, ranks=ranks)
        return self.contact(scene, *sets)

    # ---- Comparing ----

    def compare(self, what, ours, reference, bound, reason, absolute=False, known=None, rests_on=None):
        """Adds a line to the manual: |ours − reference|, divided by |reference| unless `absolute`, is within `bound`. `known`
        states the established reason if it is not. The line is then listed as a failure, but the run does not fail.
        """
        error = abs(ours - reference) / (1 if absolute else abs(reference))
        self.check(what, ours, reference, error, bound, reason, error <= bound, absolute, known, rests_on)

    def below(self, what, ours, bound, reason, known=None, rests_on=None):
        """Adds a line to the manual: an error, or a value that should be 0, is at most `bound`."""
        self.check(what, ours, 0.0, abs(ours), bound, reason, abs(ours) <= bound, True, known, rests_on)

    def at_least(self, what, ours, reference, reason, known=None, rests_on=None):
        """Adds a line to the manual: the value is at least `reference`."""
        self.check(
            what + ", at least",
            ours,
            reference,
            max(reference - ours, 0),
            0.0,
            reason,
            ours >= reference,
            False,
            known,
            rests_on,
        )

    def check(self, what, ours, reference, error, bound, reason, holds, absolute, known, rests_on):
        rests_on = rests_on or self.rests_on
        if rests_on not in BASES:
            raise ValueError(f"{what}: rests_on = {rests_on}: one of {', '.join(BASES)}")
        values = dict(ours=float(ours), reference=float(reference), error=float(error), bound=float(bound))
        self.found["checks"].append(
            values
            | dict(
                what=what, reason=reason, absolute=absolute, holds=bool(holds), known=known, rests_on=rests_on
            )
        )

    def order(self, what, sizes, errors, expected, bound, reason, known=None, rests_on=None):
        """Adds a line to the manual: the least-squares slope of log(error) over log(size) is `expected` within `bound`."""
        slope = float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])
        self.compare(
            f"order: {what}", slope, expected, bound, reason, absolute=True, known=known, rests_on=rests_on
        )

    def table(self, head, rows):
        """Adds a table of texts to the manual."""
        self.found["tables"].append(
            {"head": list(head), "rows": [[str(cell) for cell in row] for row in rows]}
        )

    # ---- Drawing ----

    def figure(self, columns=1, rows=1, height=3.2, **options):
        """A figure and its axes in the common style of the manual."""
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt

        from ricochet.pictures.style import STYLE

        plt.rcParams.update(STYLE | {"legend.fontsize": 8, "lines.linewidth": 1.3})
        return plt.subplots(
            rows,
            columns,
            figsize=(8.6 if columns > 1 else 5.6, height * rows),
            layout="constrained",
            **options,
        )

    def save(self, figure, caption, suffix=""):
        """Saves a figure for the manual with few colours, which suffice for lines on white."""
        import matplotlib.pyplot as plt
        from PIL import Image

        name = f"{self.name}{'-' + suffix if suffix else ''}.png"
        figure.savefig(self.folder / name, dpi=100)
        plt.close(figure)
        with Image.open(self.folder / name) as image:
            image.convert("RGB").quantize(48).save(self.folder / name, optimize=True)
        self.found["figures"].append({"file": name, "caption": caption})


BLUE, ORANGE, GREEN, PURPLE, RED, GREY = "#2b6cb0", "#d2691e", "#3a8f5c", "#8a4fa3", "#b03a48", "#555555"


def rms(values):
    """Root mean square."""
    return np.sqrt(np.mean(np.square(values)))


def plain_ticks(ax, sizes):
    """Labels only these sizes on a logarithmic x axis, as plain numbers."""
    from matplotlib.ticker import NullLocator

    ticks = sorted(sizes)
    ax.set_xticks(ticks, [f"{tick:.2g}" if tick < 1 else f"{tick:g}" for tick in ticks])
    ax.xaxis.set_minor_locator(NullLocator())


def slopes(ax, sizes, errors, label, colour):
    """Draws points on logarithmic axes, with the fitted order in the legend."""
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    ax.loglog(sizes, errors, "o-", color=colour, markersize=4, label=f"{label}: order {slope:.2f}")
    plain_ticks(ax, {float(x) for line in ax.lines for x in line.get_xdata()})


def processor_seconds():
    """Processor seconds of this process and its programs, which other work on the machine hardly affects."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def run(name, module, folder):
    """Results of one case with its processor seconds. If the case stopped, `stopped` contains the reason."""
    folder.mkdir(parents=True, exist_ok=True)
    bench = Bench(name, folder, module.RESTS_ON)
    started = processor_seconds()
    try:
        module.run(bench)
        bench.found["stopped"] = None if bench.found["checks"] else "it compared nothing"
    except Stopped as why:
        bench.found["stopped"] = str(why)
    except Exception as fault:  # an error in one case must not end the others
        traceback.print_exc()
        bench.found[
            "stopped"
        ] = f"it broke off: {type(fault).__name__}: {str(fault).splitlines()[0] if str(fault) else ''}"
    return bench.found | {"seconds": processor_seconds() - started}


def verdict(found):
    """ "pass", "FAIL", or "pass, known failures". A known failure that passes counts as a failure of the manual."""
    if found["stopped"] or any(c["holds"] == bool(c["known"]) for c in found["checks"]):
        return "FAIL"
    return "pass, known failures" if any(c["known"] for c in found["checks"]) else "pass"
