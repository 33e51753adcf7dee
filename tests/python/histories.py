# SPDX-License-Identifier: BSD-2-Clause
"""What pictures and pages draw from a result: episodes, motion, spectra, snapshots. With files that friction_file.py makes
without a run, and closed forms."""

import base64
import types
import unittest
from unittest import mock
from xml.etree import ElementTree

import matplotlib
import numpy as np
from matplotlib.figure import Figure

import friction_file
from friction_file import AREA, MU, STEP, STEPS
from programs import ProgramTest
from ricochet.errors import InputError
from ricochet.pages import charts
from ricochet.pictures import snapshots, why_unseen
from ricochet.pictures.comparison import blow, compared, law_of, reduced_mass
from ricochet.pictures.friction import moment_panel, pressure_map
from ricochet.pictures.grid import Grid
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.modes import draw_rod, modes_picture
from ricochet.pictures.normal_axis import normal_axis
from ricochet.pictures.moving_surfaces import (
    MovingSurface,
    Poses,
    amplification,
    largest_amplification,
    moving_surfaces,
)
from ricochet.pictures.style import STYLE, prefixed
from ricochet.result_file import File
from ricochet.studies import chart as studies


def unpacked(packed):
    kinds = {"f4": "<f4", "u1": "u1", "u2": "<u2"}
    return np.frombuffer(base64.b64decode(packed["data"]), kinds[packed["type"]]).reshape(packed["shape"])


def curve(line):
    return unpacked(line["x"]), unpacked(line["y"])


class HistoryTest(ProgramTest):
    def history(self, **more):
        path, drag = friction_file.write(self.folder / "rubbed", **more)
        return LoadedResult(path), drag


class Histories(HistoryTest):
    def test_split_contact_into_episodes_that_begin_a_step_before_their_first_force(self):
        history, drag = self.history(touches=3)
        touching = (drag.force > 0).any(axis=1)
        begins = np.flatnonzero(touching[1:] & ~touching[:-1])
        ends = np.flatnonzero(touching[:-1] & ~touching[1:])
        self.assertGreater(len(begins), 1)
        np.testing.assert_allclose(history.spans(), STEP * np.stack([begins, ends], axis=1), rtol=1e-12)
        self.assertEqual(sum(stop - first for first, stop in history.episodes), touching.sum())

    def test_without_a_touch_have_no_episode_and_show_the_whole_run(self):
        history, _ = self.history(touches=0)
        self.assertEqual((history.episodes, history.spans(), history.strongest), ([], [], 0))
        np.testing.assert_allclose(history.window(), (0, STEP * STEPS))
        self.assertEqual(charts.force_chart(history, 0)["note"], "Nothing touched.")

    def test_show_the_contact_with_a_margin(self):
        history, drag = self.history()
        first, last = STEP * (drag.rows[0] - 1), STEP * drag.rows[-1]
        start, end = history.window()
        self.assertTrue(start < first and last < end <= STEP * STEPS)
        self.assertAlmostEqual(start, 0 - 0.01 * end)  # so that the axis does not cover the first force
        history.time = history.time * 3  # the same contact in a longer run
        start, end = history.window()
        self.assertAlmostEqual(end - last, 0.35 * (last - first))

    def test_hold_forces_so_that_the_area_below_them_is_the_impulse(self):
        history, drag = self.history(touches=3)
        when, force = history.force_curve(history.force.sum(axis=1))
        # A force belongs to the step that ends at its time. NaN separates episodes.
        area = np.nansum(np.diff(when) * force[1:])
        self.assertAlmostEqual(area, drag.force.sum() * STEP, places=12)
        self.assertEqual(np.isnan(when).sum(), len(history.episodes))
        when, force = history.broken(history.force.sum(axis=1))
        np.testing.assert_array_equal(force[~np.isnan(when)], history.force.sum(axis=1))
        self.assertEqual(np.isnan(when).sum(), len(history.episodes))

    def test_know_the_strongest_point_and_the_liveliest_axis(self):
        history, drag = self.history()
        self.assertEqual(history.strongest, int(np.argmax(drag.force.sum(axis=0))))
        self.assertEqual(history.liveliest_axis, 2)  # the block turns round along z
        history.velocity = {"a": np.array([[0, 0, 5.0], [1, 0, 5]]), "b": np.array([[0, 2.0, 0], [0, -2, 0]])}
        self.assertEqual(history.liveliest_axis, 1)  # a change counts, not a speed
        history.velocity = {}
        self.assertEqual(history.liveliest_axis, 0)

    def test_of_bodies_in_motion_are_not_static(self):
        self.assertFalse(self.history()[0].static)

    def test_place_points_along_a_line_or_by_their_distance(self):
        history, drag = self.history(form="line")
        order, where, what = history.positions()
        self.assertEqual(what, "position along the contact")
        np.testing.assert_allclose(where, np.linspace(-4e-3, 4e-3, 41), atol=1e-9)
        np.testing.assert_array_equal(order, np.arange(41))
        history.point_a[19, 0] = 3.42e-15  # round-off, which would stand on an axis
        _, where, _ = history.positions()
        self.assertEqual(np.count_nonzero(where == 0), 2)
        history, drag = self.history()
        order, where, what = history.positions()
        self.assertEqual(what, "distance from the first touch")
        np.testing.assert_allclose(where, np.sort(np.hypot(*drag.point[:, :2].T)), atol=1e-9)
        history, _ = self.history(form="point")
        self.assertEqual(history.positions()[2], "distance from the first touch")  # one point is no line

    def test_show_the_height_above_a_floor(self):
        history, drag = self.history()
        i = int(np.argmax(drag.gap))
        place, speed, mean_place, mean_speed = history.along_normal(i)
        names = ["block", "floor"]
        self.assertEqual(
            [list(of) for of in (place, speed, mean_place, mean_speed)], [names, names, ["block"], ["block"]]
        )
        # The normal is -z, out of the block; heights are along z.
        time = drag.time[drag.rows]
        np.testing.assert_allclose(
            place["block"][1][:-1], drag.gap[i] - 1e-6 * np.sin(1e3 * time), atol=1e-15
        )
        np.testing.assert_allclose(speed["block"][1][:-1], -1e-6 * np.sin(1e3 * time), atol=1e-15)
        np.testing.assert_array_equal(place["floor"][1][:-1], 0)
        # The block moves along z at -0.06 cos(πt/T): down, then up. 1e-4: trapezia of 400 steps.
        total = STEP * STEPS
        np.testing.assert_allclose(
            mean_speed["block"][1], -0.06 * np.cos(np.pi * drag.time / total), atol=1e-12
        )
        path = -0.06 * total / np.pi * np.sin(np.pi * drag.time / total)
        np.testing.assert_allclose(mean_place["block"][1] - drag.gap[i], path, atol=1e-4 * abs(path).max())

    def test_point_out_of_the_side_that_is_still(self):
        floor, wall = {"obstacles": {"floor": {}}}, {"obstacles": {"wall": {}}}
        fall = {"loads": {"gravity": [0, -9.81, 0]}}
        fixed = {"bodies": {"lower": {"support": {"rim": "xyz"}}, "upper": {"support": {}}}}
        down, across, up = np.array([0, -1.0, 0]), np.array([1.0, 0, 0]), np.array([0, 1.0, 0])
        like = {"upper": 1.0, "lower": 2.0}
        for sides, normal, scene, masses, expected in [
            (("ball", "floor"), down, floor | fall, {"ball": 1}, (-1, "floor", "height above the floor")),
            (("ball", "floor"), down, floor, {"ball": 1}, (-1, "floor", "distance from the floor")),
            (("ball", "wall"), across, wall | fall, {"ball": 1}, (-1, "wall", "distance from the wall")),
            (("upper", "lower"), down, fixed | fall, like, (-1, "lower", "height above lower")),
            (("lower", "upper"), up, fixed | fall, like, (1, "lower", "height above lower")),
            (("upper", "lower"), down, fall, like, (1, "lower", "position towards lower")),
            (("upper", "lower"), down, {}, {"upper": 1, "lower": 10}, (-1, "lower", "distance from lower")),
            (("upper", "lower"), down, {}, {"upper": 10, "lower": 1}, (1, "upper", "distance from upper")),
            (("side a", "side b"), down, floor | fall, like, (1, "side b", "position towards side b")),
        ]:
            axis = normal_axis(sides, normal, scene, masses)
            self.assertEqual((axis.sign, axis.origin, axis.position), expected)
            way = "towards" if "towards" in axis.position else "away from"
            of = f"the {axis.origin}" if axis.origin in ("floor", "wall") else axis.origin
            self.assertEqual(axis.velocity, f"velocity {way} {of}")

    def test_put_the_zero_where_the_still_side_began(self):
        history, drag = self.history()
        i = int(np.argmax(drag.gap))
        moved = 1e-6 * np.sin(1e3 * drag.time[drag.rows])
        # The block fixed by a support, before a free "floor": the axis points out of the block.
        scene = {
            "bodies": {"block": {"support": {"foot": "xyz"}}, "floor": {}},
            "contact": {"between": ["block", "floor"]},
        }
        masses = types.SimpleNamespace(mass=1.0)
        with mock.patch.object(history, "scene", scene), mock.patch.object(
            history, "bodies", {"block": masses, "floor": masses}
        ):
            place, speed, mean_place, _ = history.along_normal(i)
        np.testing.assert_allclose(place["block"][1][:-1], moved, atol=1e-15)
        np.testing.assert_allclose(place["floor"][1][:-1], drag.gap[i], atol=1e-15)
        np.testing.assert_allclose(speed["block"][1][:-1], moved, atol=1e-15)
        self.assertEqual(mean_place["block"][1][0], 0)

    def test_know_the_pair_of_a_point(self):
        history, _ = self.history()
        pairs = [{"between": ["block", "floor"]}, {"between": ["block", "wall"]}]
        with mock.patch.object(history, "scene", {"contact": {"pair": pairs}}):
            self.assertEqual(history.sides_names(0), ("side a", "side b"))  # files of earlier versions
            history.pair = np.array([1, 2])
            self.assertEqual(history.sides_names(0), ("block", "floor"))
            self.assertEqual(history.sides_names(1), ("block", "wall"))


class Charts(HistoryTest):
    def test_of_motion_show_the_lines_of_the_history_within_its_window(self):
        history, drag = self.history()
        i = history.strongest
        places, speeds = charts.along_normal_charts(history, i)
        self.assertEqual(places["y"]["label"], "distance from the floor")
        self.assertEqual(speeds["y"]["label"], "velocity away from the floor")
        self.assertEqual(speeds["note"], "Those of contact points are means over the steps.")
        for found, of, unit in ((places, 0, "m"), (speeds, 1, "m/s")):
            self.assertEqual(found["y"]["unit"], unit)
            curves = history.along_normal(i)
            expected = {f"{name}, contact point": values for name, values in curves[of].items()}
            inside = (drag.time >= history.window()[0]) & (drag.time <= history.window()[1])
            time, mean = curves[of + 2]["block"]
            expected["block, mean of its mass"] = time[inside], mean[inside]
            self.assertEqual({line["name"] for line in found["lines"]}, set(expected))
            for line in found["lines"]:
                for shown, exact in zip(curve(line), expected[line["name"]]):
                    np.testing.assert_allclose(shown, exact, rtol=1e-6, atol=1e-12)
                self.assertEqual(line["colour"], "still" if "floor" in line["name"] else 0)

    def test_of_force_show_the_sum_and_one_point_at_the_ends_of_their_steps(self):
        history, drag = self.history()
        i = history.strongest
        total, one = charts.force_chart(history, i)["lines"]
        self.assertEqual((total["name"], one["name"]), (f"sum of {len(drag.point)} points", f"point {i + 1}"))
        for line, force in ((total, drag.force.sum(axis=1)), (one, drag.force[:, i])):
            when, shown = curve(line)
            np.testing.assert_allclose(shown[1:-2], force[drag.rows], rtol=1e-6)
            np.testing.assert_allclose(when[1:-2], drag.time[drag.rows], rtol=1e-6)
            np.testing.assert_array_equal(shown[[0, -2]], 0)
        self.assertEqual(
            [line["name"] for line in charts.force_chart(self.history(form="point")[0], 0)["lines"]],
            ["force"],
        )

    def test_of_pressure_show_the_moment_of_the_largest_force(self):
        history, drag = self.history(friction=None)
        (line,) = charts.pressure_chart(history)["lines"]
        where, pressure = curve(line)
        force = drag.force[np.argmax(drag.force.sum(axis=1))]
        self.assertAlmostEqual(pressure.max() / (force.max() / AREA), 1, places=6)
        self.assertAlmostEqual(pressure.sum() / (force.sum() / AREA), 1, places=6)
        self.assertEqual(where[np.argmax(pressure)], 0)
        count = np.count_nonzero(force)
        self.assertEqual(
            charts.pressure_chart(history)["note"],
            f"{count} of {len(force)} points press when the force is largest.",
        )

    def test_of_energy_show_each_term_that_is_not_zero_and_their_constant_sum(self):
        history, drag = self.history(friction=None)
        energy = charts.energy_charts(history)[0]
        lines = {line["name"]: curve(line)[1] for line in energy["lines"]}
        total = lines.pop("sum of all")
        np.testing.assert_allclose(sum(lines.values()), total, rtol=1e-5)
        np.testing.assert_allclose(total, total[0], rtol=1e-6)
        self.assertEqual(energy["note"], "")
        history.energy["damping"] = 0 * history.time
        self.assertEqual(charts.energy_charts(history)[0]["note"], "Zero throughout: lost in damping.")
        history, _ = self.history(friction=None)  # the ledger is kept
        history.energy["total"] = history.energy["total"] + np.where(history.time > 1e-3, 1e-6, 0)
        (line,) = charts.energy_charts(history)[1]["lines"]
        when, stray = curve(line)
        largest = max(abs(history.energy[name]).max() for name in ("kinetic", "strain", "loads", "residual"))
        largest = max(largest, abs(history.ledger).max())
        np.testing.assert_allclose(stray[when > 1.005e-3], 1e-6 / largest, rtol=1e-5)
        self.assertLess(stray[when < 0.995e-3].max(initial=0), 1e-12)  # round-off

    def test_of_many_points_keep_gaps_and_the_extremes_of_each_piece(self):
        x, y = np.arange(20000.0), np.sin(np.arange(20000.0) ** 1.3)
        y[[777, 12345]] = [5, -7]
        y[9000:9050] = np.nan
        when, shown = charts.thinned(x, y)
        self.assertLess(len(when), charts.DOTS + charts.DOTS // 2)
        self.assertTrue(np.all(np.diff(when) > 0))
        self.assertEqual((np.nanmax(shown), np.nanmin(shown)), (5, -7))
        self.assertEqual((when[np.nanargmax(shown)], when[np.nanargmin(shown)]), (777, 12345))
        self.assertTrue(np.isnan(shown).any())
        known = when[~np.isnan(shown)].astype(int)
        np.testing.assert_array_equal(y[known], shown[~np.isnan(shown)])
        self.assertIs(charts.thinned(x[:1600], y[:1600])[1].base, y)

    def test_of_receivers_show_the_amplitude_of_their_tones(self):
        path, drag = friction_file.write(self.folder / "rubbed")
        tone, amplitude = 1 / (40 * STEP), 0.02  # ten periods
        velocity = np.zeros((STEPS + 1, 3))
        velocity[:, 1] = 0.3 + amplitude * np.sin(2 * np.pi * tone * drag.time)  # the mean is left out
        with friction_file.edited(path) as file:
            file["receivers/time"] = drag.time
            for name, moved in (("mic", velocity), ("still", 0 * velocity)):
                group = file.create_group(f"receivers/{name}")
                group["velocity"], group["displacement"], group["acceleration"] = moved, moved, moved
        history = LoadedResult(path)
        np.testing.assert_array_equal(history.receivers["mic"].velocity, velocity)
        found = charts.receiver_charts(history)
        motion, spectrum = found["mic"]
        self.assertEqual([line["name"] for line in motion["lines"] + spectrum["lines"]], ["y", "y"])
        np.testing.assert_allclose(curve(motion["lines"][0])[1], velocity[:, 1], rtol=1e-6)
        frequency, size = curve(spectrum["lines"][0])
        self.assertAlmostEqual(size.max(), amplitude, delta=0.01 * amplitude)
        self.assertAlmostEqual(frequency[np.argmax(size)], tone, delta=1 / (8 * STEPS * STEP))
        self.assertLess(
            size[frequency > 2 * tone].max(), 1e-3 * amplitude
        )  # Hann's window falls with the cube
        self.assertEqual([of["lines"] for of in found["still"]], [[], []])
        self.assertEqual(found["still"][0]["note"], "It does not move.")


class Spectra(unittest.TestCase):
    def test_of_a_pulse_are_the_closed_form_at_every_frequency(self):
        count, step, factor = 100, 1e-3, 0.25
        frequency, size = charts.spectrum(np.ones(count), step, factor)
        half = np.pi * frequency * step
        np.testing.assert_allclose(size, factor * abs(np.sin(count * half) / np.sin(half)), atol=1e-9)
        self.assertTrue(np.all(np.diff(frequency) > 0))
        lowest = 0.5 / (
            count * step
        )  # half a period in the record, on a grid of at least eight times its length
        self.assertTrue(lowest <= frequency[0] <= 1.2 * lowest)
        self.assertLess(0.9 * 0.5 / step, frequency[-1])
        self.assertLess(len(frequency), 8 * count)

    def test_of_a_record_of_few_steps_have_few_frequencies(self):
        self.assertLessEqual(len(charts.spectrum(np.arange(10.0), 1e-3, 1)[0]), 8 * 10)

    def test_of_a_tone_have_its_frequency_and_amplitude(self):
        count, step, tone, amplitude = 4000, 1 / 8000, 440.0, 3.0
        values = amplitude * np.sin(2 * np.pi * tone * step * np.arange(count))
        frequency, size = charts.spectrum(values, step, 2 / count)
        peak = int(np.argmax(size))
        self.assertAlmostEqual(frequency[peak], tone, delta=1 / (8 * count * step))
        self.assertAlmostEqual(
            size[peak], amplitude, delta=0.03 * amplitude
        )  # the grid, and the other side's leakage


class Snapshots(HistoryTest):
    def surfaces(self, **more):
        history, drag = self.history(**more)
        surfaces, time = moving_surfaces(history, self.folder)
        return history, drag, surfaces, time

    def test_are_those_moved_by_the_coordinates_and_only_their_deformation_is_magnified(self):
        _, drag, surfaces, time = self.surfaces()
        surface = surfaces["block"]
        np.testing.assert_allclose(time, drag.time[::4])
        bent = np.abs(surface.node[:, 0]) * surface.node[:, 2] / 1e-4  # along z for a coordinate of 1
        size = np.linalg.norm(np.ptp(surface.node, axis=0))
        for k in (0, 31, 77):
            amount = 1e-6 * np.sin(4e3 * time[k])
            for factor in (0, 1, 50):
                expected = surface.node + drag.moved[4 * k] + np.outer(factor * amount * bent, [0, 0, 1])
                np.testing.assert_allclose(surface.at(k, factor), expected, atol=1e-12)
            np.testing.assert_array_equal(surface.at(k), surface.at(k, 1))
            self.assertAlmostEqual(surface.deformation(k), abs(amount) * bent.max(), places=12)
            self.assertAlmostEqual(surface.strain(k), abs(amount) * bent.max() / size, places=10)

    def test_are_magnified_by_a_round_number_that_shows_the_deformation(self):
        # 0.1 of the size is drawn at most, and more than 0.04, because round numbers are at most 2.5 apart.
        for share, factor in ((1e-3, 100), (9e-4, 100), (3e-4, 200), (1.9e-6, 50000), (0.0099, 10)):
            self.assertAlmostEqual(amplification(share), factor)
        for share in (0, 1e-15, 0.01, 0.3):  # nothing but round-off, or visible as it is
            self.assertEqual(amplification(share), 1)
        for share, most in ((1e-3, 250), (1e-5, 25000), (0.01, 25), (0.5, 2), (0, 2)):
            self.assertAlmostEqual(largest_amplification(share), most)

    def test_are_drawn_at_moments_that_differ_from_the_one_before_as_much_as_nine_can(self):
        # A bump that passes within a hundredth of the time, between long rests: even times would miss it.
        time = np.linspace(0, 1, 2001)
        path = np.stack([np.exp(-(((time - 0.3) / 0.005) ** 2)), np.zeros_like(time)], axis=1)
        chosen = snapshots.moments(path, 9)
        steps = np.linalg.norm(np.diff(path[chosen], axis=0), axis=1)
        # The path has a length of 2. With steps of at least d, eight need 8 d of it.
        self.assertEqual((len(chosen), chosen[0]), (9, 0))
        self.assertTrue(0.18 < steps.min() <= 2 / 8, steps)
        self.assertTrue(np.all(np.diff(chosen) > 0))
        self.assertEqual(snapshots.moments(path[:5], 9).tolist(), [0, 1, 2, 3, 4])
        self.assertEqual(snapshots.moments(path[:1], 9).tolist(), [0])

    def test_are_compared_by_the_mean_distance_of_the_nodes_as_drawn(self):
        _, _, surfaces, _ = self.surfaces()
        (surface,), during = surfaces.values(), np.array([3, 40, 77])
        for factor in (1, 300):
            path = snapshots.drawn_path(surfaces, during, factor)
            for a, b in ((0, 1), (1, 2), (0, 2)):
                apart = surface.at(during[a], factor) - surface.at(during[b], factor)
                exact = np.sqrt((apart**2).sum(axis=1).mean())
                self.assertAlmostEqual(np.linalg.norm(path[a] - path[b]) / exact, 1, places=5)  # of 32 bits

    def test_show_nearer_bodies_in_front(self):
        square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])

        def made(z):
            return square + [0, 0, z], types.SimpleNamespace(
                element=np.array([[0, 1, 2], [0, 2, 3]]), rim=lambda flat: np.array([[0, 1]])
            )

        result = types.SimpleNamespace(bodies=["low", "high"])
        for turn, order in ((np.eye(3), [0, 1]), (np.diag([-1, 1, -1]), [1, 0])):
            (low, below), (high, above) = made(0), made(1)
            ax = Figure().add_subplot()
            fields = {"low": np.zeros(4), "high": np.full(4, 2.0)}
            bodies, places = {"low": below, "high": above}, {"low": low, "high": high}
            snapshots.paint(ax, result, bodies, places, turn, fields, 2.0)
            (drawn,) = ax.collections
            faces, paths = drawn.get_facecolors()[:, :3], drawn.get_paths()
            light = 0.62 + 0.38 * 0.8 / np.linalg.norm([0.35, 0.5, 0.8])  # of a face towards the viewer
            filled = [k for k, path in enumerate(paths) if len(path.vertices) > 3]
            found = [
                next(
                    n
                    for n in (0, 1)
                    if np.allclose(faces[k], light * np.array(snapshots.COLOURS(float(n))[:3]))
                )
                for k in filled
            ]
            self.assertEqual(found, [order[0]] * 2 + [order[1]] * 2)

    def test_have_outlines_without_the_edges_that_the_body_itself_hides(self):
        square = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0.0]])
        node = np.concatenate(
            [square, 0.25 * square + [0.5, 0.5, -1], 0.25 * square + [0.5, 0.5, 1], square + [1, 1, -2]]
        )
        element = (np.array([[0, 1, 2], [0, 2, 3]]) + 4 * np.arange(4)[:, None, None]).reshape(-1, 3)
        surface = types.SimpleNamespace(element=element, rim=lambda flat: MovingSurface.rim(surface, flat))
        edges = {tuple(edge) for edge in snapshots.unhidden(surface, node)}
        around = [(0, 1), (1, 2), (2, 3), (0, 3)]
        # The small square behind is hidden, that in front is not. Of the last one, half of two sides is behind the first.
        whole = {(a + first, b + first) for first in (0, 8) for a, b in around}
        self.assertEqual(edges - {(12, 13), (12, 15)}, whole | {(13, 14), (14, 15)})

    def test_of_a_rod_have_space_above_and_below(self):
        history, _, _, time = self.surfaces(form="line")
        rod = np.stack([np.linspace(0, 0.2, 5), np.zeros(5), np.zeros(5)], axis=1)
        element = np.stack([np.arange(4), np.arange(1, 5)], axis=1)
        surface = types.SimpleNamespace(
            at=lambda *_: rod,
            strain=lambda _: 1.0,
            deformations=lambda _: np.zeros(5),
            weights=lambda _: np.ones(1),
            node=rod,
            shape=np.ones((5, 3, 1)),
            coordinates=time[:, None],
            element=element,
            rim=lambda flat: element,
            poses=None,
            carried=lambda points, _: points,
        )
        figure = self.drawn(history, {"block": surface}, time)
        ax = figure.axes[0]
        margin = 0.04 * 0.2
        np.testing.assert_allclose(ax.get_ylim(), [-0.02 - margin, 0.02 + margin])
        np.testing.assert_allclose(np.ptp(ax.get_xlim()), 0.2 + 2 * margin)

    def drawn(self, *given):
        """The picture at three moments, as each takes time."""
        with matplotlib.rc_context(STYLE), mock.patch.object(snapshots, "MOMENTS", 3):
            return snapshots.snapshots_picture(*given)

    def test_are_drawn_at_some_moments_of_the_contact_or_at_those_there_are(self):
        history, drag, surfaces, time = self.surfaces()
        for some, count, words in ((slice(None), 3, "3 moments"), (slice(40, 41), 1, "one moment")):
            figure = self.drawn(history, surfaces if count > 1 else self.only(surfaces, 40), time[some])
            titles = [ax.get_title(loc="left") for ax in figure.axes if ax.get_title(loc="left")]
            self.assertEqual(len(titles), count)
            self.assertIn(f": {words} of the contact", figure._suptitle.get_text())
            at = np.array([float(title.split()[0]) for title in titles])
            (start, end), (ms, unit) = history.spans()[0], prefixed(history.spans()[0][1], "s")
            self.assertTrue(((at > start * ms) & (at <= end * ms * 1.001)).all() and np.all(np.diff(at) > 0))
            self.assertEqual({title.split()[1] for title in titles}, {unit})
        self.assertIsNone(
            snapshots.snapshots_picture(history, surfaces, time[:2])
        )  # none of them during the contact
        # Snapshots are 4 steps of 1e-5 s apart. The contact lasts from 0.1 to 0.9 of 400 steps.
        words = "they are 4e-05 s apart, and contact lasts 0.0032 s. Set a smaller output.snapshot_every, or"
        self.assertIn(words, why_unseen(history, time))
        self.assertEqual(why_unseen(self.history(touches=0)[0], time), "nothing touched")

    def test_have_labels_that_are_not_wider_than_the_narrowest_panel(self):
        history, _ = self.history()
        order, where, _ = history.positions()
        figure = Figure((snapshots.WIDTH / 6, 2))  # three moments in a row, each beside its forces
        ax = figure.add_axes((0, 0.5, 1, 0.5))
        for what in ("distance from the first touch", "position along the contact"):
            with mock.patch.object(history, "positions", return_value=(order, where, what)):
                forces = snapshots.Forces(history, [0])
            with matplotlib.rc_context(STYLE):
                forces.draw(ax, 0, (True, True))
            figure.draw_without_rendering()
            self.assertRegex(ax.get_xlabel().replace("\n", " "), rf"^{what} \(.?m\)$")
            self.assertLess(ax.xaxis.label.get_window_extent().width, figure.bbox.width)

    def test_of_bodies_that_turn_and_touch_several_times_show_the_motion(self):
        history, _, surfaces, time = self.surfaces(touches=3)
        for surface in surfaces.values():
            upright = np.tile([1.0, 0, 0, 0], (len(time), 1))
            surface.poses = Poses(0.01 * time[:, None] * [[1, 0, 0]], upright, np.zeros(3))
        figure = self.drawn(history, surfaces, time)
        bodies = [ax for ax in figure.axes if not ax.axison]
        # A scale of colours, but no panels of forces, which act at few of these moments.
        self.assertEqual((len(bodies), len(figure.axes)), (3, 4))
        self.assertIn(": 3 moments of the motion\ntrue to scale", figure._suptitle.get_text())
        spans = history.spans()
        scale = prefixed(spans[-1][0], "s")[0]
        at = [float(ax.get_title(loc="left").split()[0]) / scale for ax in bodies]
        between = np.diff(time)[0]
        # Snapshots just before the first touch and just after the last one began, and the one between them
        self.assertAlmostEqual(at[0], spans[0][0] - between / 2, delta=0.51 * between)
        self.assertAlmostEqual(at[2], spans[1][0] + between / 2, delta=0.51 * between)
        self.assertAlmostEqual(at[1], (at[0] + at[2]) / 2, delta=between)

    @staticmethod
    def only(surfaces, first):
        """The surfaces in a result whose first snapshot is this one."""
        for surface in surfaces.values():
            surface.coordinates = surface.coordinates[first:]
        return surfaces

    def test_have_a_bar_of_a_round_length(self):
        for wide, length, words in ((0.004, 1e-3, "1 mm"), (0.3, 0.1, "0.1 m"), (25, 10, "10 m")):
            ax = Figure().add_subplot()
            snapshots.scale_bar(ax, 2, 3, wide)
            np.testing.assert_allclose(ax.lines[0].get_xydata(), [[2, 3], [2 + length, 3]])
            self.assertEqual(ax.texts[0].get_text().strip(), words)

    def test_have_a_force_of_each_point_by_its_place(self):
        history, drag = self.history(form="line")
        row = int(np.argmax(history.force.sum(axis=1)))
        panel = snapshots.Forces(history, [row])
        self.assertTrue(panel.numbered)
        ax = Figure().add_subplot()
        panel.draw(ax, 0, (True, True))
        factor, unit = prefixed(history.force[row].max(), "N")
        np.testing.assert_allclose([bar.get_height() for bar in ax.patches], factor * history.force[row])
        self.assertEqual(
            (ax.get_xlabel(), ax.get_ylabel()), ("number of the\ncontact position", f"force ({unit})")
        )
        history, drag = self.history()
        panel = snapshots.Forces(history, [row])
        self.assertFalse(panel.numbered)
        radius = np.hypot(*drag.point[:, :2].T)
        far = 1.6 * radius[drag.force.sum(axis=0) > 0].max()
        np.testing.assert_allclose(panel.where, 1e3 * np.sort(radius[radius <= far]), atol=1e-9)
        self.assertEqual(panel.label, "distance from the first touch (mm)")


class Modes(HistoryTest):
    def test_of_a_rod_are_drawn_over_the_place_along_it(self):
        along = np.array([0.6, 0.8, 0])
        place = np.array([0.3, 0, 0.1, 0.2])  # of nodes in no order
        shape = 5 * np.cos(np.pi * place / 0.3)[:, None] * along
        ax = Figure().add_subplot()
        draw_rod(ax, 2 + place[:, None] * along, shape)
        x, y = ax.lines[0].get_xydata().T
        np.testing.assert_allclose(x - x[0], [0, 0.1, 0.2, 0.3], atol=1e-12)
        np.testing.assert_allclose(y, [1, 0.5, -0.5, -1], atol=1e-12)

    def test_that_are_elastic_are_drawn_with_their_frequencies(self):
        path, _ = friction_file.write(self.folder / "rubbed")
        figure = modes_picture(File(path.with_name("rubbed.kernel.h5"), "ricochet-kernel"), 6)
        self.assertIn("block: elastic modes", figure._suptitle.get_text())
        shown = [ax for ax in figure.axes if ax.axison or ax.collections]
        self.assertEqual([ax.get_title() for ax in shown], ["mode 4: 636.62 Hz"])  # 4000 rad/s
        at_rest, moved = (np.unique(c.get_facecolor(), axis=0) for c in shown[0].collections)
        self.assertEqual(len(at_rest), 1)  # grey; the colours of the other one show the displacement
        self.assertGreater(len(moved), 20)


class Drawings(HistoryTest):
    def test_in_notebooks_have_the_force_of_the_contact(self):
        history, drag = self.history()
        page = ElementTree.fromstring(f"<div>{history._repr_html_()}</div>")
        words = page.find("svg/polyline").get("points").split()
        x, y = np.array([[float(number) for number in word.split(",")] for word in words]).T
        width, height = float(page.find("svg").get("width")), y[0]
        np.testing.assert_allclose([x[0], x[-1], y[-1]], [0, width, height])
        x, force = x[1:-1], height - y[1:-1]  # the line starts and ends at the base
        np.testing.assert_allclose(np.diff(x), width / (len(x) - 1), atol=0.11)  # rounded to 0.1
        self.assertAlmostEqual(x[-1], width)
        peak = drag.force.sum(axis=1).max()
        self.assertEqual(page.find("svg/g/text").text, f"{peak:.4g} N")
        # The contact lies within the drawing, with a margin on both sides.
        expected = drag.force.sum(axis=1) / peak * force.max()
        first = np.argmax(force > 0.05) - np.argmax(expected > 0.05)
        np.testing.assert_allclose(force, expected[-first : len(force) - first], atol=0.06)
        self.assertTrue(force[0] == 0 and force[-1] == 0)


class Cells(unittest.TestCase):
    def test_of_a_study_hold_the_mean_of_their_rows(self):
        x, y = np.array([1, 1, 2, 2, 3, 1.0]), np.array([10, 20, 10, 10, 20, 10.0])
        z = np.array([1, 2, 3, 5, 7, 100.0])
        there = np.array([True] * 5 + [False])
        figure = Figure()
        ax = figure.add_subplot()
        studies.cells(figure, ax, z, there, [(x, None), (y, None)], "force")
        np.testing.assert_array_equal(
            ax.images[0].get_array().filled(np.nan), [[1, 4, np.nan], [2, np.nan, 7]]
        )
        self.assertEqual([label.get_text() for label in ax.get_xticklabels()], ["1", "2", "3"])
        self.assertEqual([label.get_text() for label in ax.get_yticklabels()], ["10", "20"])
        self.assertEqual(
            {(t.get_position(), t.get_text()) for t in ax.texts},
            {((0, 0), "1"), ((1, 0), "4"), ((0, 1), "2"), ((2, 1), "7")},
        )


class Laws(unittest.TestCase):
    """Johnson, Contact Mechanics, 11.4: Hertz's blow lasts 2.9432 δ/v with δ = (5 m v²/(4 k))^(2/5) and gives back all momentum."""

    def test_of_hertz_have_the_peak_the_duration_and_the_impulse_of_the_closed_form(self):
        m, v, k = 0.3, 2.0, 1e9
        depth = (5 * m * v**2 / (4 * k)) ** 0.4
        when, force = blow(m, v, k, 0)
        # 1e-3: two steps of 2000; the peak lies between steps
        self.assertAlmostEqual(when[-1] * v / depth, 2.9432, delta=3e-3)
        self.assertAlmostEqual(force.max() / (k * depth**1.5), 1, delta=1e-6)
        self.assertAlmostEqual(force.sum() * when[1] / (2 * m * v), 1, delta=1e-6)

    def test_of_hunt_and_crossley_lose_what_the_restitution_says(self):
        """1e-2: their formula for χ is of first order in 1 − e."""
        m, v = 0.3, 2.0
        for e in (0.98, 0.95, 0.9):
            when, force = blow(m, v, 1e9, 1.5 * (1 - e) / v)
            self.assertAlmostEqual(force.sum() * when[1] / (m * v) - 1, e, delta=(1 - e) ** 2 + 1e-5)

    def test_have_the_mass_and_the_peak_of_the_impact(self):
        bodies = {"a": types.SimpleNamespace(mass=2.0), "b": types.SimpleNamespace(mass=3.0)}
        summary = {
            "episodes": [{"approach_m_per_s": 2.0}],
            "restitution": 0.9,
            "peak_force_n": 500.0,
            "contact_start_s": 0.25,
        }
        result = types.SimpleNamespace(
            bodies=bodies, scene={}, strongest=0, sides_names=lambda i: ("a", "b"), summary=summary, path="r"
        )
        self.assertAlmostEqual(reduced_mass(result), 1.2, delta=1e-12)
        name, when, force = compared(result, law_of("hertz"))
        self.assertEqual((name, when[0]), ("Hertz, same peak", 0.25))
        self.assertAlmostEqual(force.max(), 500, delta=1e-3)
        self.assertAlmostEqual(force.sum() * (when[1] - when[0]), 2 * 1.2 * 2.0, delta=1e-4)
        _, _, lossy = compared(result, law_of("hunt-crossley"))
        self.assertAlmostEqual(lossy.max(), 500, delta=1e-3)
        _, _, given = compared(result, law_of("hertz=1e9"))
        self.assertAlmostEqual(given.max(), 1e9 * (5 * 1.2 * 4 / 4e9) ** 0.6, delta=1)
        result.scene = {"bodies": {"b": {"support": {"foot": "xyz"}}}}
        self.assertAlmostEqual(reduced_mass(result), 2.0, delta=1e-12)
        summary["restitution"] = None
        with self.assertRaisesRegex(InputError, "--compare hertz needs a pair that approaches and parts"):
            compared(result, law_of("hertz"))
        for text in ("maxwell", "hertz=-1", "hertz=stiff"):
            self.assertRaises(ValueError, law_of, text)


class Friction(HistoryTest):
    def test_has_a_map_of_every_pressure_however_small(self):
        for size in (1, 1e-9):
            history, drag = self.history()
            history.force = size * history.force
            grid, figure = Grid(history, history.rubbing, 1000, 400), Figure()
            ax = figure.add_subplot()
            pressure_map(figure, history, grid, ax)
            shown = ax.images[0].get_array().filled(np.nan).T
            pressure = size * drag.force[drag.rows][:, grid.order] / AREA
            factor, unit = prefixed(pressure.max(), "Pa")
            np.testing.assert_array_equal(np.isnan(shown), pressure == 0)
            np.testing.assert_allclose(np.nan_to_num(shown), factor * pressure, rtol=1e-9)
            self.assertEqual(figure.axes[1].get_ylabel(), f"pressure ({unit})")

    def test_of_a_line_is_drawn_below_its_bound(self):
        for size, unit in ((1, "N"), (1e4, "kN")):
            history, drag = self.history(form="line")
            history.force, history.tangential_force = size * history.force, size * history.tangential_force
            ax = Figure().add_subplot()
            moment_panel(history, ax)
            bound, friction = (np.asarray(line.get_ydata()) for line in ax.lines[:2])
            row = drag.rows[history.mixed_row()]
            rubs = size * np.linalg.norm(drag.tangential[row], axis=1)[history.rubbing]
            factor = {"N": 1, "kN": 1e-3}[unit]
            self.assertEqual(ax.get_ylabel(), f"friction |τ| ({unit})")
            np.testing.assert_allclose(
                bound, factor * MU * size * drag.force[row][history.rubbing], rtol=1e-9
            )
            np.testing.assert_allclose(friction, factor * rubs, rtol=1e-9)
            self.assertTrue((friction <= bound * (1 + 1e-12)).all())


if __name__ == "__main__":
    unittest.main()
