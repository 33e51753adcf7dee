# SPDX-License-Identifier: BSD-2-Clause
"""Runs the cases of the validation manual, docs/validation/manual.md, and compares them with their
references.

    scripts/verify                  # all short cases
    scripts/verify --long           # the long ones as well
    scripts/verify bars sphere      # these cases
    scripts/verify --long --manual  # also writes the manual and its figures

A finished case is kept in build/verify. It is computed again after a change of the case, of its imports
or of the programs, or with --again; an interrupted case continues with the kernels that it has. The status is
1 if a case fails.
"""
import hashlib
import importlib
import json
import re
import shutil
import sys
from pathlib import Path

import case
import manual
import measurements
from ricochet import _core, errors, programs

MODULES = programs.ROOT / "tests" / "verification"
PAGES = programs.ROOT / "docs" / "validation"

# The order of the manual: examples of the paper, vibration, statics, impacts, measurements, and orders of convergence.
ORDER = """
kernels rods_analytic rods disks disks_fine disks_middle falling_mass admittance bars driven_rod sphere box crystal_classes nafems
table1 flexibility notches ball_at_rest ball_at_rest_fine hertz_stress two_balls oblique cattaneo belt bouncing_bar bouncing_bar_fine
dropped_rod housner bar_on_end plate ball_on_beam beam_on_stop unequal_rods alumina_on_glass glass_balls
ball_materials balls_on_plates polycarbonate_bar struck_bar aluminium_block steel_cylinder mn3ge_crystal fan_blade orders
""".split()


def sources(path, found):
    """Adds the module at `path` and its imports from tests/verification to `found`."""
    if path in found:
        return found
    found.add(path)
    for name in re.findall(
        r"^ *(?:from|import) (?:cases(?: import |\.))?(\w+)", path.read_text(), re.MULTILINE
    ):
        for folder in (MODULES / "cases", MODULES, MODULES.parent / "programs"):
            imported = folder / f"{name}.py"
            if imported.is_file():
                sources(imported, found)
    return found


def fingerprint(module):
    """Hash of the case, its imports, the scenes in meshes/ and the programs."""
    files = sorted(sources(Path(module.__file__), {MODULES / "case.py"}))
    files += [programs.BIN / "ricochet-kernel", Path(_core.__file__)]
    files += [
        path
        for path in sorted((programs.ROOT / "meshes").glob("*/*"))
        if path.suffix in (".toml", ".geo", ".py")
    ]
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.read_bytes() if path.is_file() else b"")
    return digest.hexdigest()


def modules(wanted):
    """(name, module, fingerprint) of the wanted cases, in the order of the manual."""
    names = {path.stem for path in (MODULES / "cases").glob("*.py")}
    for name in wanted:
        if name not in names:
            raise errors.InputError(f"{name}: no such case. The cases are {', '.join(sorted(names))}.")
    ordered = sorted(
        wanted or names, key=lambda name: (ORDER.index(name) if name in ORDER else len(ORDER), name)
    )
    loaded = [(name, importlib.import_module(f"cases.{name}")) for name in ordered]
    return [(name, module, fingerprint(module)) for name, module in loaded]


def kept_in(path, mark):
    """Results in the file, or None if they are missing or no longer valid."""
    kept = json.loads(path.read_text()) if path.is_file() else {}
    return kept if kept.get("fingerprint") == mark else None


def found_by(name, module, mark, cache, again):
    """Results of the case, from the cache if they are still valid, and whether they come from the cache."""
    path = cache / name / "found.json"
    if not again and (kept := kept_in(path, mark)):
        return kept, True
    begun = cache / name / "begun"
    # An interrupted case continues with the kernels that it has.
    if again or path.is_file() or not begun.is_file() or begun.read_text() != mark:
        shutil.rmtree(cache / name, ignore_errors=True)
    begun.parent.mkdir(parents=True, exist_ok=True)
    begun.write_text(mark)
    found = case.run(name, module, cache / name) | {"fingerprint": mark}
    partial = path.with_suffix(".partial")
    partial.write_text(json.dumps(found, indent=1) + "\n")
    partial.rename(path)
    return found, False


def show_failure(check):
    """Prints a line that fails, or a known failure that passes."""
    if not check["holds"]:
        verdict = "known failure" if check["known"] else "FAIL"
        values = f"{check['ours']:.6g}, reference {check['reference']:.6g}"
        errors = f"error {check['error']:.2g} above {check['bound']:.2g}"
        print(f"  {verdict}: {check['what']}: {values}, {errors}", flush=True)
    elif check["known"]:
        values = f"known to fail, but it holds: {check['ours']:.6g}"
        print(f"  FAIL: {check['what']}: {values}. Remove the note from the case.", flush=True)


def machine():
    model = [
        line.split(":")[1].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if line.startswith("model name")
    ]
    return f"{len(model)} cores of {model[0]}" if model else "an unknown machine"


def publish(cases):
    figures = PAGES / "figures"
    figures.mkdir(exist_ok=True)
    wanted = set()
    for name, _, found, folder in cases:
        for figure in found["figures"]:
            shutil.copyfile(folder / figure["file"], figures / figure["file"])
            wanted.add(figure["file"])
    written = [entry[:3] for entry in cases]
    measurements.draw(written, case.Bench("measurements", figures))
    for path in figures.glob("*.png"):
        if path.name not in wanted | {"measurements.png"}:
            path.unlink()
    manual.write(PAGES / "manual.md", written, machine())
    measurements.write(PAGES / "measurements.md", written)
    print(PAGES / "manual.md")


def add_arguments(parser):
    parser.add_argument("cases", nargs="*", metavar="CASE", help="these alone (default: all short ones)")
    parser.add_argument("--long", action="store_true", help="the long cases as well")
    parser.add_argument("--list", action="store_true", help="list the cases and stop")
    parser.add_argument("--again", action="store_true", help="compute finished cases again")
    parser.add_argument("--manual", action="store_true", help="write docs/validation/manual.md; needs --long")
    parser.add_argument(
        "--cache", type=Path, default=programs.BIN.parent / "verify", help="folder of finished cases"
    )


def run(options):
    """Returns the status, which is 1 if a case fails."""
    cache = options.cache.resolve()
    chosen = [entry for entry in modules(options.cases) if options.long or options.cases or not entry[1].LONG]
    if options.list:
        for name, module, _ in modules([]):
            print(f"{name:18} {'long ' if module.LONG else 'short'} {module.TITLE}")
        return 0
    if options.manual and (options.cases or not options.long):
        print("verify: --manual: the manual contains every case. Give --long and no names.", file=sys.stderr)
        return 2
    done = []
    for number, (name, module, mark) in enumerate(chosen, 1):
        print(f"[{number}/{len(chosen)}] {name}: {module.TITLE} …", flush=True)
        found, kept = found_by(name, module, mark, cache, options.again)
        for check in found["checks"]:
            show_failure(check)
        if found["stopped"]:
            print(f"  FAIL: {found['stopped']}")
        lines = f"{sum(c['holds'] for c in found['checks'])} of {len(found['checks'])} lines hold"
        seconds = f"{found['seconds']:.1f} processor s{', kept' if kept else ''}"
        print(f"  {case.verdict(found)}: {lines}, {seconds}", flush=True)
        done.append((name, module, found, cache / name))
    failed = [name for name, _, found, _ in done if case.verdict(found) == "FAIL"]
    if failed:
        print(f"verify: FAIL: {', '.join(failed)}", file=sys.stderr)
    if options.manual:
        publish(done)
    return 1 if failed else 0
