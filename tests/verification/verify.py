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
import unittest.mock

import case
import deliberate_errors
import errors_page
import manual
from deliberate_errors import ERRORS, Error
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

    def test_each_law_and_scheme_has_an_error_of_each_kind_or_a_reason_why_not(self):
        deliberate_errors.check(SOURCE)
        names = {path.stem for path in (MODULES / "cases").glob("*.py")}
        for error in ERRORS:
            self.assertNotEqual(error.right, error.wrong)
            self.assertLessEqual({*error.cases}, names)
            self.assertTrue(error.cases)
        absent = Error("gravity", "force", "x", ERRORS[0].file, "no such text", "y", ("rods",))
        lonely = [error for error in ERRORS if (error.scheme, error.kind) != ("gravity", "force")]
        for errors, complaint in (([*ERRORS, absent], "occurs 0 times"), (lonely, "gravity, force: needs")):
            with unittest.mock.patch.object(deliberate_errors, "ERRORS", errors):
                with self.assertRaisesRegex(ValueError, complaint):
                    deliberate_errors.check(SOURCE)

    def test_an_error_is_caught_by_a_counted_line_that_holds_without_it(self):
        def results(values, stopped=None):
            bench = case.Bench("x", pathlib.Path("."))
            for k, ours in enumerate(values):
                known, basis = ("because" if k == 1 else None), ("construction" if k == 2 else "theory")
                bench.below(f"line {min(k, 3)}", ours, 1.0, "why", known=known, rests_on=basis)
            return bench.found | {"stopped": stopped}

        right = results([0, 2, 0, 0, 0])

        def effect(values, stopped=None):
            found = errors_page.effect("x", right, results(values, stopped))
            return found.caught, len(found.failing), found.still

        self.assertEqual(effect([0, 2, 0, 0, 0]), (False, 0, 1))
        self.assertEqual(effect([0, 5, 3, 0, 0]), (False, 0, 0))  # a known failure, and one by construction
        self.assertEqual(effect([0, 2, 0, 0, 3]), (True, 1, 1))  # two lines have the same text
        self.assertEqual(effect([float("nan"), 2, 0, 0, 0]), (True, 1, 1))
        self.assertEqual(effect([0, 2, 0]), (True, 2, 1))  # missing
        self.assertEqual(effect([0], "it broke off"), (True, 0, 1))
        worst = errors_page.strongest(errors_page.effect("x", right, results([3, 2, 0, 7, 0])).failing)
        self.assertEqual(worst["ours"], 7)

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
