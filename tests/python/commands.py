# SPDX-License-Identifier: BSD-2-Clause
"""What commands print and with which status they end, and the tables of modes, without a run."""

import argparse
import contextlib
import datetime
import io
import math
import pathlib
import signal
import types
import unittest
from unittest import mock

import h5py
import numpy as np

import ricochet
from mistakes_table import TABLE
from programs import ProgramTest
from ricochet import cli, errors
from ricochet.cli import tradeoff
from ricochet.interchange.numbers import read_matrix_market
from ricochet.modal_table import ModalTable, write_csv
from ricochet.progress import Progress, duration
from ricochet.studies.study import DEEPEST, unfit
from ricochet.timing import Done
from ricochet.tradeoffs import points, report, runs
from ricochet.tradeoffs.settings import Impact, Kernel, settings


def printed(what, *arguments):
    """The value of a call, and what it prints on both streams."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        value = what(*arguments)
    return value, out.getvalue(), err.getvalue()


class Errors(unittest.TestCase):
    def test_are_reported_once_in_one_line(self):
        self.assertEqual(
            printed(errors.InputError("a\nb\tc").report, "ricochet x"), (2, "", "ricochet x: a b c\n")
        )
        self.assertEqual(printed(errors.failure(3).report, "ricochet x"), (3, "", ""))


class Verbs(unittest.TestCase):
    def setUp(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            self.addCleanup(signal.signal, number, signal.getsignal(number))

    def dispatched(self, verb, run, *words):
        module = types.SimpleNamespace(__doc__="A verb.", add_arguments=lambda parser: None, run=run)
        with mock.patch.object(cli, "module_of", lambda _: module):
            return printed(cli.dispatch, [verb, *words])

    def test_under_nohup_go_on(self):
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
        self.addCleanup(signal.signal, signal.SIGHUP, signal.SIG_DFL)
        status, _, err = self.dispatched("run", lambda _: signal.raise_signal(signal.SIGHUP))
        self.assertEqual((status, err), (0, ""))

    def test_that_are_interrupted_say_so_and_end_with_the_status_of_the_signal(self):
        resumes = "; the same command resumes the work"
        for verb, more in {
            "plot": "",
            "impact": "",
            "run": resumes,
            "sweep": resumes,
            "tradeoff": resumes,
        }.items():
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                signal.signal(number, signal.SIG_DFL)  # a shell starts tasks in the background without SIGINT
                status, out, err = self.dispatched(verb, lambda _: signal.raise_signal(number))
                self.assertEqual((status, out), (128 + number, ""))
                self.assertEqual(err, f"ricochet {verb}: interrupted{more}\n")

    def test_end_with_0_or_the_status_of_their_error(self):
        self.assertEqual(self.dispatched("plot", lambda _: None), (0, "", ""))
        refused = self.dispatched("plot", mock.Mock(side_effect=errors.InputError("no")))
        self.assertEqual(refused, (2, "", "ricochet plot: no\n"))


class Tradeoffs(unittest.TestCase):
    def row(self, speed, seconds, impulse=2.0, **more):
        quantities = {
            "rebound": {"value": [speed, 0, 0, 0, -1, 0], "scale": 2.0},
            "impulse": {"value": [impulse], "scale": impulse},
            "peak_force": {"value": [5.0], "scale": 5.0},
        }
        return {"quantities": quantities, "ended": True, "impact_s": seconds, "impact_mib": 9} | more

    def point(self, row, kernel_s=3.0, measures=("rebound", "impulse")):
        kernel = Kernel("modes", 50, True, 2, 1e-8, None, None)
        return points.Point(
            kernel,
            Impact("compliant", 1e5),
            {"kernel_s": kernel_s, "kernel_mib": 7},
            row,
            self.row(2, 0),
            measures,
        )

    def test_without_a_reference_are_refused(self):
        self.assertEqual(runs.needed({"kernel_s": 1}), {"kernel_s": 1})
        with self.assertRaisesRegex(
            errors.InputError, "^the reference is refused: ricochet-kernel: too large$"
        ):
            runs.needed({"refused": "ricochet-kernel: too large"})

    def test_keep_the_reason_of_a_refused_setting_and_end_at_a_failure(self):
        text = "[###]\nricochet-contact: no kernel\n"
        self.assertEqual(runs.refusal(Done(2, text, 1, 1, 1)), {"refused": "ricochet-contact: no kernel"})
        with self.assertRaisesRegex(errors.SolverError, "no reason given") as failed:
            runs.refusal(Done(139, "", 1, 1, 1))
        self.assertEqual(failed.exception.status, 139)

    def test_measure_errors_with_the_scales_of_the_reference(self):
        found = points.errors(self.row(2.2, 1, impulse=1.9), self.row(2, 1))
        self.assertAlmostEqual(found["rebound_error"], 0.1)
        self.assertAlmostEqual(found["impulse_error"], 0.05)
        self.assertEqual(found["peak_force_error"], 0)
        self.assertEqual(
            points.errors(self.row(2, 1, ended=False), self.row(2, 1))["rebound_error"], math.inf
        )
        self.assertAlmostEqual(self.point(self.row(2.2, 1, impulse=1.9)).error, 0.1)
        self.assertAlmostEqual(self.point(self.row(2.2, 1, impulse=1.9), measures=["impulse"]).error, 0.05)

    def test_refuse_to_compare_runs_of_other_bodies(self):
        other = self.row(2, 1)
        other["quantities"]["rebound"]["value"] = [2, 0, 0]
        with self.assertRaisesRegex(ValueError, "3 components, and its reference 6"):
            points.errors(other, self.row(2, 1))

    def test_know_the_front_and_the_cheapest_setting(self):
        made = [
            self.point(self.row(2 + error, seconds))
            for error, seconds in ((0.2, 1), (0.1, 4), (0.4, 2), (0.002, 9))
        ]

        def cost(point):
            return point.cost(2)

        self.assertEqual(cost(made[1]), 3 + 2 * 4)
        self.assertEqual(points.pareto(made, cost, 1e-9), [made[0], made[1], made[3]])
        self.assertEqual(
            points.pareto(made, cost, 0.06), [made[0], made[1]]
        )  # below the floor, errors are equal
        equal = self.point(self.row(2.1, 5))  # as good as another one, and dearer
        self.assertEqual(points.pareto([*made, equal], cost, 1e-9), [made[0], made[1], made[3]])
        self.assertIs(points.cheapest(made, 0.06, cost), made[1])
        self.assertIsNone(points.cheapest(made, 1e-5, cost))

    def test_vary_the_number_of_modes_and_one_setting_at_a_time(self):
        scene = types.SimpleNamespace(count=10, order=1, spacing=0.1, band_hz=500.0, rate_hz=1e4)
        options = argparse.Namespace(
            counts=None,
            residual=["with", "without"],
            fitted=[1e-2],
            tolerances=[1e-6, 1e-9],
            orders=None,
            spacings=[1, 2],
            schemes=["compliant", "jump"],
            rates=[1, 0.5],
            precisions=["double", "single"],
            accuracies=[1e-3],
            full=False,
        )
        made = settings(options, scene)
        kernels, impacts = [kernel for kernel, _ in made[:-1]], made[0][1]
        # A sixteenth of 10 modes is none, so the smallest basis has one.
        sizes = [kernel.size for kernel in kernels if kernel.basis == "modes"]
        self.assertEqual(sorted(set(sizes)), [1, 2, 5, 10])
        self.assertEqual({kernel.order for kernel in kernels}, {1, 2})  # never 0
        first = kernels[[kernel.size for kernel in kernels].index(10)]
        changed = [
            [name for name, value in vars(first).items() if vars(kernel)[name] != value]
            for kernel in kernels
            if kernel.size == 10
        ]
        single = ["residual_flexibility", "order", "relative_residual", "spacing_m"]
        self.assertEqual(sorted(filter(None, changed)), sorted([name] for name in single))
        self.assertEqual(len(set(kernels)), len(kernels))
        self.assertEqual(
            [(impact.scheme, impact.rate_hz, impact.precision) for impact in impacts],
            [
                ("compliant", 1e4, "double"),
                ("compliant", 1e4, "single"),
                ("compliant", 5e3, "double"),
                ("compliant", 5e3, "single"),
                ("jump", 1e4, "double"),
                ("jump", 5e3, "double"),
            ],
        )
        self.assertEqual((made[-1][0].basis, made[-1][0].size), ("accuracy", 1e-3))
        options.full = True
        sizes = {"modes": 4 * 2, "contact": 1}  # 1, 2, 5 and 10 modes with and without R
        full = [kernel for kernel, _ in settings(options, scene)[:-1]]
        self.assertEqual(len(full), sum(sizes.values()) * 2 * 2 * 2)  # orders, tolerances and spacings

    def test_state_what_each_scheme_reaches(self):
        made = []
        for scheme, speed, seconds in [
            ("compliant", 2.4, 1e-3),  # errors of 0.2, 0.05 and 0.01
            ("compliant", 2.1, 4e-3),
            ("compliant", 2.02, 9e-3),
            ("jump", 2.1, 12e-3),
            ("difference", 2.4, 1e-3),
            ("difference", 2.2, 2e-3),
        ]:
            made.append(self.point(self.row(speed, seconds)))
            made[-1].impact = Impact(scheme, 1e5)
        lines = report.scheme_lines(made, 0.06).splitlines()
        self.assertEqual(lines[0], f"compliant: 4.00 ms for all steps ({made[1].name()}, error 5.0e-02)")
        self.assertEqual(lines[1], f"jump: 12.00 ms for all steps ({made[3].name()}, error 5.0e-02)")
        smallest = f"does not reach 0.06; the smallest error is 1.0e-01 ({made[5].name()})"
        self.assertEqual(lines[2:], [f"difference: {smallest}", "compliant is 3 times cheaper than jump"])

    def test_are_drawn_by_cost_and_error_without_those_that_have_none(self):
        speeds = (2.4, 2.1, 2.02, 2.0, math.inf)  # errors of 0.2, 0.05, 0.01, 0 and none
        made = [self.point(self.row(speed, 1e-3 * 2**k)) for k, speed in enumerate(speeds)]
        with mock.patch.object(report.files, "save_picture") as saved:
            report.draw(made, 1e-4, 0.06, 3, "Ball", pathlib.Path("there.png"))
        kernels, impacts = saved.call_args.args[0].axes
        for ax, costs in ((kernels, [3, 3, 3]), (impacts, [1e-3, 2e-3, 4e-3])):
            drawn = {line.get_label(): line.get_xydata() for line in ax.lines}
            np.testing.assert_allclose(
                drawn["compliant, modes and R"], [*zip(costs, (0.2, 0.05, 0.01))], rtol=1e-9
            )
            np.testing.assert_allclose(drawn["cheapest for 0.06"], [(costs[1], 0.05)], rtol=1e-9)
        bottom, top = kernels.get_ylim()
        np.testing.assert_allclose((bottom, top), (0.5 * 0.01, 1.4 * 0.2), rtol=1e-9)  # the points fill it

    def test_are_printed_with_their_files(self):
        options = argparse.Namespace(impacts=3, error=0.06)
        made = [self.point(self.row(2.1, 4)), self.point({"refused": "no"})]
        with mock.patch.object(tradeoff.report, "write_csv") as table, mock.patch.object(
            tradeoff.report, "draw"
        ) as draw:
            _, out, _ = printed(
                tradeoff.print_outcome, runs.Outcome(made, 2e-3), options, "Ball", pathlib.Path("there")
            )
        lines = out.splitlines()
        self.assertEqual(
            lines[0], "2 settings, 1 refused; the error of the reference itself is about 2.0e-03"
        )
        self.assertIn(f"Cheapest for an error of 0.06: {made[0].name()}: 15.00 s, error 5.0e-02", lines)
        self.assertEqual(lines[-2:], ["there/tradeoff.csv", "there/tradeoff.png"])
        self.assertEqual((made[0].row["pareto"], made[1].row["pareto"]), (True, False))
        self.assertEqual(table.call_args.args[1:], (pathlib.Path("there/tradeoff.csv"),))
        self.assertEqual(draw.call_args.args[-1], pathlib.Path("there/tradeoff.png"))


class ModalTables(ProgramTest):
    def made(self, **more):
        values = {
            "body": "bell",
            "basis": "modes",
            "mass": 4.0,
            "frequency_hz": np.array([0, 123.456789, 20000]),
            "damping": np.array([np.nan, 0.01, 0.25]),
            "participation": np.array([[2.0, 0, 0], [0, 1, 0.5], [0, 0, 0.1]]),
            "contact_share": np.array([np.nan, 0.5, 0.125]),
            "residual_share": 0.375,
        }
        return ModalTable(**values | more)

    def test_have_numbers_that_end_below_the_ends_of_their_titles(self):
        lines = self.made().text(3).splitlines()
        self.assertEqual(lines[0], "bell: 3 modes, mass 4 kg")
        mode, frequency = lines[1].index("mode") + 4, lines[1].index("frequency") + 9
        ends = [
            mode,
            frequency,
            *(k + 1 for k, sign in enumerate(lines[2].replace("Hz", "  ")) if sign in "%xyz"),
        ]
        expected = [
            ["1", "0", "–", "100.000", "0.000", "0.000", "–"],
            ["2", "123.457", "1.000", "0.000", "25.000", "6.250", "50.000"],
            ["3", "20000", "25.000", "0.000", "0.000", "0.250", "12.500"],
        ]
        for line, words in zip(lines[3:], expected):
            self.assertEqual(line.split(), words)
            self.assertEqual([line[:end].split()[-1] for end in ends], words)
            self.assertEqual(len(line), ends[-1])
        total, residual = lines[6:]
        self.assertEqual(total.split(), ["sum", "of", "all", "100.000", "25.000", "6.500", "62.500"])
        self.assertEqual(residual.split(), ["residual", "flexibility", "37.500"])
        self.assertEqual({len(total), len(residual)}, {ends[-1]})

    def test_show_the_first_modes_and_count_the_others(self):
        text = self.made(residual_share=0.0, basis="contact").text(1)
        self.assertIn("bell: 3 vectors of a contact-adapted basis, mass", text)
        self.assertIn("and 2 more", text)
        self.assertNotIn("123.457", text)
        self.assertNotIn("residual", text)
        self.assertEqual(text.splitlines()[-1].split()[:3], ["sum", "of", "all"])

    def test_are_shown_in_notebooks_up_to_thirty_modes(self):
        html = self.made()._repr_html_()
        self.assertEqual((html.count("<tr>"), html.count("more</p>")), (4, 0))
        self.assertIn("<td>2</td><td>123.457</td><td>1.000</td><td>0.000</td><td>25.000</td>", html)
        many = {name: np.ones(32) for name in ("frequency_hz", "damping", "contact_share")}
        html = self.made(participation=np.ones((32, 3)), **many)._repr_html_()
        self.assertEqual((html.count("<tr>"), html.count("<p>and 2 more</p>")), (31, 1))

    def test_are_written_with_a_row_for_each_mode(self):
        write_csv([self.made(), self.made(body="floor")], self.folder / "modes.csv")
        head, *rows = (self.folder / "modes.csv").read_text().splitlines()
        self.assertEqual(len(rows), 6)
        self.assertEqual(dict(zip(head.split(","), rows[1].split(",")))["effective_mass_y_kg"], "1.0")
        self.assertEqual(rows[0].split(",")[:4], ["bell", "1", "0.0", ""])
        self.assertEqual(rows[5].split(",")[:2], ["floor", "3"])

    def test_share_the_flexibility_of_the_contact_among_modes_and_residual(self):
        random = np.random.default_rng(1)
        omega, decay = np.array([0, 10.0, 30]), np.array([0, 0.5, 3])
        normal = np.array([[0, 0, -1.0], [0, 0.6, -0.8]])
        shape, loads = random.normal(size=(2, 3, 3)), random.normal(size=(3, 3))
        half = random.normal(size=(6, 6))
        residual = 0.01 * half @ half.T
        along = np.zeros((2, 6))  # unit forces along the normals
        for point in range(2):
            along[point, 3 * point : 3 * point + 3] = normal[point]
        own = np.array(
            [0.0] + [sum((normal[p] @ shape[p, :, n]) ** 2 for p in (0, 1)) / omega[n] ** 2 for n in (1, 2)]
        )
        rest = np.trace(along @ residual @ along.T)
        most = 0.1 * half[:, :4]
        blocks = (residual - most @ most.T).reshape(2, 3, 2, 3)
        forms = {
            "compressed": {
                "compressed_flexibility/global": most,
                "compressed_flexibility/near_first": np.array([0, 2, 3]),
                "compressed_flexibility/near_block": blocks[[0, 0, 1], :, [0, 1, 1]],
            },
            "three": {"residual_flexibility": residual},
            "normal": {"residual_flexibility": along @ residual @ along.T},
        }
        for name, flexibility in forms.items():
            path = self.folder / f"{name}.kernel.h5"
            with h5py.File(path, "w") as file:
                file.attrs.update(
                    format=np.bytes_("ricochet-kernel"), version=1, body=np.bytes_("bell"), mass=4.0
                )
                file["modes/angular_frequency"], file["modes/decay_rate"] = omega, decay
                file["modes"].attrs["basis"] = np.bytes_("modes")
                file["loads/body_force"], file["surface/normal"] = loads, normal
                file["surface/shape"] = shape
                for dataset, values in flexibility.items():
                    file[f"surface/{dataset}"] = values
                if name == "normal":
                    file["surface/residual_flexibility"].attrs["components"] = np.array([1])
            table = ModalTable.read(path)
            np.testing.assert_allclose(table.contact_share[1:], own[1:] / (own.sum() + rest))
            self.assertTrue(np.isnan(table.contact_share[0]))
            self.assertAlmostEqual(table.residual_share, rest / (own.sum() + rest))
            self.assertAlmostEqual(table.elastic_share + table.residual_share, 1)
            np.testing.assert_allclose(table.damping[1:], [0.05, 0.1])
            np.testing.assert_allclose(table.frequency_hz, omega / (2 * np.pi))
            np.testing.assert_allclose(table.effective_mass, loads.T**2)
        with h5py.File(path, "a") as file:  # one component, along +z: normals with z < 0 face the other way
            del file["surface/shape"], file["surface/residual_flexibility"]
            file["surface/shape"] = shape[:, 2]
            file["surface/shape"].attrs["direction"] = np.array([0, 0, 1.0])
            file["surface/residual_flexibility"] = np.diag([0.02, 0.03])
        table = ModalTable.read(path)
        own = np.array([0, *((shape[:, 2, 1:] ** 2).sum(axis=0) / omega[1:] ** 2)])
        np.testing.assert_allclose(table.contact_share[1:], own[1:] / (own.sum() + 0.05))
        self.assertAlmostEqual(table.residual_share, 0.05 / (own.sum() + 0.05))


class Matrices(ProgramTest):
    def matrix(self, head, rest="3 3 2\n1 1 5\n3 1 -2.5\n"):
        (self.folder / "K.mtx").write_text(f"%%MatrixMarket {head}\n% a comment\n\n{rest}")
        return read_matrix_market(self.folder / "K.mtx")

    def dense(self, *given):
        (i, j, value), shape = self.matrix(*given)
        out = np.zeros(shape)
        np.add.at(out, (i, j), value)
        return out.tolist()

    def test_of_a_symmetric_file_have_both_triangles(self):
        self.assertEqual(
            self.dense("matrix coordinate real symmetric"), [[5, 0, -2.5], [0, 0, 0], [-2.5, 0, 0]]
        )
        self.assertEqual(self.dense("MATRIX Coordinate real GENERAL"), [[5, 0, 0], [0, 0, 0], [-2.5, 0, 0]])
        self.assertEqual(self.dense("matrix coordinate integer general", "1 2 1\n1 2 7\n"), [[0, 7]])

    def test_of_another_form_or_with_wrong_entries_are_refused_in_one_line(self):
        huge = ["has sizes", "matrix coordinate real general", 5000 * "1" + " 3 1\n1 1 5\n"]
        for why, *given in [*TABLE["matrices"], huge]:
            with self.subTest(given), self.assertRaisesRegex(errors.InputError, why) as refused:
                self.matrix(*given)
            self.assertNotIn("\n", str(refused.exception))


class Studies(unittest.TestCase):
    def test_take_values_that_a_scene_can_contain(self):
        def nested(depth, value=1.5):
            return [nested(depth - 1, value)] if depth > 1 else value

        for value in (
            1,
            2.5,
            True,
            "a",
            [1, ["x"]],
            {"a": {"b": [1]}},
            2**63 - 1,
            -(2**63),
            nested(DEEPEST),
        ):
            self.assertEqual(unfit(value), "")
        for value, why in (
            (nested(DEEPEST + 1), f"nested too deep: {DEEPEST} are"),
            (2**63, "more than 64 bits"),
            ([1, -(2**63) - 1], "more than 64 bits"),
            ({"a\0": 1}, "a NUL character"),
            ({"a": ["b\0"]}, "a NUL character"),
            (datetime.date(2020, 1, 1), "is a date or a time"),
        ):
            self.assertIn(why, unfit(value))


class Materials(unittest.TestCase):
    def test_have_values_within_their_scatter_and_a_source(self):
        for name, one in ricochet.materials().items():
            with self.subTest(name):
                self.assertLessEqual({"density", "young", "poisson", "source"}, set(one))
                moduli, ratios = (np.atleast_1d(one[key]) for key in ("young", "poisson"))
                # Waves along a bar of rubber run at 45 m/s, of alumina at 9800 m/s.
                speeds = (moduli / one["density"]) ** 0.5
                self.assertTrue(np.all((40 < speeds) & (speeds < 1e4)))
                self.assertTrue(np.all((0.1 < ratios) & (ratios < 0.5)))
                self.assertEqual("shear" in one, len(moduli) == 3)
                self.assertTrue(1e-4 < one.get("yield", 1e-3 * moduli[0]) / moduli[0] < 0.05)
                self.assertTrue(1e-6 < one.get("loss_factor", 0.1) < 1)
                for key, (low, high) in one.get("scatter", {}).items():
                    self.assertTrue(low <= one[key] <= high and low < high, key)

    def test_are_those_that_a_scene_can_name(self):
        body = {"mesh": "ball.msh", "contact": "skin"}
        for name, one in ricochet.materials().items():
            for word in (name, *one.get("also", [])):
                scene = ricochet.Scene(
                    {"bodies": {"ball": body | {"material": word}}, "modes": {"count": 10}}, folder="/"
                )
                self.assertEqual(
                    scene.resolved["bodies"]["ball"]["material"],
                    {
                        key: one[key]
                        for key in ("density", "young", "shear", "poisson", "yield")
                        if key in one
                    },
                )

    def test_are_listed_and_described(self):
        status, out, err = printed(cli.dispatch, ["materials"])
        self.assertEqual((status, err), (0, ""))
        lines = out.splitlines()
        self.assertEqual(len(lines), 2 + len(ricochet.materials()))
        self.assertEqual(lines[2].split(), ["steel", "7850", "210", "0.3", "235", "0.0002"])
        status, out, err = printed(cli.dispatch, ["materials", "Aluminum"])
        self.assertEqual((status, err), (0, ""))
        self.assertIn("aluminium: alloy 6061-T6\n", out)
        self.assertIn("  young        69 (69 to 72.4) GPa\n", out)
        self.assertIn("  source       W. D. Callister, Materials Science", out)

    def test_of_another_name_are_refused_with_the_nearest_ones(self):
        for word, names in {"stel": "steel", "wood": "rosewood along the grain"}.items():
            status, _, err = printed(cli.dispatch, ["materials", word])
            self.assertEqual((status, err.count("\n")), (2, 1))
            self.assertIn(f'there is no material "{word}": did you mean {names}', err)


class Bars(unittest.TestCase):
    def test_state_durations_in_two_units_at_most(self):
        for seconds, text in (
            (0.4, "0 s"),
            (59.4, "59 s"),
            (60, "1 min 0 s"),
            (3599, "59 min 59 s"),
            (3600, "1 h 0 min"),
            (7500, "2 h 5 min"),
        ):
            self.assertEqual(duration(seconds), text)

    def test_show_the_share_done_and_the_time_left_from_the_work_of_this_run(self):
        stream = io.StringIO()
        stream.isatty = lambda: True
        with mock.patch("ricochet.progress.time.monotonic", side_effect=[100, 110, 120, 150]):
            bar = Progress(6, stream)
            bar.advance("old", 2, already=True)
            bar.advance("new", 2)
            bar.advance("last", 2)
        first, second, third = stream.getvalue().split("\r\033[K")[1:]
        self.assertEqual(first, f"[{'#' * 10}{'.' * 20}] 2/6  old")
        self.assertEqual(second, f"[{'#' * 20}{'.' * 10}] 4/6, 20 s left  new")  # 2 took 20 s
        self.assertEqual(third, f"[{'#' * 30}] 6/6  last\n")
        silent = io.StringIO()
        Progress(2, silent).advance("x")
        self.assertEqual(silent.getvalue(), "")


if __name__ == "__main__":
    unittest.main()
