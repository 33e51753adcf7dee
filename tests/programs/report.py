# SPDX-License-Identifier: BSD-2-Clause
"""ricochet report: the page in a browser without network. Its numbers are compared with the summary, its motion and sound with
the result; bad input is refused. `report.py --keep FOLDER` also keeps the pages and a picture of each in FOLDER."""

import base64
import json
import re
import shutil
import struct
import unittest
from unittest import mock

import h5py
import numpy as np

import scenes
from programs import MESHES, Command, Run, contact, impact, kernel
from report_test import ReportTest, number, unpacked
from ricochet import principal_stresses, von_mises

from ricochet.pictures.simplified import coarser
from ricochet.pictures.viewpoint import clearest

TITLE = 'Rods </script><script>document.title = "run"</script> & <b>"more"</b>'
RECEIVER = "tip <img src=x onerror=alert(1)>"
# Waves cross the rods of 10 m in 1 ms; the impact is at 1 % of the wave speed.
RODS = [
    "modes.count=20",
    "bodies.moving.material.young=1e8",
    "bodies.resting.material.young=1e8",
    "bodies.moving.velocity=[300,0,0]",
    "time.rate_hz=44100",
    "time.duration=0.004",
    "contact.gap=0.1",
    "output.snapshot_every=3",
    f"title='{TITLE}'",
    'output.receiver=[{name="mic",body="resting",at=[10,0,0]},{name="'
    + RECEIVER
    + '",body="moving",at=[-10,0,0]}]',
    "accuracy=1e-2",
]

# Simulates a user at the controls.
HAND = """new Promise(resolve => {
const canvas = document.querySelector("canvas[data-covered]"), found = {};
const [time, amplify] = ["Time", "Amplification"].map(name => document.querySelector(`input[aria-label="${name}"]`));
const [part, colour] = ["Part of the run", "Colour"].map(name => document.querySelector(`select[aria-label="${name}"]`)), play = document.querySelector("button.play");
const act = (element, type, more = {}) => element.dispatchEvent(Object.assign(new Event(type), more));
const pointer = (type, x, y) => canvas.dispatchEvent(new PointerEvent(type, {pointerId: 1, clientX: x, clientY: y}));
canvas.setPointerCapture = () => {};
part.value = "whole"; act(part, "change");
const at = share => { time.value = share; act(time, "input"); return Number(canvas.dataset.time); };
found.ends = [at(0), at(1)];
found.middle = at(0.5);
const before = [canvas.toDataURL()];
const step = (name, what) => { what(); before.push(canvas.toDataURL()); found[name] = before.at(-1) !== before.at(-2); };
step("turned", () => { pointer("pointerdown", 50, 50); pointer("pointermove", 90, 70); pointer("pointerup", 90, 70); });
step("nearer", () => act(canvas, "wheel", {deltaY: -200}));
step("keyed", () => act(canvas, "keydown", {key: "ArrowLeft"}));
step("coloured", () => { colour.value = "deformation"; act(colour, "change"); });
const boxes = [...document.querySelectorAll('[aria-label="Bodies shown"] input')], full = canvas.toDataURL();
found.boxes = boxes.map(box => [box.type, box.labels[0].textContent, box.tabIndex]);
step("hidden", () => { boxes[0].focus(); document.activeElement.click(); });
boxes[0].click();
found.back = canvas.toDataURL() === full;
step("louder", () => { amplify.value = amplify.max; act(amplify, "input"); });
const chart = document.querySelector("#chart-force svg"), box = chart.getBoundingClientRect();
act(chart, "pointermove", {clientX: box.left + box.width / 2});
found.tip = [...document.querySelectorAll("#chart-force .tip div")].map(part => part.textContent);
play.click();
const wait = () => (found.played = Number(canvas.dataset.time) > found.middle) ? resolve(found) : setTimeout(wait, 50);
wait();
})"""


class Unasked(ReportTest):
    """`ricochet run` of a scene that names neither surfaces nor snapshots."""

    SETS = ["modes.count=5", "time.duration=30"]

    def setUp(self):
        super().setUp()
        shutil.copytree(
            MESHES / "two-rods", self.folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("out")
        )
        text = (self.folder / "two-rods.toml").read_text()
        self.scene, self.out = self.write("two-rods.toml", text.split("[output]")[0]), self.folder / "out"

    def run_it(self, *sets):
        words = [word for one in (*self.SETS, *sets) for word in ("--set", one)]
        with mock.patch("ricochet.cli.plot.draw"), mock.patch("ricochet.pages.write_page"):
            return self.succeed(Command("run", "-n", "1", self.scene, *words))

    def snapshots(self):
        with h5py.File(self.one(self.out, "*.result.h5")) as file:
            return len(file["snapshots/time"]) if "snapshots" in file else 0

    def test_run_keeps_surfaces_and_some_hundred_snapshots_so_that_the_page_moves(self):
        self.run_it()
        kernels = set(self.out.glob("*.kernel.h5"))
        self.assertEqual(len(kernels), 2)
        # 3000 steps. The first snapshot is that of the start.
        self.assertEqual(self.snapshots(), 1 + 3000 // 8)
        _, _, page = self.page(self.one(self.out, "*.result.h5"))
        self.assertEqual(page["motion"]["time"]["shape"], [376])
        self.assertIn("up to date", self.run_it().out)
        # `ricochet impact` alone keeps none, and finds the same kernels; so does a scene that wants no surface.
        self.succeed(contact(self.scene, self.out, *self.SETS))
        self.assertEqual(self.snapshots(), 0)
        self.run_it("output.view=false")
        self.assertEqual(self.snapshots(), 0)
        self.assertEqual(set(self.out.glob("*.kernel.h5")), kernels)
        # A derived kernel has the surface of the one it comes from.
        self.run_it("bodies.moving.material.young=1.1")
        self.assertEqual(self.snapshots(), 376)
        self.assertEqual(len(set(self.out.glob("*.kernel.h5")) - kernels), 1)

    def test_run_keeps_snapshots_where_accuracy_chooses_the_rate(self):
        text = self.scene.read_text().split("[modes]")[0]
        end = '[contact]\nbetween = ["moving", "resting"]\ngap = 0.5\n[time]\nduration = 2\n'
        self.scene.write_text(text.replace("order = 2\n", "") + end)
        with mock.patch.object(self, "SETS", []):
            self.run_it()
            self.assertGreater(self.snapshots(), 10)
            self.assertIn("up to date", self.run_it().out)

    def test_run_leaves_finished_kernels_and_large_surfaces_alone(self):
        self.succeed(kernel(self.scene, self.out, *self.SETS))
        finished = set(self.out.glob("*.kernel.h5"))
        self.run_it()
        self.assertEqual((set(self.out.glob("*.kernel.h5")), self.snapshots()), (finished, 0))
        for path in finished:
            path.unlink()
        # 101 nodes with five modes and one static response, in single precision: 7.1 kB a body.
        for most, there in ((7271 / 2**20, False), (7273 / 2**20, True)):
            self.succeed(kernel(self.scene, self.out, *self.SETS, more=["--view-up-to", most]))
            for path in self.out.glob("*.kernel.h5"):
                with h5py.File(path) as file:
                    self.assertEqual("view" in file, there)
                path.unlink()


class Rods(ReportTest):
    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        shutil.copytree(MESHES / "two-rods", cls.made, dirs_exist_ok=True)
        impact(cls.made / "two-rods.toml", cls.made / "out", *RODS)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.made, self.folder, dirs_exist_ok=True)
        self.scene, self.out = self.folder / "two-rods.toml", self.folder / "out"
        self.result = self.one(self.out, "*.result.h5")

    def test_the_page_tells_the_run_without_network_and_runs_nothing_that_a_title_says(self):
        path, text, run = self.page(self.result)
        self.assertIsNone(
            re.search(r"[a-z]+://|url\((?!#)|@import|<link|src=", text.replace("src=x onerror", "")),
            "the page asks for something",
        )
        self.assertEqual(text.lower().count("<script"), 3)
        self.assertLess(len(text), 3e6)
        found, summary = self.opened(path, "rods"), self.summary(self.out)
        self.assertEqual([e[2] for e in found.found if e[0] in ("h1", "title")], [TITLE, TITLE])
        self.assertIn(RECEIVER, [e[2] for e in found.found if e[0] == "h3"])
        self.assertNotIn("onerror", [name for e in found.found for name in e[1]])
        self.numbers_agree(found, summary)
        self.assertTrue(all(warning in found.one(id="warnings")[2] for warning in summary["warnings"]))
        self.assertGreater(len(summary["warnings"]), 0)
        canvas = next(
            attributes
            for tag, attributes, _ in found.found
            if tag == "canvas" and "data-covered" in attributes
        )
        with h5py.File(self.result) as file:
            self.assertEqual(int(canvas["data-moments"]), len(file["snapshots/time"]))
        self.assertGreater(float(canvas["data-covered"]), 0.005)
        self.assertLess(float(canvas["data-covered"]), 0.5)
        self.assertEqual(
            found.one(id="sound")[2].count("4 ms of sound: lengthen time.duration to hear it"), 2
        )
        self.assertNotIn("audio", [e[0] for e in found.found])
        self.assertIn("ricochet report out/", found.one(id="repeat")[2])
        self.accelerations_are_those_of_the_summary(found, run["accelerations"], summary["acceleration"])
        self.pictures_are_drawn()
        self.scene_repeats_the_run(found.one(id="scene")[2], summary)
        self.motion_is_that_of_the_modes_and_the_static_part(run["motion"])
        self.area_below_the_force_is_the_impulse(run, summary)
        self.charts_show_the_impact_of_equal_rods(run["charts"]["contact"])

    def test_the_controls_do_what_they_say(self):
        impact(self.scene, self.out, *RODS, "time.duration=0.11", "output.snapshot_every=9")
        path, _, _ = self.page(self.result)
        self.sounds_are_the_receivers(self.opened(path, "controls"))
        found = self.browser.evaluate(HAND)
        self.assertEqual(self.browser.messages, [])
        with h5py.File(self.result) as file:
            when, force, moments = (
                file["contact/time"][:],
                file["contact/force"][:, 0],
                file["snapshots/time"][:],
            )
        np.testing.assert_allclose(found["ends"], moments[[0, -1]], rtol=1e-6)  # 32 bits
        self.assertEqual(
            [
                found[name]
                for name in ("turned", "nearer", "keyed", "coloured", "hidden", "back", "louder", "played")
            ],
            [True] * 8,
        )
        self.assertEqual(
            found["boxes"], [["checkbox", "moving", 0], ["checkbox", "resting", 0]]
        )  # accessible by keyboard
        row = np.argmin(np.abs(when - 1e-3 * number(found["tip"][0])))  # the page shows ms
        self.assertAlmostEqual(
            1e6 * number(found["tip"][1].removeprefix("force: ")), force[row], delta=1e-3 * force[row]
        )  # and MN

    def test_charts_enlarge_a_part_hide_lines_and_have_a_logarithmic_axis(self):
        path, _, run = self.page(self.result)
        self.opened(path, "charts", 1280, 900)
        self.browser.evaluate("document.querySelector('#chart-energy').scrollIntoView({block: 'center'})")
        of = "const chart = charts.find(({spec}) => spec.key === 'energy');"
        state = f"(() => {{ {of} return [chart.x.low, chart.x.high, chart.y.low, chart.y.high, chart.y.log]; }})()"
        first = self.browser.evaluate(state)
        left, top, width, height = self.browser.evaluate(
            f"""(() => {{ {of} const {{left, top}} = chart.svg.getBoundingClientRect(), {{box}} = chart;
              return [left + box.left, top + box.top, box.width, box.height]; }})()"""
        )
        # Half of the axis, from a quarter to three quarters, as a user drags it.
        for kind, share in (("mousePressed", 0.25), ("mouseMoved", 0.5), ("mouseReleased", 0.75)):
            x, y = left + share * width, top + height / 2
            self.browser.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)
        part = self.browser.evaluate(state)
        middle = [first[0] + share * (first[1] - first[0]) for share in (0.25, 0.75)]
        np.testing.assert_allclose(part[:2], middle, atol=2e-3 * (first[1] - first[0]))  # a pixel
        ticks = "[...document.querySelectorAll('#chart-energy svg text[y=\"' + {} + '\"]')].map(text => text.textContent)"
        shown = self.browser.evaluate(
            f"(() => {{ {of} return {ticks.format('(chart.box.top + chart.box.height + 16)')}; }})()"
        )
        self.assertTrue(all(1e3 * part[0] <= number(text) <= 1e3 * part[1] for text in shown), shown)  # ms
        self.assertGreater(len(set(shown)), 2)
        self.pressed("#chart-energy", "whole")
        self.assertEqual(self.browser.evaluate(state), first)
        # All lines but the strain energy are hidden: the axis fits its values.
        lines = {line["name"]: unpacked(line["y"]) for line in run["charts"]["energy"][0]["lines"]}
        for name in lines:
            if name != "strain":
                self.pressed("#chart-energy", name)
        low, high = self.browser.evaluate(state)[2:4]
        most = lines["strain"].max()
        self.assertTrue(low == 0 and most <= high < 1.1 * most, (low, high, most))
        drawn = "document.querySelectorAll('#chart-energy path.line').length"
        self.assertEqual(self.browser.evaluate(drawn), 1)
        for name in lines:
            if name != "strain":
                self.pressed("#chart-energy", name)
        self.assertEqual(self.browser.evaluate(state), first)
        self.assertEqual(self.browser.evaluate(drawn), len(lines))
        self.pressed("#chart-force", "log")
        self.browser.evaluate("document.querySelector('#chart-force').scrollIntoView({block: 'center'})")
        heights = self.browser.evaluate(
            """(() => { const chart = charts.find(({spec}) => spec.key === 'force'), {y} = chart;
              return [y.log, y.at(y.high), y.at(y.high / 10) - y.at(y.high / 100), y.at(y.high / 100) - y.at(y.high / 1000),
                      document.querySelector('#chart-force .area').getAttribute('d')]; })()"""
        )
        self.assertEqual(heights[:2], [True, 1])
        self.assertAlmostEqual(heights[2], heights[3], delta=1e-9)  # decades are equally high
        self.assertNotRegex(heights[4], "NaN|Infinity")
        self.assertEqual(self.browser.messages, [])

    def pressed(self, where, text):
        pressed = self.browser.evaluate(
            f"""(() => {{ const found = [...document.querySelectorAll(`{where} button`)].find(one => one.textContent === {json.dumps(text)});
              const there = Boolean(found?.offsetParent); found?.click(); return there; }})()"""
        )
        self.assertTrue(pressed, text)

    def sounds_are_the_receivers(self, found):
        for (_, attributes, _), name in zip(
            [e for e in found.found if e[0] == "audio"], ["mic", RECEIVER], strict=True
        ):
            data = base64.b64decode(attributes["src"].removeprefix("data:audio/wav;base64,"))
            self.assertEqual(struct.unpack("<HHI", data[20:28]), (1, 1, 44100))
            with h5py.File(self.result) as file:
                velocity = file[f"receivers/{name}/velocity"][:, 0]
            self.assertLess(
                np.abs(np.frombuffer(data[44:], "<i2") - 32767 * velocity / np.abs(velocity).max()).max(), 1
            )

    def accelerations_are_those_of_the_summary(self, found, charts, summary):
        self.assertEqual(set(summary), {"mic", RECEIVER})
        shown = {e[1].get("data-key") for e in found.found}
        for name, peaks in summary.items():
            path = f"acceleration.{name}."
            self.assertLessEqual({path + "peak_m_per_s2", path + "cfc_peak_m_per_s2.1000"}, shown)
            lines = {line["name"]: unpacked(line["y"]).max() for line in charts[name][0]["lines"]}
            for of, peak in peaks["cfc_peak_m_per_s2"].items():
                self.assertAlmostEqual(lines[f"CFC {of}"] / peak, 1, delta=1e-3)  # 16 bits
            # A stiff oscillator follows the base; these have up to a tenth of the rate.
            spectrum = unpacked(charts[name][1]["lines"][0]["y"])
            self.assertGreater(spectrum[-1], peaks["cfc_peak_m_per_s2"]["1000"])

    def scene_repeats_the_run(self, scene, summary):
        before = {path.name for path in self.out.glob("*.kernel.h5")}
        again = self.write("again.toml", scene)
        impact(again, self.out)
        self.assertEqual({path.name for path in self.out.glob("*.kernel.h5")}, before)
        self.assertEqual(self.summary(self.out)["impulse_ns"], summary["impulse_ns"])

    def pictures_are_drawn(self):
        done = self.succeed(Command("plot", self.result, "--out", self.folder / "pictures"))
        names = [
            self.result.name.replace(".result.h5", f"-{name}.png")
            for name in ("contact", "snapshots", "energy")
        ]
        self.assertEqual(done.out.split("\n"), [*(f"{self.folder}/pictures/{name}" for name in names), ""])

    def area_below_the_force_is_the_impulse(self, run, summary):
        drawn = run["charts"]["contact"][0]["lines"][0]
        time, force = unpacked(drawn["x"]).astype(float), unpacked(drawn["y"]).astype(float)
        area = np.nansum(force[1:] * np.diff(time))  # steps end at these times
        self.assertAlmostEqual(
            area, summary["impulse_ns"], delta=1e-3 * summary["impulse_ns"]
        )  # times have 32 bits, and lines are thinned to the peaks
        self.assertAlmostEqual(run["episodes"][0][0], summary["contact_start_s"], delta=1e-9)
        self.assertEqual(np.nanmax(force), np.float32(summary["peak_force_n"]))

    def charts_show_the_impact_of_equal_rods(self, charts):
        """One rod arrives at 300 m/s over a gap of 0.1 m. While they touch, both ends move at half the speed, and then the
        other rod leaves at the speed of the first."""
        speed, gap = 300, 0.1
        lines = {
            (chart["key"], line["name"]): (
                unpacked(line["x"]).astype(float),
                unpacked(line["y"]).astype(float),
            )
            for chart in charts
            for line in chart["lines"]
        }
        for name, before, after, start in (("moving", speed, 0, -gap), ("resting", 0, speed, 0)):
            time, mean = lines["speed", f"{name}, mean of its mass"]
            self.assertAlmostEqual(mean[0], before, delta=1e-3 * speed)
            self.assertAlmostEqual(mean[-1], after, delta=0.05 * speed)
            _, at_point = lines["speed", f"{name}, contact point"]
            self.assertAlmostEqual(np.nanmean(at_point), speed / 2, delta=0.1 * speed)
            # 1e-6: storage in 32 bits
            when, place = lines["place", f"{name}, mean of its mass"]
            self.assertAlmostEqual(place[0], start + before * when[0], delta=1e-6)
        # The ends touch where their lines meet: at the place of the resting rod, which moves on.
        (_, arriving), (_, struck) = (
            lines["place", f"{name}, contact point"] for name in ("moving", "resting")
        )
        self.assertLess(np.nanmax(np.abs(arriving - struck)), 0.02 * np.nanmax(struck))
        self.assertLess(np.abs(struck[0]), 0.02 * np.nanmax(struck))

    def motion_is_that_of_the_modes_and_the_static_part(self, motion):
        """Compares the motion, up to the error that the page states and to storage in 32 and 15 bits."""
        for body in motion["bodies"]:
            fields = np.concatenate(
                [unpacked(body["rigid"])] + [unpacked(field)[None] for field in body["bent"]]
            )
            amounts = np.concatenate([unpacked(body["moved"]), unpacked(body["amount"])], axis=1)
            with h5py.File(self.result) as file:
                where = file[f"bodies/{body['name']}"]
                turn = where.attrs["rotation"].reshape(3, 3)
                q = file[f"snapshots/{body['name']}"][:]
                static = file[f"static/{body['name']}"]
                with h5py.File(self.out / where.attrs["kernel"].decode()) as kernel:
                    node, shape, omega = (
                        kernel["view/node"][:],
                        kernel["view/shape"][:].astype(float),
                        kernel["modes/angular_frequency"][:],
                    )
                    flexibility = kernel["view/residual_flexibility"][:].astype(float)
                force = np.zeros((len(q), flexibility.shape[2]))
                force[static["snapshot"][:].astype(int), static["candidate"][:].astype(int)] = static[
                    "force"
                ][:, 0]
                start = node @ turn.T + where.attrs["translation"]
            bent = np.einsum("vjn,sn->svj", shape[:, :, omega > 0], q[:, omega > 0])
            bent += np.einsum("vjm,sm->svj", flexibility, force)
            rigid = np.einsum("vjn,sn->svj", shape[:, :, omega == 0], q[:, omega == 0])
            exact = np.einsum("ij,svj->svi", turn, rigid + bent)
            drawn = (amounts @ fields).reshape(len(q), len(node), -1, 3)
            deformation = np.abs(bent).max()
            bound = motion["missed"] * deformation + 1e-4 * deformation + 1e-6 * np.abs(exact).max()
            self.assertLess(np.abs(drawn - exact[:, :, None]).max(), bound)
            self.assertLess(motion["missed"], 0.02)
            ring = unpacked(body["node"]).reshape(len(node), -1, 3)
            np.testing.assert_allclose(ring.mean(axis=1), start, atol=1e-5)  # a ring is centred at its node

    def test_what_is_wrong_with_a_file_is_said_in_one_line_and_leaves_no_page(self):
        page = self.folder / "none.html"

        def refused(part, result=self.result, out=page, *more):
            self.refused(Command("report", result, "--out", out, *more), part)
            self.assertEqual(list(self.folder.glob("none.html*")), [])

        blocked = self.write("file", "")
        refused("cannot be written", self.result, blocked / "page.html")
        refused("there is no such file", self.folder / "gone.result.h5")
        (summary,) = self.out.glob("*.summary.json")
        text = summary.read_text()
        for wrong, part in [
            (text[:-20], "is damaged"),
            ("[]", "is not of the run"),
            (text.replace('"candidates": 1', '"candidates": 2'), "is not of the run"),
        ]:
            summary.write_text(wrong)
            refused(part)
        summary.unlink()
        refused("there is no such file")
        summary.write_text(text)
        with h5py.File(self.result, "r+") as file:
            file["bodies/moving"].attrs["mass"] = float("nan")
        refused('"mass"')
        with h5py.File(self.result, "r+") as file:
            file["bodies/moving"].attrs["mass"] = 10.0
        for sound in self.out.glob("*mic.wav"):
            sound.write_bytes(sound.read_bytes()[:30])
        refused("is not a sound")

    def test_without_kernels_the_page_says_so(self):
        _, _, run = self.page(self.result, "--kernels", self.folder)
        self.assertIn("there is no kernel", run["motion"]["missing"])
        self.assertEqual([body["kernel"] for body in run["bodies"]], [None, None])


class Others(ReportTest):
    def test_a_skin_that_is_too_fine_is_made_coarser_and_keeps_its_form(self):
        angle, height = np.meshgrid(np.linspace(0, 2 * np.pi, 300, endpoint=False), np.linspace(0, 1, 100))
        node = np.stack([np.cos(angle), np.sin(angle), height], -1).reshape(-1, 3)  # a tube of area 2π
        corner = np.arange(99)[:, None] * 300 + np.arange(300)
        beside = np.arange(99)[:, None] * 300 + (np.arange(300) + 1) % 300
        element = np.stack([corner, beside, beside + 300, corner, beside + 300, corner + 300], -1).reshape(
            -1, 3
        )
        kept, coarse = coarser(node, element, 5000)
        self.assertTrue(1000 < len(coarse) <= 5000)
        a, b, c = np.moveaxis(node[kept][coarse], 1, 0)
        # Nodes do not move. The rims recede by half a cell, about 1 % of the height.
        self.assertAlmostEqual(
            np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 / (2 * np.pi), 1, delta=0.1
        )

    def test_the_first_view_looks_into_the_open_side_of_a_cup_and_at_what_lies_in_it(self):
        def box(centre, half, without=()):
            corner = np.array(list(np.ndindex(2, 2, 2))) * 2.0 - 1
            sides = {
                "-x": [0, 1, 3, 2],
                "+x": [4, 6, 7, 5],
                "-y": [0, 4, 5, 1],
                "+y": [2, 3, 7, 6],
                "-z": [0, 2, 6, 4],
                "+z": [1, 5, 7, 3],
            }
            return centre + half * corner, np.array(
                [
                    [a, *pair]
                    for name, (a, b, c, d) in sides.items()
                    if name not in without
                    for pair in ((b, c), (c, d))
                ]
            )

        ball = box(np.array([0.6, 0, 0]), 0.3)
        for side, axis, way in [("-z", 2, -1), ("+x", 0, 1)]:
            toward = clearest(
                [box(np.zeros(3), 1.0, [side]), ball], np.array([[0.9, 0, 0]]), tilted=True
            ).turn()[2]
            self.assertGreater(way * toward[axis], 0.9, side)
        beside = clearest([ball, box(np.array([1.2, 0, 0]), 0.3)], np.array([[0.9, 0, 0]])).turn()
        np.testing.assert_allclose(
            beside, np.eye(3), atol=1e-12
        )  # nothing is hidden, so the view is that of a drawing

    def test_a_run_by_table_kernels_has_a_page_without_bodies(self):
        shutil.copytree(
            MESHES / "two-rods-analytic",
            self.folder,
            dirs_exist_ok=True,
            ignore=shutil.ignore_patterns("out"),
        )
        self.succeed(Run([self.folder / "table.py"]))
        out = self.folder / "out"
        impact(self.folder / "two-rods-analytic.toml", out)
        path, _, _ = self.page(*out.glob("*.result.h5"))
        found = self.opened(path, "table")
        titles = [e[2] for e in found.found if e[0] == "h2"]
        self.assertIn("The contact", titles)
        self.assertNotIn("Strike it", titles)  # sampled responses know no bodies to strike
        self.numbers_agree(found, self.summary(out))
        self.assertIn("know no bodies", found.one(id="motion")[2])

    # NumPy finds the principal stresses from the tensor; the page, from its invariants.
    def check_stress(self, result, body, wanted):
        """Compares the measures of the stress in the browser with those of the result at some snapshots."""
        got = self.browser.evaluate(
            """(() => { const {motion} = shown, body = motion.bodies[0], found = {start: motion.colour, key: shown.legend.textContent};
for (motion.colour of motion.measurable().filter(name => measures[name].stress))
  found[motion.colour] = WANTED.map(k => { motion.measure(body, k, 0); return [...body.value]; });
return found; })()""".replace(
                "WANTED", json.dumps(wanted)
            )
        )
        self.assertEqual(got.pop("start"), "von_mises")
        self.assertIn("von Mises stress", key := got.pop("key"))
        envelope, ends = result.stress[body], principal_stresses(
            stress := result.surface_stress(body)[wanted]
        )
        value, unit = re.search(r"at most (.*) (.?)Pa", key).groups()
        peak = envelope.von_mises.max()
        factor = {"": 1, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}[unit]
        self.assertAlmostEqual(factor * number(value) / peak, 1, delta=5e-3)
        exact = {
            "von_mises": von_mises(stress),
            "principal": ends[..., 0],
            "shear": (ends[..., 0] - ends[..., 2]) / 2,
        }
        if len(wanted) > 1:
            exact |= {f"most_{name}": [getattr(envelope, name)] * len(wanted) for name in list(exact)}
        self.assertEqual(set(got), set(exact))
        for name, values in exact.items():
            # 3e-4 root mean square for the few fields in place of all, and roundings to 15 bits.
            np.testing.assert_allclose(got[name], values, rtol=0, atol=2e-3 * peak, err_msg=name)
            self.assertGreater(np.abs(values).max(), 0.01 * peak)

    def test_stress_is_a_colour_of_the_motion(self):
        self.write("block.geo", scenes.skewed_block(0.5))
        more = '[output]\nstress = true\nsnapshot_every = 20\n[motion]\nrotation = "finite"\n'
        scene = self.write("slide.toml", scenes.sliding_block(more))
        result = impact(scene, self.folder / "out")
        path, _, run = self.page(result.path)
        self.opened(path, "stress")
        during = np.flatnonzero(result.surface_stress("block").any(axis=(1, 2)))
        self.check_stress(result, "block", [int(during[len(during) // 3]), int(during[-1])])
        self.assertLess(run["motion"]["stress_missed"], 2e-3)
        # A contact that lies between the moments that are sampled sets the scale nevertheless.
        scale, whole = self.browser.evaluate(
            """(() => { const {motion} = shown;
motion.colour = "deformation"; motion.most = {}; const whole = motion.topAt([...motion.time]);
motion.sampled = () => [0]; return [motion.top(), whole]; })()"""
        )
        self.assertGreater(scale, 0.5 * whole)
        self.assertLessEqual(scale, whole)
        # At rest, there is one moment, whose stress is the envelope.
        sets = ['contact.scheme="static"', "loads.gravity=[0,0,-0.1]", 'motion.rotation="linear"']
        result = impact(scene, self.folder / "rest", *sets)
        path, _, _ = self.page(result.path)
        self.opened(path, "stress at rest")
        self.check_stress(result, "block", [0])

    def test_bodies_at_rest_have_a_page_with_their_pressure(self):
        scene, out = MESHES / "hertz/resting-ball.toml", self.folder / "out"
        sets = ["output.view=true", "output.snapshot_every=1", "bodies.ball.geometry={size=1e-4}"]
        impact(scene, out, *sets)
        path, _, run = self.page(*out.glob("*.result.h5"))
        found = self.opened(path, "static")
        self.numbers_agree(found, self.summary(out))
        self.assertRegex(found.one(id="verdict")[2], r"^The bodies press on each other with \d.* N\.$")
        captions = " ".join(found.one(id=name)[2] for name in ("motion", "contact", "energy"))
        self.assertFalse(
            [word for word in ("in these moments", "kinetic", "lost in", "first touch") if word in captions]
        )
        self.assertNotIn("errors", [e[1].get("id") for e in found.found])
        (chart,) = run["charts"]["contact"]
        pressure = unpacked(chart["lines"][0]["y"])
        self.assertAlmostEqual(
            pressure.max(), self.summary(out)["pairs"][0]["peak_pressure_pa"], delta=1e-6 * pressure.max()
        )  # 32 bits
        (result,) = out.glob("*.result.h5")
        done = Command("plot", result)
        self.assertEqual(
            (done.status, done.err),
            (2, f"ricochet plot: {result}: bodies at rest have no motion to draw. Use ricochet report.\n"),
        )


if __name__ == "__main__":
    unittest.main()
