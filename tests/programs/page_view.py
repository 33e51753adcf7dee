# SPDX-License-Identifier: BSD-2-Clause
"""The first screen of ricochet report, in a browser driven by its own protocol: a steel part dropped on a floor, and two rods. Sizes
come from pixels, shapes and deformations from the files of the run. `page_view.py --keep FOLDER` keeps pictures of the pages."""

import itertools
import json
import re
import shutil
import unittest
from unittest import mock

import h5py
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap

import ricochet
from page_test import PageTest
from programs import Command, impact, settings
from report_test import number, unpacked

from ricochet.pages.motion import motion_of
from ricochet.pictures import figures
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.viewpoint import View

DROP = [
    "title=drop",
    "bodies.bracket.order=1",
    "bodies.bracket.damping={loss_factor=1e-3}",
    "loads={gravity=[0,0,-9.81]}",
    "modes={up_to_hz=60e3}",
    "time.duration=3e-4",
    "output={view=true,snapshot_every=4}",
]
# As in report.py, but so thin that perspective enlarges the near side of a rod by less than a thousandth.
RODS = ["modes.count=5", "output={view=true,snapshot_every=50}", "contact.gap=0.1", "time.duration=5"] + [
    f"bodies.{name}.material.area=0.01" for name in ("moving", "resting")
]
FLOOR = [0xDE, 0xDB, 0xD3]  # the colour of a plane seen from its front
INSIDE = """(() => {
  const parts = [...document.querySelectorAll(".cockpit canvas, .cockpit button, .cockpit input, .cockpit select, .cockpit output")];
  return parts.filter(part => part.offsetHeight > 0).map(part => {
    const {left, top, right, bottom} = part.getBoundingClientRect();
    return [part.ariaLabel ?? part.textContent, left, top, right, bottom];
  });
})()"""

# Height and width of the page, what is wider than its place, top and bottom of the main figures and of the canvas, and the
# places of the first two charts of the contact.
LAYOUT = """(() => {
  const at = query => document.querySelector(query).getBoundingClientRect(), ends = query => [at(query).top, at(query).bottom];
  const wide = [...document.querySelectorAll("div.wide, pre")].filter(part => part.offsetParent && part.scrollWidth > part.clientWidth);
  const [one, two] = [...document.querySelectorAll("#contact figure")].map(part => part.getBoundingClientRect());
  const {scrollHeight, scrollWidth} = document.documentElement;
  return [scrollHeight, scrollWidth, wide.map(part => part.textContent.slice(0, 40)), ends("#highlights"), ends(".stage"),
          [one.left, two.left, one.top, two.top]];
})()"""


class OneColour(ListedColormap):
    """Colours of one kind, which keep what they are asked for."""

    def __init__(self):
        super().__init__(["#2b6cb0"])
        self.asked = []

    def __call__(self, values, *more, **named):
        self.asked.append(values)
        return super().__call__(values, *more, **named)


class Drop(PageTest):
    SCENE, SETS = "bracket", DROP

    def kernel_data(self):
        """Size of the body, places at rest and shapes (V,3,N+C) in world axes, angular frequencies, and snapshots. Behind the
        modes stand the static fields of the forces on the C components of all candidates, as infinite frequencies.
        """
        with h5py.File(self.result) as file:
            body = file["bodies/bracket"]
            turn = body.attrs["rotation"].reshape(3, 3)
            q = file["snapshots/bracket"][:]
            static = {name: data[:] for name, data in file["static/bracket"].items()}
            with h5py.File(self.out / body.attrs["kernel"].decode()) as kernel:
                size = np.linalg.norm(np.ptp(kernel["view/node"][:], axis=0))
                node = kernel["view/node"][:] @ turn.T + body.attrs["translation"]
                fields = kernel["view/residual_flexibility"][:].astype(float).reshape(len(node), 3, -1)
                shape = np.concatenate([kernel["view/shape"][:].astype(float), fields], axis=2)
                shape = np.einsum("ij,vjn->vin", turn, shape)
                omega = kernel["modes/angular_frequency"][:]
        components = static["force"].shape[1]
        force = np.zeros((len(q), fields.shape[2] // components, components))
        force[static["snapshot"].astype(int), static["candidate"].astype(int)] = static["force"]
        omega = np.append(omega, np.full(fields.shape[2], np.inf))
        q = np.concatenate([q, force.reshape(len(q), -1)], axis=1)
        return size, node, shape, omega, q

    def test_canvas_and_controls_are_in_the_window_together(self):
        for wide, high in ((1280, 800), (390, 844)):
            self.opened_at(wide, high)
            if wide == 390:
                self.browser.evaluate("document.querySelector('.cockpit').scrollIntoView()")
            names = {"Play", "Time", "Speed", "Amplification", "front", "side", "above", "reset", "Colour"}
            for shown in ("impact", "mode"):
                found = self.browser.evaluate(INSIDE)
                self.assertLessEqual(names, {name for name, *_ in found})
                for name, left, top, right, bottom in found:
                    self.assertTrue(
                        0 <= left < right <= wide and 0 <= top < bottom <= high,
                        (wide, shown, name, top, bottom),
                    )
                (canvas,) = [box for name, *box in found if name.startswith("The bodies in motion")]
                self.assertGreater(canvas[3] - canvas[1], 0.3 * high)
                self.keep(f"drop-{wide}-{shown}")
                self.browser.evaluate("document.querySelector('#modes button').click()")
                names = {
                    "Pause",
                    "Time",
                    "Speed",
                    "front",
                    "Previous mode",
                    "Next mode",
                    "Back to the impact",
                }
            self.assertLessEqual(self.browser.evaluate("document.documentElement.scrollWidth"), wide)

    def test_colours_show_the_speed_of_the_fall_at_the_start(self):
        self.opened_at(900, 600)
        speeds = self.browser.evaluate(
            """(() => { const motion = shown.motion, body = motion.bodies[0];
          motion.colour = "speed";
          motion.measure(body, ...motion.find(motion.time[0]));
          return [Math.min(...body.value), Math.max(...body.value)]; })()"""
        )
        np.testing.assert_allclose(speeds, 0.5, rtol=2e-3)  # gravity adds 4e-4 in the first snapshot

    def test_the_floor_is_seen_from_above_with_gravity_down_and_is_glass_from_beneath(self):
        self.opened_at(900, 600)
        self.browser.evaluate("shown.motion.bodies[0].visible = shown.motion.arrows = false, shown.show()")

        def floor():
            """Where the floor is drawn: opaque, and as glass."""
            pixels = self.pixels()
            return (pixels[..., 3] == 255) & (abs(pixels[..., :3] - FLOOR).max(axis=2) <= 1), (
                pixels[..., 3] > 40
            ) & (pixels[..., 3] < 90)

        opaque, glass = floor()
        rows = np.flatnonzero(opaque.any(axis=1))
        self.assertGreater(opaque.mean(), 0.02)
        self.assertLess(glass.mean(), 1e-3)  # the edges of the opaque floor
        self.assertGreater(rows.min(), 0.4 * len(opaque))  # the bodies are above it
        down, triad = self.browser.evaluate(
            """(() => { const arrow = document.querySelector('.overlay .gravity');
          const line = document.querySelector('.overlay line[data-axis="z"]');
          return [arrow.dataset.down, line.getAttribute("y1") - line.getAttribute("y2")]; })()"""
        )
        self.assertGreater(float(down), 0.7)
        self.assertGreater(float(triad), 15)  # pixels by which z points up
        text = self.browser.evaluate("document.querySelector('.overlay .gravity text').textContent")
        self.assertEqual(text, "gravity 9.81 m/s²")
        self.assertGreater(opaque.mean(), 0.02)
        self.pressed("above")
        seen_from_above, _ = floor()
        self.assertGreater(seen_from_above.mean(), 2 * opaque.mean())
        self.browser.evaluate("shown.motion.look(0, -0.6), shown.show()")
        opaque, glass = floor()
        self.assertEqual(opaque.sum(), 0)
        self.assertGreater(glass.mean(), 0.02)
        self.pressed("reset")
        self.assertGreater(floor()[0].mean(), 0.02)

    def test_amplification_reaches_a_quarter_of_the_size_and_leaves_rigid_motion_as_it_is(self):
        size, node, shape, omega, q = self.kernel_data()
        elastic = omega > 0
        bent = np.einsum("vjn,sn->svj", shape[..., elastic], q[:, elastic])
        largest = np.linalg.norm(bent, axis=2).max()
        self.opened_at(900, 600)
        slider = "document.querySelector('[aria-label=Amplification]')"
        natural, most = self.browser.evaluate(f"[shown.motion.amplify, 10 ** {slider}.max]")
        self.assertTrue(
            0.03 < natural * largest / size <= 0.11, natural
        )  # the default is that of the contact
        self.assertAlmostEqual(
            most * largest / size, 0.25, delta=0.005
        )  # few shapes, and the few digits of the slider
        self.assertTrue(self.node_of_tree("slider", "Amplification")["focusable"])
        self.assertEqual(self.browser.evaluate(f"{slider}.ariaValueText"), f"× {natural:g}")
        self.browser.evaluate(f"{slider}.focus()")
        self.browser.press("End")
        shown = self.browser.evaluate("shown.motion.amplify")
        self.assertAlmostEqual(shown / most, 1, delta=0.06)  # two digits
        self.assertEqual(number(self.browser.evaluate(f"{slider}.ariaValueText")[2:]), shown)
        self.assertIn("rigid motion as it is", self.browser.evaluate("shown.remark.textContent"))
        k = int(np.argmax(np.linalg.norm(bent, axis=2).max(axis=1)))
        place = self.browser.evaluate(
            f"shown.time = shown.motion.time[{k}], shown.show(), [...shown.motion.bodies[0].place]"
        )
        rigid = np.einsum("vjn,n->vj", shape[..., ~elastic], q[k, ~elastic])
        exact = node + rigid + shown * bent[k]
        bound = shown * largest * (self.data["motion"]["missed"] + 1e-3)  # 15 bits of each of a few shapes
        self.assertLess(np.abs(np.reshape(place, (-1, 3)) - exact).max(), bound)
        self.assertLess(10 * bound, np.abs((shown - 1) * rigid).max())  # amplified rigid motion would be seen

    def test_modes_are_listed_and_one_that_is_pressed_moves(self):
        _, node, shape, omega, _ = self.kernel_data()
        self.opened_at(900, 600)
        before = self.pixels()
        listed = self.browser.evaluate(
            "[...document.querySelectorAll('#modes tbody tr')].map(row => [...row.children].map(cell => cell.textContent))"
        )
        elastic = np.flatnonzero((omega > 0) & np.isfinite(omega))[:20]
        self.assertEqual([int(row[0]) for row in listed], (elastic + 1).tolist())
        np.testing.assert_allclose([float(row[1]) for row in listed], omega[elastic] / (2 * np.pi), rtol=5e-6)
        self.assertEqual({row[2] for row in listed}, {"0.05"})  # half the loss factor
        for n in elastic:
            field, wanted = (
                unpacked(self.data["motion"]["bodies"][0]["modes"][str(n + 1)]),
                shape[..., n].ravel(),
            )
            self.assertLess(np.abs(field - wanted).max(), abs(wanted).max() / 32767)
        name = f"Show bracket, mode 8: {float(listed[1][1]) / 1000:.4g} kHz"
        self.assertEqual(self.node_of_tree("button", name)["pressed"], "false")
        self.browser.evaluate(f'document.querySelector(`[aria-label="{name}"]`).focus()')
        self.browser.press("Enter", "\r")
        self.assertEqual(self.node_of_tree("button", name)["pressed"], "true")
        phase = self.browser.evaluate("shown.phase")
        self.browser.wait_for(f"Math.abs(shown.phase - {phase}) > 0.05")  # it plays
        self.pressed("Pause")
        at = []
        for phase in (0.25, 0.75):
            place = self.browser.evaluate(
                f"shown.phase = {phase}, shown.show(), [...shown.motion.bodies[0].place]"
            )
            at.append((np.reshape(place, (-1, 3)) - node, self.pixels()))
        wanted = (
            shape[..., 7]
            / np.linalg.norm(shape[..., 7], axis=1).max()
            * 0.1
            * np.linalg.norm(np.ptp(node, axis=0))
        )
        for sign, (moved, _) in zip((1, -1), at):
            np.testing.assert_allclose(moved, sign * wanted, atol=2e-4 * abs(wanted).max())
        self.assertGreater(np.mean((at[0][1] != at[1][1]).any(axis=2)), 0.02)
        self.pressed("Next mode")
        self.assertEqual(self.browser.evaluate("shown.canvas.dataset.mode"), "9")
        self.pressed("Back to the impact")
        self.assertEqual(self.browser.evaluate("[shown.canvas.dataset.mode, shown.playing]"), ["", False])
        self.assertTrue((self.pixels() == before).all())
        self.assertEqual(self.browser.evaluate("document.activeElement.textContent"), "9")

    def test_without_snapshots_the_bodies_and_their_modes_are_shown(self):
        sets = [*self.SETS, "title=still", "output.snapshot_every=0"]
        shutil.copy(*self.out.glob("*.kernel.h5"), self.folder)
        self.browser.open(ricochet.report(impact(self.scene, self.folder, *sets)), 1280, 800)
        self.assertGreater(float(self.browser.evaluate("shown.canvas.dataset.covered")), 0.05)
        self.assertIn(
            "snapshot_every = 4", self.browser.evaluate("document.querySelector('#motion').textContent")
        )
        playing = "document.querySelector('button.play').offsetParent !== null"
        self.assertFalse(self.browser.evaluate(playing))
        self.browser.evaluate("document.querySelector('#modes button').click()")
        self.browser.wait_for("shown.phase > 0.3")
        self.assertTrue(self.browser.evaluate(playing))
        self.pressed("Back to the impact")
        self.assertFalse(self.browser.evaluate(playing))

    def test_main_figures_come_first_and_checks_warn_only_out_of_their_bounds(self):
        self.opened_at(900, 600)
        titles = self.browser.evaluate(
            "[...document.querySelectorAll('#highlights dt')].map(title => title.textContent)"
        )
        self.assertEqual(
            titles,
            ["Restitution", "Peak force", "Impulse", "Duration of contact", "Exit velocity of bracket"],
        )
        with h5py.File(self.result) as file:
            force = file["contact/force"][:]
        points = np.count_nonzero(force[np.argmax(force.sum(axis=1))])
        self.assertGreater(points, 3)
        self.assertIn(
            f"sum over {points} points",
            self.browser.evaluate("document.querySelector('#highlights').textContent"),
        )
        checks = (
            "[document.querySelector('#checks').open, document.querySelector('#checks summary').textContent]"
        )
        self.assertEqual(self.browser.evaluate(checks), [False, "Checks: 3 within bounds"])
        (path,) = self.out.glob("*.summary.json")
        text = path.read_text()
        self.addCleanup(self.write_page)
        self.addCleanup(path.write_text, text)
        warnings = len(json.loads(text)["warnings"])
        path.write_text(json.dumps(json.loads(text) | {"energy_drift": 2e-9}))
        self.write_page()
        self.opened_at(900, 600)
        self.assertEqual(self.browser.evaluate(checks), [True, "Checks: 1 of 3 out of bounds"])
        shown = self.browser.evaluate(
            "[...document.querySelectorAll('#warnings li')].map(item => item.textContent)"
        )
        self.assertEqual(len(shown), warnings + 1)
        self.assertIn("2 × 10⁻⁹ is above 1 × 10⁻¹⁰", shown[-1])

    def test_a_wide_window_has_two_columns_and_a_narrow_one_shows_the_figures_first(self):
        tall = {}
        for wide, high in ((1280, 800), (390, 844)):
            self.opened_at(wide, high)
            tall[wide], across, cut, figures, canvas, list_of = self.browser.evaluate(LAYOUT)
            self.assertEqual((across, cut), (wide, []))  # nothing is wider than its place
            self.assertEqual(
                list_of[0] < list_of[1] and abs(list_of[2] - list_of[3]) < 2, wide == 1280, list_of
            )
            self.assertEqual(figures[0] < canvas[0], True)  # the canvas is below, or beside them and taller
            self.assertEqual(figures[1] <= canvas[0], wide == 390)
        # One column of 1280 pixels had 11 300 pixels for a page of this kind.
        self.assertLess(tall[1280], 9000)

    def test_the_first_printed_page_has_the_figures_and_the_bodies(self):
        self.opened_at(718, 1000)  # A4 without margins, at 96 dots an inch
        self.browser.call("Emulation.setEmulatedMedia", media="print")
        self.addCleanup(self.browser.call, "Emulation.setEmulatedMedia", media="")
        bottom, rule = self.browser.evaluate(
            """[document.querySelector(".stage").getBoundingClientRect().bottom + scrollY,
                getComputedStyle(document.querySelector("#motion")).breakInside]"""
        )
        self.assertLess(bottom, 1000)
        self.assertEqual(rule, "auto")  # otherwise the whole section would move to the second page

    def test_free_bodies_list_no_masses_and_decimal_points_stand_below_each_other(self):
        self.opened_at(900, 600)
        free, supported = self.browser.evaluate(
            """[{}, {mass: [0.5, 0, 0]}].map(more => {
              const rows = [7.0021, 19.92, 164.5].map((frequency_hz, k) => ({number: k + 1, frequency_hz, damping: 0.01, mass: [0, 0, 0], contact: 0.1, ...more}));
              const made = new Modes(document.createElement("section"), []).tableOf({body: "none", basis: "modes", rigid: 6, elastic: 3, rows});
              return [made.querySelectorAll("thead th").length, ...[...made.querySelectorAll("tbody td:nth-child(2)")].map(cell => cell.textContent)];
            })"""
        )
        self.assertEqual(free, [4, "7.002", "19.920", "164.500"])
        self.assertEqual(supported, [7, *free[1:]])
        shown = self.browser.evaluate(
            "[...document.querySelectorAll('#modes tbody td:nth-child(2)')].map(cell => cell.textContent)"
        )
        self.assertEqual(len({len(text.partition(".")[2]) for text in shown}), 1)

    def test_a_film_of_the_motion_can_be_saved_and_plays(self):
        self.opened_at(900, 600)
        size = self.browser.evaluate(
            """(async () => {
              const saved = new Promise(resolve => {
                const kept = URL.createObjectURL;
                URL.createObjectURL = blob => { URL.createObjectURL = kept; resolve(blob); return kept.call(URL, blob); };
              });
              [...document.querySelectorAll(".cockpit button")].find(button => button.textContent === "film").click();
              const {recorder} = shown.film;  // the encoder takes a moment before its first frame
              let bytes = 0;
              recorder.addEventListener("dataavailable", ({data}) => { bytes += data.size; });
              while (bytes < 4000) { await new Promise(soon => setTimeout(soon, 100)); recorder.requestData(); }
              shown.filmButton.click();
              const reader = new FileReader(), film = document.createElement("video");
              reader.readAsDataURL(await saved);
              await new Promise(resolve => { reader.onload = resolve; });
              const ready = new Promise((resolve, reject) => { film.onloadeddata = resolve; film.onerror = () => reject(Error(film.error.message)); });
              film.src = reader.result.replace(/^data:[^,]*,/, "data:video/webm;base64,");
              await ready;
              film.muted = true;
              await Promise.all([film.play(), new Promise(resolve => { film.ontimeupdate = () => film.currentTime > 0 && resolve(); })]);
              const frame = document.createElement("canvas"), ink = frame.getContext("2d", {willReadFrequently: true});
              [frame.width, frame.height] = [film.videoWidth, film.videoHeight];
              ink.drawImage(film, 0, 0);
              const pixels = ink.getImageData(0, frame.height >> 2, frame.width, frame.height >> 1).data, colours = new Set();
              for (let k = 0; k < pixels.length; k += 4) colours.add(pixels[k] >> 5 << 6 | pixels[k + 1] >> 5 << 3 | pixels[k + 2] >> 5);
              return [film.videoWidth, film.videoHeight, shown.canvas.width, shown.canvas.height, colours.size, shown.playing];
            })()"""
        )
        self.assertEqual(size[:2], size[2:4])
        self.assertGreater(size[4], 8)  # between title and scale, the body has those of its speed
        self.assertFalse(size[5])

    def test_the_front_of_a_wall_is_seen_without_gravity(self):
        history = LoadedResult(self.result)
        for way in (1, -1):
            wall = {"obstacles": {"wall": {"point": [way * -0.05, 0, 0], "normal": [way, 0, 0]}}}
            view = motion_of(history, self.out, wall)["view"]
            toward = View(view["base"][2], view["base"][1], view["azimuth"], view["elevation"]).turn()[2]
            self.assertGreater(way * toward[0], 0.05)

    def test_pictures_of_the_drop_differ_from_each_other(self):
        """By pixels: frame by frame, the share of the pixels of the part that change. With a factor of 4 in place of 200, less
        than 0.1 % do in places. And by the mean motion of the nodes as drawn, which is the same from frame to frame.
        """
        with mock.patch("ricochet.pictures.snapshots.COLOURS", OneColour()) as colours:
            figure = dict(figures(LoadedResult(self.result), self.out, lambda _: None))["snapshots"]
        shown = re.search(
            r"drop: 9 moments of the contact\ndeformation drawn (\d+) times", figure._suptitle.get_text()
        )
        pictures = [ax for ax in figure.axes if not ax.axison]  # the panels of forces have axes
        self.assertEqual(len(pictures), 9)
        figure.set_layout_engine("none")  # it would place each frame at another fraction of a pixel
        figure.set_size_inches(9, 9)
        figure.set_dpi(100)
        for k, ax in enumerate(pictures):
            ax.set_position([k % 3 / 3, k // 3 / 3, 1 / 3, 1 / 3])
        for ax in set(figure.axes) - set(pictures):
            ax.set_visible(False)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        image = np.asarray(canvas.buffer_rgba())[30:, :, :3].astype(int)  # without the title
        frames = [image[::-1][k // 3 * 300 :, k % 3 * 300 :][30:270, 5:295] for k in range(9)]
        part = np.mean((frames[4] != FLOOR).any(axis=2) & (frames[4] != 255).any(axis=2))
        changed = [np.mean(abs(a - b).max(axis=2) > 25) / part for a, b in itertools.pairwise(frames[1:])]
        self.assertTrue(0.02 < min(changed) and max(changed) < 0.5, changed)

        _, _, shape, omega, q = self.kernel_data()
        with h5py.File(self.result) as file:
            time = file["snapshots/time"][:]
        at = [np.argmin(abs(1e6 * time - number(ax.get_title().split()[0]))) for ax in pictures]  # µs
        drawn = np.einsum("vjn,sn->svj", shape, np.where(omega > 0, float(shown[1]), 1) * q[at])
        moved = np.sqrt((np.diff(drawn, axis=0) ** 2).sum(axis=2).mean(axis=1))
        # The colours end at the deformation that 1 % of the nodes exceed at one of these moments.
        bent = np.linalg.norm(np.einsum("vjn,sn->svj", shape, np.where(omega > 0, 1, 0) * q[at]), axis=2)
        (bar,) = [ax for ax in figure.axes if ax.get_xlabel() == "deformation (µm)"]
        self.assertAlmostEqual(
            1e-6 * bar.get_xlim()[1] / np.percentile(bent, 99, axis=1).max(), 1, delta=1e-4
        )
        element = unpacked(self.data["motion"]["bodies"][0]["element"]).astype(int)
        painted = np.array([values for values in colours.asked if np.shape(values) == (len(element),)])
        wanted = bent[:, element].mean(axis=2) / np.percentile(bent, 99, axis=1).max()
        np.testing.assert_allclose(painted, wanted, atol=1e-4)  # fields have 32 bits
        ratio = moved.max() / moved.min()
        self.assertLess(ratio, 1.3)  # because snapshots are 2 µs apart; above 2 with even times


class Rods(PageTest):
    SCENE, SETS = "two-rods", RODS

    def test_the_scale_bar_has_the_length_that_it_states(self):
        """Two rods of 10 m with a gap of 0.1 m, seen from the front at the start, are 20.1 m long."""
        self.opened_at(900, 600)
        self.pressed("front")
        self.browser.evaluate("shown.motion.arrows = false, shown.time = 0")
        for zoom in (1, 0.6, 0.37):
            self.browser.evaluate(
                f"shown.motion.view.zoom = {zoom}, shown.motion.target[0] = 0, shown.show()"
            )
            columns = np.flatnonzero(self.pixels()[..., 3].any(axis=0))
            self.assertTrue(
                0 < columns[0] and columns[-1] < self.pixels().shape[1] - 1, "not all in the picture"
            )
            long = columns[-1] - columns[0] + 1
            metres, pixels, text = self.browser.evaluate(
                """(() => { const bar = document.querySelector('.overlay .scale');
              return [Number(bar.dataset.metres), bar.querySelector('path').getBoundingClientRect().width, bar.textContent]; })()"""
            )
            self.assertTrue(50 < pixels < 145, pixels)
            self.assertIn(metres, [a * b for a in (1, 2, 5) for b in (1, 10, 100)])
            self.assertEqual(text, f"{metres:g} m")
            self.assertAlmostEqual(pixels, metres * long / 20.1, delta=1)

    def test_modes_have_a_page_without_an_impact_which_shows_the_first_one_in_motion(self):
        done = self.succeed(Command("modes", self.scene, "--page", "--out", self.out, *settings(self.SETS)))
        page = self.out / "two-rods.modes.html"
        self.assertEqual(done.out.splitlines()[-1], str(page))
        self.browser.open(page, 390, 844)
        self.browser.wait_for("shown.phase > 0.3")
        shown = self.browser.evaluate(
            "[document.querySelector('.key b').textContent, document.querySelectorAll('#modes button').length]"
        )
        # With a wave speed of 1 m/s, free rods of 10 m have frequencies of n/20 Hz. Five modes each, one of them rigid.
        self.assertEqual(shown, ["moving, mode 2: 50 mHz", 8])
        buttons = "[...document.querySelectorAll('.cockpit button')].map(button => button.textContent)"
        self.assertNotIn("Back to the impact", self.browser.evaluate(buttons))
        self.assertEqual(self.browser.messages, [])
        self.keep("modes-390")

    def test_bodies_without_elastic_modes_have_no_picture_and_no_page_of_modes(self):
        words = ["modes", self.scene, "-n", "1", "--out", self.made / "rigid", "--set", "modes.count=1"]
        done = self.succeed(Command(*words, "--plot"))
        self.assertEqual(done.err.count("it has no elastic modes"), 2)
        self.assertEqual(list((self.made / "rigid").glob("*.png")), [])
        done = Command(*words, "--page")
        self.assertEqual(done.status, 2)
        self.assertIn("no body has an elastic mode to show", done.err.splitlines()[-1])
        self.assertEqual(list((self.made / "rigid").glob("*.html")), [])

    def test_rods_that_touch_in_one_point_are_not_told_to_refine(self):
        self.assertEqual(self.data["peak"], {"points": 1, "few": False})
        self.assertIsNone(self.data["motion"]["gravity"])
        self.opened_at(390, 844)
        self.assertFalse(self.browser.evaluate("Boolean(document.querySelector('.overlay .gravity'))"))
        self.keep("rods-390")


if __name__ == "__main__":
    unittest.main()
