# SPDX-License-Identifier: BSD-2-Clause
"""The program of the validation manual: failures, cached results, and a check that the manual contains
every case."""

import contextlib
import importlib
import io
import json
import pathlib
import sys
import tempfile
import unittest

import case
import manual
from programs import SOURCE, Run

MODULES = SOURCE / "tests" / "verification"
PAGES = SOURCE / "docs" / "validation"
# As in scripts/verify.
sys.path += [str(SOURCE / "tests" / folder) for folder in ("robustness", "docs", "mutants")]


def verify(*words):
    """Status and output of scripts/verify with these words, in this process."""
    import command  # the other checks, which it lists, are in these folders

    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        status = command.main([str(word) for word in words])
    return status, out.getvalue()


def verdict_of(compare):
    bench = case.Bench("x", pathlib.Path("."))
    compare(bench)
    bench.found["stopped"] = None
    return case.verdict(bench.found)


class Verify(unittest.TestCase):
    def test_an_error_above_its_bound_fails_and_one_on_it_passes(self):
        self.assertEqual(verdict_of(lambda bench: bench.compare("x", 1.5, 1.0, 0.5, "why")), "pass")
        self.assertEqual(verdict_of(lambda bench: bench.compare("x", 1.51, 1.0, 0.5, "why")), "FAIL")
        self.assertEqual(
            verdict_of(lambda bench: bench.compare("x", 4.5, 4.0, 0.4, "why", absolute=True)), "FAIL"
        )
        self.assertEqual(verdict_of(lambda bench: bench.below("x", -2.0, 1.0, "why")), "FAIL")
        self.assertEqual(verdict_of(lambda bench: bench.below("x", float("nan"), 1.0, "why")), "FAIL")

    def test_a_known_failure_passes_until_it_holds(self):
        self.assertEqual(
            verdict_of(lambda bench: bench.below("x", 2.0, 1.0, "why", known="because")),
            "pass, known failures",
        )
        self.assertEqual(verdict_of(lambda bench: bench.below("x", 0.5, 1.0, "why", known="because")), "FAIL")

    def test_a_line_that_holds_by_construction_is_not_counted(self):
        bench = case.Bench("x", pathlib.Path("."), "experiment")
        bench.below("measured", 0.5, 1.0, "why")
        bench.below("wrong", 2.0, 1.0, "why", known="because")
        bench.below("closed form", 0.5, 1.0, "why", rests_on="theory")
        bench.below("own", 0.5, 1.0, "why", rests_on="ourselves")
        bench.below("sure", 0.5, 1.0, "why", rests_on="construction")
        text = manual.count_of(bench.found["checks"])
        self.assertIn(
            "**3 of 4 lines rest on something independent of Ricochet.** 3 pass, 1 fail, 1 of", text
        )
        self.assertIn("1 further lines hold by construction", text)
        self.assertIn("| experiment | measured by others | 2 | 1 | 1 |", text)
        with self.assertRaises(ValueError):
            bench.below("x", 0.5, 1.0, "why", rests_on="hope")

    def test_an_order_is_fitted_to_logarithms(self):
        self.assertEqual(
            verdict_of(lambda bench: bench.order("x", [1, 2, 4], [3, 12, 48], 2.0, 1e-12, "why")), "pass"
        )
        self.assertEqual(
            verdict_of(lambda bench: bench.order("x", [1, 2, 4], [3, 12, 48], 1.0, 0.9, "why")), "FAIL"
        )

    def test_a_finished_case_is_kept_until_asked_again(self):
        with tempfile.TemporaryDirectory(prefix="ricochet-test-") as folder:
            words = ("rods_analytic", "--cache", folder)
            self.assertEqual(verify(*words)[0], 0)
            found = pathlib.Path(folder) / "rods_analytic" / "found.json"
            stamp = found.stat().st_mtime_ns
            self.assertIn("kept", verify(*words)[1])
            self.assertEqual(found.stat().st_mtime_ns, stamp)
            self.assertNotIn("kept", verify(*words, "--again")[1])
            # A case with another fingerprint is computed again.
            found.write_text(json.dumps(json.loads(found.read_text()) | {"fingerprint": "other"}))
            self.assertNotIn("kept", verify(*words)[1])

    def test_an_interrupted_case_goes_on_with_its_kernels(self):
        with tempfile.TemporaryDirectory(prefix="ricochet-test-") as folder:
            words = ("rods", "--cache", folder)
            self.assertEqual(verify(*words)[0], 0)
            place = pathlib.Path(folder) / "rods"
            kernels = {path: path.stat().st_mtime_ns for path in place.glob("out/*.kernel.h5")}
            self.assertEqual(len(kernels), 2)
            (place / "found.json").unlink()
            self.assertEqual(verify(*words)[0], 0)
            self.assertEqual(
                kernels, {path: path.stat().st_mtime_ns for path in place.glob("out/*.kernel.h5")}
            )

    def test_an_unknown_case_is_refused_in_one_line(self):
        run = Run([SOURCE / "scripts" / "verify", "nonsense"])
        self.assertEqual((run.status, run.err.count("\n")), (2, 1))
        self.assertIn("nonsense: no such case", run.err)

    def test_the_manual_holds_every_case_and_its_figures(self):
        text, wall = ((PAGES / page).read_text() for page in ("manual.md", "measurements.md"))
        for line in verify("--list")[1].splitlines():
            name = line.split()[0]
            self.assertIn(f"| `{name}` |", text)
            self.assertIn(f"    scripts/verify {name}\n", text)
            module = importlib.import_module(f"cases.{name}")
            self.assertEqual(f"## {module.TITLE}\n" in wall, module.RESTS_ON == "experiment", name)
        extremes = sum(
            line.endswith((" pass |", " **FAIL** |"))
            for line in (PAGES / "extremes.md").read_text().splitlines()
        )
        self.assertIn(f"It has {extremes} lines: {extremes} pass, 0 fail.", text)
        drawn = {path.name for path in (PAGES / "figures").glob("*.png")}
        self.assertEqual({part.split(")")[0] for part in (text + wall).split("](figures/")[1:]}, drawn)


if __name__ == "__main__":
    unittest.main()
