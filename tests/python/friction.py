# SPDX-License-Identifier: BSD-2-Clause
"""Friction in results, pictures, pages and sweeps, with files that friction_file.py makes without a run."""

import json
import math
import re
import types
import unittest
import unittest.mock

import h5py
import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import friction_file
import ricochet
from friction_file import edited
from report_test import ReportTest, unpacked
from ricochet import pictures
from ricochet.pages import charts
from ricochet.pages.run import run_of
from ricochet.pictures.contact import contact_picture, state_strip
from ricochet.pictures.energy import energy_picture
from ricochet.pictures.friction import COLUMNS, ROWS, far_apart, friction_picture, parts, place_axis
from ricochet.pictures.grid import Grid
from ricochet.contacts import Entries
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.style import DPI, STATE, STYLE, WIDTH
from ricochet.result import OPEN, SLIP, STICK
from ricochet.studies.journal import outputs

ARRAYS = ("tangential_force", "tangential_displacement", "state", "total_tangential_force")
KEYS = ("energy_lost_friction", "friction_impulse_ns", "max_slip_m", "ambiguous_steps")
STRIBECK = "friction = { static = 0.5, dynamic = 0.4, stribeck_velocity = 0.1 }"

# Counts the colours of the map of stick and slip and of the motion view, and asks the map for a value.
LOOK = """(() => {
const counted = (data, found = {}) => {
  for (let k = 0; k < data.length; k += 4) {
    const colour = "#" + [0, 1, 2].map(i => data[k + i].toString(16).padStart(2, "0")).join("");
    found[colour] = (found[colour] ?? 0) + 1;
  }
  return found;
};
const map = document.querySelector("#map-states canvas"), box = map.getBoundingClientRect();
const look = {map: counted(map.getContext("2d").getImageData(0, 0, map.width, map.height).data)};
map.dispatchEvent(Object.assign(new Event("pointermove"), {clientX: box.left + box.width * 0.5, clientY: box.top + 1}));
look.tip = document.querySelector("#map-states .tip").textContent;
const view = document.querySelector("canvas[data-covered]"), flat = document.createElement("canvas");
[flat.width, flat.height] = [view.width, view.height];
flat.getContext("2d").drawImage(view, 0, 0);
look.motion = counted(flat.getContext("2d").getImageData(0, 0, flat.width, flat.height).data);
return look;
})()"""


class FrictionTest(ReportTest):
    def made(self, name="rubbed", **more):
        """A result and the histories it was made from."""
        path, drag = friction_file.write(self.folder / name, **more)
        return ricochet.Result(path), drag

    def history(self, **more):
        path, drag = friction_file.write(self.folder / "rubbed", **more)
        return LoadedResult(path), drag

    def refused(self, why, what):
        with self.assertRaisesRegex(ricochet.InputError, why) as refusal:
            what()
        self.assertNotIn("\n", str(refusal.exception))


class Results(FrictionTest):
    def test_has_the_arrays_of_friction_of_the_file(self):
        result, drag = self.made()
        k, m = len(drag.rows), len(drag.point)
        self.assertTrue(result.has_friction)
        np.testing.assert_array_equal(result.tangential_force, drag.tangential[drag.rows])
        np.testing.assert_array_equal(result.tangential_displacement, drag.slipped[drag.rows])
        np.testing.assert_array_equal(result.state, drag.state[drag.rows])
        self.assertEqual([result.state.shape, result.tangential_force.shape], [(k, m), (k, m, 3)])
        self.assertEqual(set(result.state.ravel().tolist()), {OPEN, STICK, SLIP})
        np.testing.assert_allclose(result.total_tangential_force, drag.tangential.sum(axis=1), atol=1e-12)
        self.assertEqual(result.total_tangential_force.shape, (len(result.time), 3))

    def test_has_heat_that_is_the_work_of_friction_on_the_relative_motion(self):
        result, _ = self.made()
        work = np.sum(result.tangential_force[1:] * np.diff(result.tangential_displacement, axis=0))
        heat = result.energy["friction"]
        self.assertGreater(heat[-1], 0)
        self.assertAlmostEqual(work / heat[-1], 1, delta=1e-9)

    def test_has_terms_for_charts_whose_sum_is_the_ledger(self):
        for friction in ({}, {"friction": None}):
            history, _ = self.history(**friction)
            self.assertGreater(np.ptp(history.terms["loads"]), 0)
            self.assertEqual("friction" in history.terms, not friction)
            np.testing.assert_allclose(sum(history.terms.values()), history.ledger, rtol=1e-12)

    def test_has_the_figures_of_friction_with_types(self):
        result, _ = self.made()
        found = result.friction
        self.assertEqual(found.ambiguous_steps, 3)
        self.assertEqual(
            [found.energy_lost, found.impulse, found.max_slip], [result.summary[key] for key in KEYS[:3]]
        )
        self.assertEqual([type(value) for value in vars(found).values()], [float, float, float, int])
        self.assertEqual(result.figures()["longest slip"], f"{result.summary['max_slip_m']:.6g} m")
        self.assertEqual(
            result.figures()["impulse of friction"], f"{result.summary['friction_impulse_ns']:.6g} N s"
        )
        self.assertIn("heat of friction", result._repr_html_())

    def test_counts_null_as_no_steps_and_no_energy(self):
        result, _ = self.made()
        path = self.folder / "rubbed.summary.json"
        summary = json.loads(path.read_text()) | {"ambiguous_steps": None, "energy_lost_friction": None}
        path.write_text(json.dumps(summary))
        found = ricochet.Result(result.path).friction
        self.assertEqual((found.ambiguous_steps, found.energy_lost), (0, None))

    def test_without_friction_says_so(self):
        result, _ = self.made(friction=None)
        self.assertFalse(result.has_friction)
        self.assertIsNone(result.friction)
        for name in ARRAYS:
            self.refused("this run has no friction.*contact.friction", lambda: getattr(result, name))
        self.assertFalse([name for name in result.figures() if "friction" in name or "slip" in name])
        np.testing.assert_array_equal(result.energy["friction"], 0 * result.time)
        np.testing.assert_allclose(result.ledger, result.ledger[0], rtol=1e-12)

    def test_of_an_older_version_has_no_heat(self):
        result, _ = self.made(friction=None)
        with edited(result.path) as file:
            del file["energy/friction"]
        (summary,) = self.folder.glob("*.summary.json")
        older = {key: value for key, value in json.loads(summary.read_text()).items() if key not in KEYS}
        summary.write_text(json.dumps(older))
        again = ricochet.Result(result.path)
        np.testing.assert_array_equal(again.energy["friction"], 0 * again.time)
        self.assertIsNone(again.friction)
        self.assertEqual(len(energy_picture(LoadedResult(result.path)).axes), 2)

    def test_of_sampled_responses_has_no_ledger(self):
        result, _ = self.made(friction=None)
        with edited(result.path) as file:
            del file["energy"]
        self.refused("no energy ledger", lambda: ricochet.Result(result.path).ledger)

    def test_that_is_damaged_is_refused_in_one_line(self):
        for name, damaged, why in [
            ("state", lambda old: old + 1.5, "values other than 0, 1 and 2"),
            ("state", lambda old: old[:, 1:], "has shape"),
            ("tangential_force", lambda old: old[..., :2], "has shape"),
            ("tangential_force", lambda old: old * np.nan, "not finite"),
            ("tangential_displacement", None, "is missing"),
        ]:
            path, _ = friction_file.write(self.folder / "rubbed")
            with edited(path) as file:
                old = file[f"contact/{name}"][:]
                del file[f"contact/{name}"]
                if damaged:
                    file[f"contact/{name}"] = damaged(old)
            self.refused(why, lambda: getattr(ricochet.Result(path), name))
            self.refused(why, lambda: list(pictures.draw(path)))
            self.refused(why, lambda: ricochet.report(path))
        self.assertEqual([*self.folder.glob("*.png"), *self.folder.glob("*.html")], [])


class Histories(FrictionTest):
    def test_know_the_coefficients_if_all_pairs_with_friction_have_the_same_ones(self):
        floor = '[[contact.pair]]\nbetween = ["block", "wall"]\n'
        for text, expected in {
            "friction = 0.4": (0.4, 0.4),
            STRIBECK: (0.5, 0.4),
            "friction = { static = 0.5, dynamic = 0.5 }": (0.5, 0.5),
            f"friction = 0.4\n{floor}friction = 0.4": (0.4, 0.4),
            f"friction = 0.3\n{floor}": (0.3, 0.3),  # the other pair has no friction
            f"friction = 0.4\n{floor}friction = 0.3": None,
        }.items():
            self.assertEqual(self.history(friction=text)[0].coefficients, expected, text)

    def test_keep_friction_within_its_bound(self):
        history, drag = self.history()
        normal, resultant, magnitudes = history.tangential_totals()
        np.testing.assert_allclose(normal, drag.force[drag.rows].sum(axis=1))
        self.assertTrue(np.all(resultant <= magnitudes * (1 + 1e-12)))
        self.assertTrue(np.all(magnitudes <= friction_file.MU * normal * (1 + 1e-12)))

    def test_leave_points_of_pairs_without_friction_out_of_the_bound(self):
        path, drag = friction_file.write(self.folder / "rubbed")
        with edited(path) as file:  # the first half belongs to a pair without friction
            half = len(drag.point) // 2
            for name in ("state", "tangential_force", "tangential_displacement"):
                file[f"contact/{name}"][:, :half] = 0
        history = LoadedResult(path)
        np.testing.assert_array_equal(history.rubbing, np.arange(len(drag.point)) >= half)
        np.testing.assert_allclose(history.tangential_totals()[0], drag.force[drag.rows, half:].sum(axis=1))
        np.testing.assert_array_equal(
            np.sort(Grid(history, history.rubbing, 400, 400).order), np.arange(half, len(drag.point))
        )

    def test_find_a_loop_whose_area_is_the_heat_of_the_point(self):
        path, drag = friction_file.write(self.folder / "rubbed", form="point")
        with edited(path) as file:  # only what is along x: the loop is that of one direction
            for name in ("tangential_force", "tangential_displacement"):
                file[f"contact/{name}"][:, :, 1] = 0
        history = LoadedResult(path)
        moved, force = history.loop(0)
        np.testing.assert_allclose(force, drag.tangential[drag.rows, 0, 0], atol=1e-12)
        np.testing.assert_allclose(moved, drag.slipped[drag.rows, 0, 0], atol=1e-18)
        heat = np.sum(drag.tangential[1:, 0, 0] * np.diff(drag.slipped[:, 0, 0]))
        self.assertAlmostEqual(np.sum(force[1:] * np.diff(moved)) / heat, 1, delta=1e-9)

    def test_choose_the_row_with_most_points_of_both_states(self):
        history, _ = self.history()
        row = history.mixed_row()
        both = [min((one == STICK).sum(), (one == SLIP).sum()) for one in history.state]
        self.assertEqual(both[row], max(both))
        self.assertGreater(both[row], 20)

    def test_draw_each_step_in_the_state_at_its_end(self):
        history, _ = self.history(form="point", touches=3)
        self.assertEqual(len(history.episodes), 2)
        state, drawn = history.state[:, 0], 0
        values = np.arange(len(state)) + 1.0
        for value in (OPEN, STICK, SLIP):
            found = parts(history, values, state == value)
            for a, b in zip(found[:-1], found[1:]):
                if not np.isnan(a + b):
                    self.assertEqual(b, a + 1)
                    self.assertEqual(state[int(b) - 1], value)
                    drawn += 1
        self.assertEqual(
            drawn, len(state) - len(history.episodes)
        )  # the first row of an episode ends no line
        for value in (0, 1):  # states that alternate
            found = parts(history, values, np.arange(len(state)) % 2 == value)
            steps = [(a, b) for a, b in zip(found[:-1], found[1:]) if not np.isnan(a + b)]
            self.assertGreater(len(steps), len(state) // 2 - 3)
            self.assertEqual({(int(b) - 1) % 2 for _, b in steps}, {value})

    def test_map_a_cell_of_several_steps_as_slip_if_one_of_them_slips(self):
        history, _ = self.history()
        k, m = history.state.shape
        grid = Grid(history, history.rubbing, 80, 1000)
        self.assertEqual((grid.columns, len(grid.order), grid.left_out), (80, m, 0))
        np.testing.assert_array_equal(
            grid.largest(history.states), history.state.reshape(80, k // 80, m).max(axis=1)[:, grid.order]
        )
        few = Grid(history, history.rubbing, 80, 10)
        self.assertEqual((len(few.order), few.left_out), (10, m - 10))
        self.assertEqual(
            (few.where[0], few.where[-1]), (grid.where[0], grid.where[-1])
        )  # spread from end to end
        most = Grid(history, history.rubbing, 80, 10, by_impulse=True)
        np.testing.assert_allclose(np.sort(history.impulse()[most.order]), np.sort(history.impulse())[-10:])


class Pictures(FrictionTest):
    def energy(self, path):
        with matplotlib.rc_context(STYLE):
            return energy_picture(LoadedResult(path))

    def test_are_drawn_with_friction_only_if_there_is_any(self):
        path, _ = friction_file.write(self.folder / "rubbed")
        self.enterContext(unittest.mock.patch.object(pictures, "save"))
        found = list(pictures.draw(path, self.folder / "pictures"))
        names = ["contact", "friction", "snapshots", "energy"]
        self.assertEqual([p.name for p in found], [f"rubbed-{name}.png" for name in names])
        for more, names in [
            ({"form": "line", "friction": STRIBECK}, ["contact", "friction", "snapshots", "energy"]),
            ({"friction": None}, ["contact", "snapshots", "energy"]),
        ]:
            path, _ = friction_file.write(self.folder / "rubbed", **more)
            found = pictures.figures(LoadedResult(path), path.parent, lambda _: None)
            self.assertEqual([name for name, _ in found], names)

    def test_of_friction_need_a_touch(self):
        path, drag = friction_file.write(self.folder / "rubbed")
        with edited(path) as file:
            for name in list(file["contact"]):
                if len(file[f"contact/{name}"]) == len(drag.rows):
                    old = file[f"contact/{name}"][:0]
                    del file[f"contact/{name}"]
                    file[f"contact/{name}"] = old
        notes = []
        self.enterContext(unittest.mock.patch.object(pictures, "save"))
        self.assertEqual(
            [p.name for p in pictures.draw(path, note=notes.append)],
            ["rubbed-contact.png", "rubbed-energy.png"],
        )
        self.assertIn("no picture of friction: no point with friction touched", notes)

    def test_show_the_forces_the_bound_and_the_states(self):
        history, drag = self.history()
        with matplotlib.rc_context(STYLE):
            figure = friction_picture(history)
        top, pressure, states, loop, patch, bar = (
            figure.axes[0],
            *figure.axes[1:3],
            *figure.axes[-2:],
            figure.axes[3],
        )
        lines = {line.get_label(): line.get_ydata() for line in top.lines}
        self.assertEqual(list(lines), ["normal force, Σ λ", "μ Σ λ, with μ = 0.4", "friction, |Σ τ|"])
        np.testing.assert_allclose(np.nanmax(lines["normal force, Σ λ"]), drag.force.sum(axis=1).max())
        np.testing.assert_allclose(
            np.nanmax(lines["friction, |Σ τ|"]), np.linalg.norm(drag.tangential.sum(axis=1), axis=1).max()
        )
        # The friction of one step is shown in that step: steps end at their times.
        row = drag.rows[100]
        line = next(line for line in top.lines if line.get_label() == "friction, |Σ τ|")
        at = np.flatnonzero(np.isclose(line.get_xdata(), 1e3 * drag.time[row]))[0]
        self.assertAlmostEqual(line.get_ydata()[at], np.linalg.norm(drag.tangential[row].sum(axis=0)))
        (image,) = states.images
        grid = Grid(history, history.rubbing, 1000, 400)
        np.testing.assert_array_equal(np.asarray(image.get_array()), history.state[:, grid.order].T)
        for value, colour in enumerate(STATE):
            np.testing.assert_allclose(image.cmap(image.norm(value))[:3], to_rgb(colour), atol=1e-6)
        self.assertEqual(
            [ax.get_ylabel() for ax in (top, loop, patch, bar)],
            ["force (N)", "friction on floor (N)", "across (mm)", "pressure (MPa)"],
        )
        self.assertEqual(
            [ax.get_xlabel() for ax in (states, loop, patch)],
            ["time (ms)", "displacement of block relative to floor (µm)", "along friction (mm)"],
        )
        row = history.mixed_row()
        shown = {
            to_rgb(colour): len(points.get_offsets())
            for points in patch.collections[:3]
            for colour in [points.get_facecolor()[0][:3]]
            if len(points.get_offsets())
        }
        self.assertEqual(
            shown, {to_rgb(STATE[v]): int((history.state[row] == v).sum()) for v in (STICK, SLIP)}
        )
        self.assertEqual(len(pressure.images), 1)

    def test_of_every_eighth_step_are_points_and_no_area(self):
        path, drag = friction_file.write(self.folder / "rubbed")
        with edited(path) as file:
            file.attrs["scene"] = np.bytes_(file.attrs["scene"].replace(b"\nevery = 1", b"\nevery = 8"))
            file["contact"].attrs["step"] *= 8
            rows = len(drag.rows)
            for name, data in file["contact"].items():
                if len(data) == rows:
                    kept = data[drag.rows % 8 == 0]
                    del file[f"contact/{name}"]
                    file[f"contact/{name}"] = kept
            for name in ("time", *(f"energy/{term}" for term in file["energy"])):
                kept = file[name][::8]
                del file[name]
                file[name] = kept
            for name in ("velocity", "momentum", "angular_momentum", "reaction"):
                kept = file[f"bodies/block/{name}"][::8]
                del file[f"bodies/block/{name}"]
                file[f"bodies/block/{name}"] = kept
        history = LoadedResult(path)
        with matplotlib.rc_context(STYLE):
            figures = [contact_picture(history), friction_picture(history)]
        for figure, panel in zip(figures, (2, 0)):
            ax = figure.axes[panel]
            self.assertIn("every 8th step", ax.get_title(loc="left"))
            self.assertEqual({line.get_drawstyle() for line in ax.lines}, {"default"})
            self.assertFalse(
                [c for c in ax.collections if "FillBetween" in type(c).__name__ or c.get_alpha()]
            )
        total = next(line for line in figures[0].axes[2].lines if "sum" in line.get_label())
        stored = drag.rows[drag.rows % 8 == 0]
        np.testing.assert_allclose(
            total.get_ydata()[~np.isnan(total.get_ydata())], drag.force[stored].sum(axis=1), rtol=1e-6
        )
        force = charts.force_chart(history, history.strongest)
        self.assertIn("the area is not the impulse", force["note"])
        self.assertNotIn("filled", " ".join(line["style"] for line in force["lines"]))

    def test_of_friction_show_episodes_that_are_shorter_than_a_pixel(self):
        """Five touches, of one step each, in 20 000 steps: each has a column of at least two pixels."""
        history, _ = self.history(form="point")
        t = history.time[0] + friction_file.STEP * np.array([1, 2000, 7777, 15001, 20000])
        history.contact_time, history.episodes = t, [(k, k + 1) for k in range(5)]
        grid = Grid(history, history.rubbing, COLUMNS, ROWS)
        self.assertEqual(len(set(grid.column)), 5)
        pixels = 0.8 * WIDTH * DPI  # of the narrowest map, beside a scale of colours
        self.assertGreaterEqual(pixels / grid.columns, 2)

    def test_label_a_place_that_is_round_off_as_0(self):
        history, _ = self.history(form="line")
        grid = Grid(history, history.rubbing, COLUMNS, ROWS)
        grid.where = np.array([-4e-3, -2e-3, -3.42e-18, 2e-3, 4e-3])
        grid.order = grid.order[:5]
        ax = Figure().subplots()
        place_axis(grid, ax)
        self.assertEqual([label.get_text() for label in ax.get_yticklabels()], ["−4", "−2", "0", "2", "4"])

    def test_join_no_points_that_are_far_apart(self):
        history, drag = self.history(form="line")
        apart = np.abs(drag.point[:, 0]) > 3e-3  # the ends alone touch, 6 mm apart
        ends = np.flatnonzero(apart)
        where = drag.point[ends, 0]
        history.area[:] = 1e-8  # patches of 0.1 mm, 0.2 mm apart
        self.assertEqual(far_apart(history, ends, where).tolist(), [len(ends) // 2])

    def test_show_two_bounds_if_friction_falls_with_the_speed(self):
        history, _ = self.history(form="line", friction=STRIBECK)
        with matplotlib.rc_context(STYLE):
            names = [line.get_label() for line in friction_picture(history).axes[0].lines]
        self.assertIn("static bound, 0.5 Σ λ", names)
        self.assertIn("dynamic bound, 0.4 Σ λ", names)

    def test_have_no_texts_that_overlap(self):
        for more in ({"form": "line", "friction": STRIBECK}, {"form": "point", "touches": 3}):
            history, _ = self.history(**more)
            with matplotlib.rc_context(STYLE):
                for figure in (friction_picture(history), contact_picture(history)):
                    FigureCanvasAgg(figure).draw()
                    outer = figure.bbox
                    boxes = []
                    for ax in figure.axes:
                        for text in (ax.title, ax._left_title, ax.xaxis.label, ax.yaxis.label):
                            if text.get_text():
                                boxes.append((text.get_text(), text.get_window_extent()))
                    boxes += [(t.get_text(), t.get_window_extent()) for t in figure.legends[0].get_texts()]
                    for k, (name, box) in enumerate(boxes):
                        self.assertTrue(box.x0 >= 0 and box.x1 <= outer.x1 and box.y0 >= 0, name)
                        for other, second in boxes[:k]:
                            self.assertFalse(box.overlaps(second), f"{name} / {other}")

    def test_of_the_contact_mark_when_the_point_sticks_and_slips(self):
        history, drag = self.history(form="point", touches=3)
        with matplotlib.rc_context(STYLE):
            ax = contact_picture(history).axes[2]
        strips = {
            strip.get_label(): strip
            for strip in ax.collections
            if str(strip.get_label()).startswith("the point")
        }
        times = drag.time[drag.rows] - friction_file.STEP / 2
        for name, value in [("the point sticks", STICK), ("the point slips", SLIP)]:
            spans = [path.get_extents() for path in strips[name].get_paths()]
            inside = [any(span.x0 <= 1e3 * t <= span.x1 for span in spans) for t in times]
            np.testing.assert_array_equal(inside, history.state[:, 0] == value)
            pause = (
                1e3 * 0.5 * (drag.time[drag.rows[0]] + drag.time[drag.rows[-1]])
            )  # nothing touches in the middle
            self.assertFalse(any(span.x0 <= pause <= span.x1 for span in spans))
        self.assertIn("friction at the point", [line.get_label() for line in ax.lines])

    def test_of_the_contact_mark_touches_of_one_step_apart(self):
        rows = types.SimpleNamespace(
            states=Entries.of(np.full((6, 1), SLIP)),
            spacing=1.0,
            contact_time=np.array([1.0, 2, 3, 7, 9, 20]),
        )
        ax = Figure().add_subplot()
        state_strip(rows, ax, 0, 10)
        (slips,) = (strip for strip in ax.collections if strip.get_label() == "the point slips")
        spans = [path.get_extents() for path in slips.get_paths()]
        np.testing.assert_allclose([(s.x0, s.x1) for s in spans], [(0, 30), (60, 70), (80, 90), (190, 200)])

    def test_of_energy_contain_the_heat(self):
        for friction in ("friction = 0.4", None):
            path, drag = friction_file.write(self.folder / "rubbed", friction=friction)
            drawn = self.energy(path).axes[0].lines
            lines = {line.get_label(): line.get_ydata() for line in drawn}
            self.assertEqual("heat of friction" in lines, friction is not None)
            np.testing.assert_allclose(lines["sum of all"], lines["sum of all"][0], rtol=1e-9)
            if friction:
                np.testing.assert_allclose(
                    lines["heat of friction"] / lines["heat of friction"][-1], drag.heat / drag.heat[-1]
                )
                self.assertEqual(len({line.get_color() for line in drawn}), 8)

    def test_of_energy_show_the_decades_of_what_the_ledger_misses(self):
        path, _ = friction_file.write(self.folder / "rubbed")
        with edited(path) as file:
            file["energy/contact"][100] += 3e-5 * file["energy/kinetic"][0]
            file["energy/contact"][200] += 0.02 * file["energy/kinetic"][0]
        low = self.energy(path).axes[1]
        shown = dict(zip(*low.lines[0].get_xydata().T))
        np.testing.assert_allclose([shown[1.0], shown[2.0]], [3e-5, 0.02], rtol=1e-6)  # at 1 and 2 ms
        bottom, top = np.log10(low.get_ylim())
        self.assertEqual((bottom, top), (np.floor(np.log10(min(shown.values()))), -1))

    def test_of_one_point_have_no_places(self):
        history, _ = self.history(form="point")
        with matplotlib.rc_context(STYLE):
            forces, states, loop = friction_picture(history).axes
        self.assertEqual((len(states.get_yticks()), states.get_ylabel()), (0, ""))
        self.assertEqual(states.get_title(loc="left"), "Stick and slip")


class Pages(FrictionTest):
    def test_show_friction(self):
        result, drag = self.made()
        path, text, run = self.page(result.path)
        self.assertIsNone(re.search(r"[a-z]+://|url\((?!#)|@import|<link|src=", text))
        found = self.opened(path, "friction")
        self.numbers_agree(found, dict(result.summary))
        keys = [chart["key"] for chart in run["charts"]["contact"]]
        self.assertEqual(keys[:3], ["force", "friction", "loop"])
        friction, loop = run["charts"]["contact"][1:3]
        drawn = {line["name"]: unpacked(line["y"]) for line in friction["lines"]}
        self.assertEqual(
            list(drawn), ["friction, sum as a vector", "μ Σ λ, with μ = 0.4", "normal force, Σ λ"]
        )
        total = np.linalg.norm(drag.tangential.sum(axis=1), axis=1)
        self.assertAlmostEqual(np.nanmax(drawn["friction, sum as a vector"]) / total.max(), 1, delta=1e-6)
        self.assertAlmostEqual(
            np.nanmax(drawn["μ Σ λ, with μ = 0.4"]) / np.nanmax(drawn["normal force, Σ λ"]), 0.4, delta=1e-6
        )
        self.assertEqual([line["name"] for line in loop["lines"]], ["sticks", "slips"])
        self.assertEqual((loop["x"]["unit"], loop["y"]["unit"]), ("m", "N"))
        grid = Grid(LoadedResult(result.path), np.ones(len(drag.point), bool), charts.COLUMNS, charts.ROWS)
        np.testing.assert_array_equal(unpacked(run["states"]["state"]), drag.state[drag.rows][:, grid.order])
        terms = [line["name"] for line in run["charts"]["energy"][0]["lines"]]
        self.assertIn("heat of friction", terms)
        energy = found.one(id="energy")[2]
        self.assertIn("The first four rows together stay the same.", energy)
        rows = [row[2] for row in found.found if row[0] == "tr"]
        self.assertTrue(any(row.startswith("heat of friction") for row in rows))
        text = found.one(id="highlights")[2]
        self.assertIn("Heat of friction", text)
        self.assertIn("Longest slip", text)
        self.assertIn("Stick and slip", found.one(id="contact")[2])

    def test_colour_forces_and_points_by_state(self):
        result, drag = self.made()
        path, text, run = self.page(result.path)
        points = run["motion"]["points"]
        times = unpacked(run["motion"]["time"])
        rows = np.rint(times / friction_file.STEP).astype(int)
        np.testing.assert_array_equal(unpacked(points["state"]), drag.state[rows])  # all points have a force
        elements = self.opened(path, "friction-states", 700, 900)
        look = self.browser.evaluate(LOOK)
        state = drag.state[drag.rows]
        colours = {OPEN: "#e2e0da", STICK: "#39507f", SLIP: "#efa500"}
        self.assertEqual(look["map"], {colours[value]: int((state == value).sum()) for value in colours})
        self.assertRegex(look["tip"], r"^2\.0?\d* ms, point \d+ at 5 mm: (sticks|slips)$")
        # At the peak of the force all points slip, and their spikes have the colour of slip.
        peak = drag.state[np.argmax(drag.force.sum(axis=1))]
        self.assertEqual(set(peak), {SLIP})
        self.assertGreater(look["motion"].get(colours[SLIP], 0), 200)
        self.assertEqual(look["motion"].get(colours[STICK], 0), 0)
        legend = elements.one(id="motion")[2]
        self.assertTrue("sticks" in legend and "slips" in legend)

    def test_of_one_point_and_of_several_touches(self):
        result, _ = self.made(form="point", touches=3, friction=STRIBECK)
        path, _, run = self.page(result.path)
        found = self.opened(path, "friction-point")
        self.numbers_agree(found, dict(result.summary))
        self.assertIsNone(run["map"])
        self.assertEqual(run["states"]["state"]["shape"][1], 1)
        self.assertIn("static bound, 0.5 Σ λ", found.one(id="chart-friction")[2])

    def test_without_friction_show_none(self):
        result, _ = self.made(friction=None)
        path, _, run = self.page(result.path)
        found = self.opened(path, "frictionless")
        self.numbers_agree(found, dict(result.summary))
        self.assertEqual(
            (run["states"], run["friction"], run["motion"]["points"]["state"]), (None, False, None)
        )
        text = " ".join(found.one(id=name)[2] for name in ("highlights", "motion", "contact", "energy"))
        self.assertFalse([word for word in ("riction", "slip", "stick") if word in text])
        self.assertIn("The first three rows together stay the same.", text)

    def test_colour_pressures_by_state(self):
        path, drag = friction_file.write(self.folder / "rubbed")
        with edited(path) as file:  # some points stick when the force is largest, one has no friction
            row = int(np.argmax(drag.force[drag.rows].sum(axis=1)))
            file["contact/state"][row, :10] = STICK
            file["contact/state"][:, 20] = OPEN
        (pressure,) = [chart for chart in run_of(path)["charts"]["contact"] if chart["key"] == "pressure"]
        counts = {line["name"]: (line["colour"], line["x"]["shape"][0]) for line in pressure["lines"]}
        m = len(drag.point)
        self.assertEqual(
            counts, {"sticks": ("stick", 10), "slips": ("slip", m - 11), "without friction": ("force", 1)}
        )

    def test_of_bodies_at_rest_colour_pressures_and_points_by_state(self):
        path, drag = friction_file.write(self.folder / "rubbed")
        row, k = int(np.argmax((drag.state[drag.rows] == STICK).sum(axis=1))), len(drag.rows)

        def one_row(name, data):
            if isinstance(data, h5py.Dataset) and len(data) in (k, len(drag.time), len(drag.time[::4])):
                kept = data[row : row + 1] if len(data) == k else data[:1]
                rows[name] = 0 * kept if name.endswith("time") else kept

        with edited(path) as file:
            rows = {}
            file.visititems(one_row)
            for name, kept in rows.items():
                del file[name]
                file[name] = kept
            file.attrs["scene"] = np.bytes_(file.attrs["scene"].replace(b"compliant", b"static"))
        force = float(drag.force[drag.rows][row].sum())
        pair = {
            "force_n": force,
            "approach_m": 1e-6,
            "contact_points": 81,
            "contact_area_m2": 1e-4,
            "peak_pressure_pa": 1e6,
        }
        summary = {
            "pairs": [pair],
            "candidates": len(drag.point),
            "warnings": [],
            "wall_s": 1.0,
            "error_estimate": None,
        }
        self.folder.joinpath("rubbed.summary.json").write_text(json.dumps(summary))
        page, _, run = self.page(path)
        found = self.opened(page, "friction-static")
        (pressure,) = run["charts"]["contact"]
        state = drag.state[drag.rows][row]
        counts = {line["colour"]: line["x"]["shape"][0] for line in pressure["lines"]}
        self.assertEqual(
            counts,
            {"stick": (state == STICK).sum()} | ({"slip": (state == SLIP).sum()} if SLIP in state else {}),
        )
        np.testing.assert_array_equal(unpacked(run["motion"]["points"]["state"]), state[None])
        self.assertNotIn("riction", found.one(id="energy")[2])
        self.assertIsNone(ricochet.Result(path).friction)


class Sweeps(FrictionTest):
    def test_tabulate_the_figures_of_friction_and_null_as_no_number(self):
        result, _ = self.made()
        found = outputs(dict(result.summary))
        self.assertEqual([found[key] for key in KEYS], [result.summary[key] for key in KEYS])
        without, _ = self.made("smooth", friction=None)
        self.assertTrue(all(math.isnan(outputs(dict(without.summary))[key]) for key in KEYS))


if __name__ == "__main__":
    unittest.main()
