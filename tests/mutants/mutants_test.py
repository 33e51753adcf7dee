# SPDX-License-Identifier: BSD-2-Clause
"""scripts/mutants: where it draws, what it replaces, and how it judges, with a stand-in for the compiler and tests."""

import copy
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

import cpp_sites
import judge
import mutate
import python_sites
import written_sites
from folders import FOLDERS, targets
from judge import KILLED, SURVIVED, UNCOMPILED, Run, Verdict
from mutant import draw
from record import Reasons, Record

MODULES = Path(__file__).parents[1] / "verification"
sys.path.append(str(MODULES))
import case  # noqa: E402
import errors_page  # noqa: E402

CPP = r"""// 1 + 2 in a comment
#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>
#define TWICE(x) ((x) + (x))
/* 3 < 4
   5 < 6 */
enum { first, second = 2 };

template <class T>
T sum(const std::vector<T>& x, T start = 0) {
  for (std::size_t i = 0; i < x.size(); ++i) start += x[i];
  return start;
}

struct Counter {
  int count = 0;
  std::vector<double> seen;
  void add(double value) noexcept {
    if (value < 0 && count > 3) throw std::invalid_argument("less than " + std::to_string(7 - 7));
    seen.push_back(-value * 1.5);
    count = std::max(count, 2) + 1;
    ++count;
  }
};

double largest(const Counter& counter, double&& last) {
  assert(counter.count + 1 > 0);
  static_assert(sizeof(int) == 4);
  const std::string text = "4 + 4" + std::string(R"x(a == "b")x");
  if (const double size = 0.0; size == last) return TWICE(size);
  return counter.count / 1e-3 - static_cast<double>(text.size());
}
"""
PYTHON = '''"""1 + 2 in a docstring"""
def scale(values: list[int], by: float = 2.5) -> float:
    """3 < 4"""
    total = 0
    for value in values:  # 5 + 6
        if value < 0 and by > 7:
            raise ValueError("less than " + str(8))
        total += -value * 0.0
    return max(total, 10) + len(f"{total + 9}")


class Store:
    def keep(self, name):
        """Keeps it."""
        if name not in self.names:
            self.names[name] = 1
            self.names.pop("1 + 1")
'''


def changes(found):
    return {(site.text[site.start : site.end], site.replacement) for site in found}


class Sites(unittest.TestCase):
    def test_cpp_is_changed_where_it_computes(self):
        found = changes(cpp_sites.sites("a.cpp", CPP))
        operators = zip("< > == && + - * / += 0 2 0.0".split(), "<= >= != || - + / * -= 1 3 1.0".split())
        for change in [
            *operators,
            ("-", ""),
            ("1e-3", "(2 * 1e-3)"),
            ("max", "min"),
            ("", " return;"),
            *((text, f"!({text})") for text in ("value < 0 && count > 3", "size == last")),
            *((text, "") for text in ("++count", "start += x[i]", "count = std::max(count, 2) + 1")),
            ("seen.push_back(-value * 1.5)", ""),
            ('throw std::invalid_argument("less than " + std::to_string(7 - 7))', ""),
        ]:
            self.assertIn(change, found)

    def test_cpp_is_left_in_comments_texts_directives_assertions_and_errors(self):
        drawn = {site.line: site for site in cpp_sites.sites("a.cpp", CPP)}
        for number, line in enumerate(CPP.splitlines(), 1):
            if line.startswith(("//", "#", "/*", "   5", "enum")) or "assert(" in line:
                self.assertNotIn(number, drawn, line)
        texts = [site for site in cpp_sites.sites("a.cpp", CPP) if "text =" in site.before]
        self.assertEqual(changes(texts), {("+", "-")})
        self.assertFalse({"7", "8", "9"} & {old for old, _ in changes(cpp_sites.sites("a.cpp", CPP))})

    def test_every_mutant_of_cpp_but_those_of_texts_compiles(self):
        includes = [line for line in CPP.splitlines() if line.startswith("#")]
        bodies = [CPP] + [
            site.mutated for site in cpp_sites.sites("a.cpp", CPP) if "text =" not in site.before
        ]
        spaces = [f"namespace m{i} {{\n{body}\n}}" for i, body in enumerate(bodies)]
        text = "\n".join(
            [*includes, *(line for space in spaces for line in space.splitlines() if line[:1] != "#")]
        )
        with tempfile.TemporaryDirectory(prefix="ricochet-mutants-") as folder:
            file = Path(folder) / "a.cpp"
            file.write_text(text)
            command = ["c++", "-std=c++20", "-fsyntax-only", str(file)]
            done = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_python_is_changed_where_it_computes_and_stays_valid(self):
        found = python_sites.sites("a.py", PYTHON)
        self.assertEqual(
            changes(found),
            {
                ("2.5", "(2 * 2.5)"),
                ("0", "1"),
                ("value < 0 and by > 7", "not (value < 0 and by > 7)"),
                ("and", "or"),
                ("<", "<="),
                (">", ">="),
                ("7", "8"),
                ('raise ValueError("less than " + str(8))', "pass"),
                ("total += -value * 0.0", "pass"),
                ("-", ""),
                ("*", "/"),
                ("0.0", "1.0"),
                ("max", "min"),
                ("10", "11"),
                ("+", "-"),
                ("name not in self.names", "not (name not in self.names)"),
                ("", "return\n        "),
                ("self.names[name] = 1", "pass"),
                ("1", "2"),
                ('self.names.pop("1 + 1")', "pass"),
            },
        )
        for site in found:
            self.assertIsNone(judge.syntax_error(site.mutated))

    def test_places_are_counted_in_characters(self):
        site = python_sites.sites("a.py", 'name = "Ω²" * 2\n')[0]
        self.assertEqual(site.after, 'name = "Ω²" / 2')


class Draws(unittest.TestCase):
    def test_equal_seeds_draw_equal_mutants_and_others_draw_others(self):
        sites = cpp_sites.sites("a.cpp", CPP)
        names = [[m.name for m in draw("contact", sites, seed)] for seed in (1, 1, 2)]
        self.assertEqual(names[0], names[1])
        self.assertNotEqual(names[0], names[2])
        self.assertEqual(len(set(names[0])), len(sites))

    def test_changes_of_other_lines_leave_the_draw(self):
        one = draw("contact", cpp_sites.sites("a.cpp", CPP), 1)
        other = draw(
            "contact", cpp_sites.sites("a.cpp", CPP.replace("int count = 0;", "\n  int count = 3;")), 1
        )
        moved = [mutant.name for mutant in one if "int count" not in mutant.site.before]
        self.assertEqual(moved, [mutant.name for mutant in other if "int count" not in mutant.site.before])

    def test_every_folder_has_sources_and_tests_with_targets(self):
        for name, folder in FOLDERS.items():
            sources = folder.sources(mutate.ROOT)
            self.assertTrue(sources, name)
            for start in folder.first:
                self.assertTrue(
                    any(str(s.relative_to(mutate.ROOT)).startswith(start) for s in sources), start
                )
            for test in folder.order(str(sources[0].relative_to(mutate.ROOT))):
                self.assertTrue(targets(test))


class Builder(judge.Judge):
    """A judge whose compiler refuses some texts, and whose tests fail on others."""

    def __init__(self, tree, refused=(), failing=(), broken=()):
        super().__init__(tree, tree / "build", 1, {})
        self.refused, self.failing, self.broken, self.ran, self.built = refused, failing, broken, [], []

    def text(self):
        return (self.tree / "a.cpp").read_text()

    def compile(self, names):
        self.built += names
        refused = any(text in self.text() for text in self.refused)
        return Run(not refused, False, "a.cpp:3:4: error: no" if refused else "", 0)

    def test(self, name):
        self.ran.append(name)
        failed = name in self.broken or (
            name == "test_contact" and any(text in self.text() for text in self.failing)
        )
        return Run(not failed, False, "a.cpp:1: Failure" if failed else "", 0)


class Verdicts(unittest.TestCase):
    TEXT = "int twice(int x) {\n  return x * 2;\n}\n"

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ricochet-mutants-")
        self.addCleanup(folder.cleanup)
        self.tree = Path(folder.name)
        (self.tree / "a.cpp").write_text(self.TEXT)
        self.mutants = draw("contact", cpp_sites.sites("a.cpp", self.TEXT), 1)
        self.record = Record(self.tree / "record.json", "tests")

    def judged(self, builder, count=2, new=None):
        session = mutate.Session(self.record, builder, new)
        results = session.results(self.mutants, count, mutate.Progress(2))
        self.assertEqual(builder.text(), self.TEXT)
        return {mutant.site.after: verdict.kind for mutant, verdict in results}

    def test_what_fails_a_test_is_killed_and_the_other_survives(self):
        builder = Builder(self.tree, failing=["x / 2"])
        self.assertEqual(self.judged(builder), {"return x / 2;": KILLED, "return x * 3;": SURVIVED})
        self.assertIn("programs/robust", builder.ran)  # the survivor met every test

    def test_what_does_not_compile_is_replaced_by_the_next(self):
        first, second = (mutant.site.after for mutant in self.mutants)
        self.assertEqual(self.judged(Builder(self.tree, refused=[first]), count=1), {second: SURVIVED})
        self.assertEqual(self.record.find(self.mutants[0]).kind, UNCOMPILED)

    def test_a_test_that_fails_without_a_mutant_kills_nothing(self):
        with self.assertRaisesRegex(SystemExit, "test_contact fails without a mutant"):
            self.judged(Builder(self.tree, broken=["test_contact"]))
        self.assertEqual((self.tree / "a.cpp").read_text(), self.TEXT)
        self.assertIsNone(self.record.find(self.mutants[0]))

    def test_of_a_module_wait_for_the_programs_that_its_tests_run(self):
        self.mutants = [m for m in draw("python", python_sites.sites("a.py", "x = 1 + 2\n"), 1)][:1]
        (self.tree / "a.py").write_text("x = 1 + 2\n")
        builder = Builder(self.tree)
        builder.usual_s = {"python/commands": 1}  # it is known to pass, so its programs are there
        self.judged(builder, count=1)
        self.assertEqual(builder.ran, FOLDERS["python"].order("a.py"))
        self.assertIn("ricochet-contact", builder.built)
        self.assertEqual(builder.built.count("ricochet-contact"), len(builder.ran) - 1)

    def test_a_run_goes_on_where_it_stopped(self):
        self.assertEqual(len(self.judged(Builder(self.tree), new=1)), 1)
        self.record = Record(self.tree / "record.json", "tests")
        second = Builder(self.tree)
        self.assertEqual(len(self.judged(second)), 2)
        self.assertEqual(len(second.ran), len(FOLDERS["contact"].tests))

    def test_a_verdict_is_void_after_changes(self):
        self.judged(Builder(self.tree, failing=["x / 2"]))
        for tests, expected in (("tests", {KILLED, SURVIVED}), ("other", {KILLED, None})):
            record = Record(self.tree / "record.json", tests)
            found = [record.find(mutant) for mutant in self.mutants]
            self.assertEqual({verdict and verdict.kind for verdict in found}, expected)
        changed = draw("contact", cpp_sites.sites("a.cpp", self.TEXT + "\n"), 1)
        self.assertEqual([self.record.find(mutant) for mutant in changed], [None, None])

    def test_the_table_counts_those_that_nothing_can_kill_apart(self):
        file = self.tree / "survivors.toml"
        file.write_text(
            '[[survivor]]\nfile = "a.cpp"\nbefore = "return x * 2;"\nafter = "return x * 3;"\n'
            'equivalent = true\nreason = "x is 0"\n'
        )
        results = {"contact": [(mutant, Verdict(KILLED)) for mutant in self.mutants]}
        self.assertEqual(list(mutate.table(results, Reasons(file)))[2], "| contact | 2 | 2 | 0 | 0 | 100 % |")
        kinds = {"return x / 2;": KILLED, "return x * 3;": SURVIVED}
        results = {"contact": [(mutant, Verdict(kinds[mutant.site.after])) for mutant in self.mutants]}
        self.assertEqual(list(mutate.table(results, Reasons(file)))[2], "| contact | 2 | 1 | 1 | 0 | 100 % |")
        nothing = Reasons(self.tree / "none.toml")
        self.assertEqual(list(mutate.table(results, nothing))[2], "| contact | 2 | 1 | 0 | 1 | 50 % |")


class Written(unittest.TestCase):
    def test_each_law_and_scheme_has_an_error_of_each_kind_or_a_reason_why_not(self):
        names = {path.stem for path in (MODULES / "cases").glob("*.py")}
        for error in written_sites.read(mutate.ROOT).errors:
            self.assertNotEqual(error.site.text, error.site.mutated)
            self.assertTrue(error.cases and {*error.cases} <= names, error)
        table = tomllib.loads(written_sites.FILE.read_text())
        absent, lonely = copy.deepcopy(table), copy.deepcopy(table)
        absent["error"][0]["right"] = "no such text"
        lonely["error"] = [e for e in table["error"] if (e["scheme"], e["kind"]) != ("gravity", "force")]
        for wrong, complaint in ((absent, "occurs 0 times"), (lonely, "gravity, force: needs")):
            with self.assertRaisesRegex(ValueError, complaint):
                written_sites.read(mutate.ROOT, wrong)

    def test_an_error_is_caught_by_a_counted_line_that_holds_without_it(self):
        def results(values, stopped=None):
            bench = case.Bench("x", Path("."))
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


class Runs(unittest.TestCase):
    def test_a_command_ends_at_the_line_that_says_failure_or_when_it_takes_too_long(self):
        failing = judge.run(["sh", "-c", "echo a.cpp:12: Failure; sleep 60"], ".", 60, judge.FAILURE)
        self.assertFalse(failing.passed or failing.late)
        self.assertLess(failing.seconds, 50)
        late = judge.run(["sleep", "60"], ".", 0.2)
        self.assertTrue(late.late)
        self.assertFalse(late.passed)
        self.assertTrue(judge.run(["true"], ".", 60).passed)
        self.assertFalse(judge.run(["false"], ".", 60).passed)


if __name__ == "__main__":
    unittest.main()
