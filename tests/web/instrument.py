# SPDX-License-Identifier: BSD-2-Clause
"""Pages to play: forces in Node and sound in Chromium are those of the native library; the page is struck by mouse, finger and
keyboard. `instrument.py --keep FOLDER` also keeps the page and pictures of it in FOLDER."""

import base64
import json
import re
import shutil
import time
import unittest

import numpy as np

from programs import MESHES, Command, ProgramTest, Run, impact
from report_test import KEEP, shared_browser

import ricochet
from ricochet.instruments import write_instrument
from ricochet.kernel import Kernel
from ricochet.pages.page import FOLDER

RATE = 44100
SECONDS = 1
# The bell of the tutorial with a coarse mesh. It rings for SECONDS. Finding the places that the clapper reaches takes most of
# the time; a coarse clapper has few points.
COARSE = [
    ("bell.toml", "order = 2", "order = 1"),
    ("bell.geo", "size = {30", "size = {60"),
    ("bell.geo", "struck = {6", "struck = {30"),
    ("bell.geo", "around = {12", "around = {8"),
    ("bell.toml", 'mesh = "ball.geo"', 'mesh = "ball.geo"\nsize_factor = 3'),
    ("bell.toml", "up_to_hz = 8000", "up_to_hz = 4000"),
]

NODE = """
const {readFileSync} = require("fs"), [script, wasm, block, rate, speed, samples] = process.argv.slice(1);
const Engine = new Function(`${readFileSync(script, "utf8")}\\nreturn Engine;`)();
const engine = new Engine(readFileSync(wasm), readFileSync(block), Number(rate));
if (!engine.strike({speed: Number(speed)})) throw new Error("no strike");
engine.process(Number(samples));
console.log(JSON.stringify({rate: engine.contactRate, forces: Array.from(engine.forces())}));
"""

# Renders the blow of the scene offline, as base64 of two channels one after the other.
OFFLINE = """(async () => {
  const data = run.instrument, samples = %d, rate = %d, context = new OfflineAudioContext(2, samples, rate);
  const script = `${Engine}\\n${document.getElementById("worklet").textContent}`;
  await context.audioWorklet.addModule(`data:text/javascript,${encodeURIComponent(script)}`);
  const processorOptions = {wasm: bytesOf(data.wasm), block: bytesOf(data.block), strikes: [{speed: data.speed}]};
  new AudioWorkletNode(context, "ricochet", {numberOfInputs: 0, outputChannelCount: [2], processorOptions}).connect(context.destination);
  const sound = await context.startRendering();
  const bytes = new Uint8Array(sound.getChannelData(0).buffer);
  let text = "";
  for (let k = 0; k < bytes.length; k += 8192) text += String.fromCharCode(...bytes.subarray(k, k + 8192));
  return btoa(text);
})()"""


def left_by_modes(sound, rate, kernel, cents):
    """The share of a sound, as root mean square, that the damped modes of a kernel do not make up if all are shifted."""
    decay = kernel.decay_rate
    omega = np.sqrt(kernel.angular_frequency**2 - decay**2) * 2 ** (cents / 1200)
    waves = np.exp(np.outer(np.arange(len(sound)) / rate, 1j * omega - decay))
    waves = np.concatenate([waves.real, waves.imag], axis=1)
    amounts = np.linalg.lstsq(waves, sound, rcond=None)[0]
    return np.linalg.norm(sound - waves @ amounts) / np.linalg.norm(sound)


def run_of(page):
    return json.loads(
        re.search(r'<script type="application/json" id="run">(.*?)</script>', page, re.DOTALL)[1]
    )


def place_of(selector):
    """JavaScript that scrolls to an element and gives its middle."""
    return (
        f"(() => {{ const e = document.querySelector({json.dumps(selector)}); e.scrollIntoView({{block: 'center'}}); "
        "const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()"
    )


class Bell(ProgramTest):
    shown = "document.getElementById('play').dataset"  # what the page tells tests

    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        shutil.copytree(MESHES / "bell", cls.made, dirs_exist_ok=True)
        for name, before, after in COARSE:
            path = cls.made / name
            text = path.read_text()
            assert text.count(before) >= 1, (name, before)
            path.write_text(text.replace(before, after))
        scene = cls.made / "bell.toml"
        cls.page = write_instrument(scene, cls.made / "bell.html", spacing=0.1, ranks=1)
        cls.scene = ricochet.Scene(scene)
        cls.scene.set({"time.duration": SECONDS, "output.every": 1000, "output.snapshot_every": 0})
        cls.result = impact(cls.scene, cls.scene.out)
        cls.own_page = write_instrument(cls.result.path, cls.made / "own.html")

    def opened(self, page, *size):
        self.assertTrue(shutil.which("chromium"), "no chromium: scripts/setup --tests installs it")
        browser = shared_browser()
        browser.messages.clear(), browser.requests.clear()
        browser.open(page, *size)
        return browser

    # 1e-12 of the peak: round-off. The library steps in blocks, with fused multiply and add; the player in WebAssembly, without.
    def test_forces_in_node_are_those_of_the_native_library(self):
        instrument = run_of(self.own_page.read_text())["instrument"]
        files = {}
        for name in ("wasm", "block"):
            files[name] = self.folder / name
            files[name].write_bytes(base64.b64decode(instrument[name]))
        samples = 400
        self.assertTrue(shutil.which("node"), "no node: scripts/setup --tests installs it")
        words = ["node", "-e", NODE, FOLDER / "engine.js", files["wasm"], files["block"], RATE, 1, samples]
        done = Run(words)
        self.assertEqual(done.status, 0, done.err)
        found = json.loads(done.out)
        self.assertEqual(found["rate"], 8 * RATE)
        native = ricochet.Simulation(self.scene).step_block(8 * samples).total_force
        forces = np.array(found["forces"])
        self.assertGreater(len(forces), 8)
        self.assertGreater(native.max(), 1e4)
        self.assertLess(np.abs(forces - native[: len(forces)]).max(), 1e-12 * native.max())
        self.assertEqual(np.abs(native[len(forces) :]).max(), 0)

    # 1e-6 of the loudest: both are written in single precision. The native sound is resampled from 352.8 kHz by a filter that is
    # flat far beyond the band of the modes; its first sample is that of t = 0, and its largest one is at full scale.
    def test_sound_in_the_browser_is_the_native_sound(self):
        browser = self.opened(self.own_page)
        data = base64.b64decode(browser.evaluate(OFFLINE % (SECONDS * RATE, RATE)))
        sound = np.frombuffer(data, "<f4").astype(float)
        self.assertEqual((browser.messages, browser.requests), ([], [self.own_page.resolve().as_uri()]))
        (full_scale,) = (sound["full_scale_m_per_s"] for sound in self.result.summary["sounds"].values())
        (file,) = self.scene.out.glob("*.mic.wav")
        raw = file.read_bytes()
        native = full_scale * np.frombuffer(raw[raw.index(b"data") + 8 :], "<f4").reshape(-1, 3)[1:, 0]
        inner = slice(100, len(native) - 100)  # beyond the ends of the filter
        self.assertLess(np.abs(sound[: len(native)] - native)[inner].max(), 1e-6 * np.abs(native).max())

    def test_it_is_struck_by_mouse_finger_and_keys_and_heard(self):
        browser = self.opened(self.page)

        def struck(number):
            browser.wait_for(f"{self.shown}.blows === '{number}'")

        before = browser.evaluate("document.querySelector('.status').textContent")
        self.assertEqual(before, "Not struck yet.")
        browser.click(*browser.evaluate(place_of("#play .stage canvas")))
        struck(1)
        time.sleep(1)  # the analyser must hear nothing but the ringing
        self.heard_partials_are_modes(browser)
        shown = browser.evaluate("document.querySelector('.status').textContent")
        self.assertRegex(
            shown,
            r"^Struck at place \d+ with clapper at 1 m/s: at most [\d.]+ kN, over [\d.]+ µs. Strongest partials",
        )
        picture = browser.evaluate("document.querySelector('.stage canvas').toDataURL()")
        place = browser.evaluate("played.place")
        browser.press("ArrowRight")
        self.assertNotEqual(browser.evaluate("played.place"), place)
        self.assertNotEqual(browser.evaluate("document.querySelector('.stage canvas').toDataURL()"), picture)
        browser.press(" ", " ")
        struck(2)
        browser.press("Enter", "\r")
        struck(3)
        self.controls_change_the_blow(browser, struck)
        self.keep(browser, 1280)
        browser.open(self.page, 390, 844)
        self.assertLessEqual(browser.evaluate("document.documentElement.scrollWidth"), 390)
        browser.tap(*browser.evaluate(place_of("#play .stage canvas")))
        struck(1)
        self.keep(browser, 390)
        self.assertEqual(browser.messages, [])
        self.assertEqual(browser.requests, 2 * [self.page.resolve().as_uri()])

    def heard_partials_are_modes(self, browser):
        browser.evaluate("played.voice.analyser.fftSize = 32768")
        time.sleep(1)
        data = browser.evaluate(
            "(() => { const out = new Float32Array(32768); played.voice.analyser.getFloatTimeDomainData(out); return Array.from(out); })()"
        )
        rate = browser.evaluate("played.voice.context.sampleRate")
        kernel = Kernel(next(self.made.glob("out/bell-*.kernel.h5")))
        left = {cents: left_by_modes(np.array(data), rate, kernel, cents) for cents in (-1, 0, 1)}
        self.assertLess(left[0], 1e-6)  # single precision
        self.assertGreater(min(left[-1], left[1]), 0.1)
        shown = browser.evaluate("document.getElementById('play').dataset.partials").split()
        self.assertEqual(len(shown), 3)
        for partial in shown:
            self.assertLess(np.abs(kernel.frequency / float(partial) - 1).min(), 1e-6)

    def controls_change_the_blow(self, browser, struck):
        """A soft mallet presses longer and less; a faster one harder; with damping, the sound ends."""
        act = "(control, value, type) => { control.value = value; control.dispatchEvent(new Event(type)); }"

        def peak_after(change, number):
            browser.evaluate(f"({act})({change})")
            browser.click(*browser.evaluate(place_of("#play button.strike")))
            struck(number)
            return float(browser.evaluate(f"{self.shown}.peak"))

        hard = float(browser.evaluate(f"{self.shown}.peak"))
        soft = peak_after("played.mallet, 2, 'change'", 4)
        self.assertLess(soft, 0.5 * hard)
        self.assertGreater(peak_after("played.speed, 1, 'input'", 5), 3 * soft)
        browser.evaluate(f"({act})(played.damping, 2, 'input')")
        browser.wait_for("Math.max(...played.voice.spectrum()) < -100")

    def keep(self, browser, wide):
        if KEEP:
            KEEP.mkdir(parents=True, exist_ok=True)
            browser.screenshot(KEEP / f"instrument-{wide}.png")
            shutil.copy(self.page, KEEP)

    def test_the_page_of_a_run_can_be_played_too(self):
        page = ricochet.report(self.result, self.folder / "report.html")
        browser = self.opened(page)
        browser.click(*browser.evaluate(place_of("#play button.strike")))
        browser.wait_for(f"{self.shown}.blows === '1'")
        peak = float(browser.evaluate(f"{self.shown}.peak"))
        # The first place is that of the run, but the rate of the device may differ from that of the scene.
        self.assertAlmostEqual(peak, self.result.summary["peak_force_n"], delta=0.1 * peak)
        self.assertEqual((browser.messages, browser.requests), ([], [page.resolve().as_uri()]))

    def test_the_page_is_small(self):
        instrument = run_of(self.page.read_text())["instrument"]
        self.assertLess(len(base64.b64decode(instrument["wasm"])), 300_000)
        self.assertLess(self.page.stat().st_size, 5e6)
        self.assertGreater(instrument["points"]["shape"][0], 20)

    def test_scenes_without_a_mallet_are_refused_in_one_line(self):
        for words, reason in (
            ([self.made / "bell.toml", "--body", "drum"], "no pair of 'drum' with another body"),
            ([self.result.path, "--spacing", "0.1"], "is a result"),
            ([self.folder / "none.toml"], "none.toml"),
        ):
            self.refused(Command("export", "--web", *words, "-o", self.folder / "none.html"), reason)
        self.assertFalse((self.folder / "none.html").exists())

    def test_every_control_has_a_name_and_can_be_reached_by_keyboard(self):
        browser = self.opened(self.page)
        nodes = browser.call("Accessibility.getFullAXTree")["nodes"]
        roles = {}
        for node in nodes:
            if not node["ignored"]:
                roles.setdefault(node["role"]["value"], []).append(node.get("name", {}).get("value", ""))
        self.assertEqual(len(roles["slider"]), 4)
        for role in ("application", "button", "slider", "combobox", "image"):
            self.assertTrue(roles[role] and all(roles[role]), f"{role}: {roles.get(role)}")
        self.assertEqual(len(roles["status"]), 1)
        tabbed = browser.evaluate(
            "[...document.querySelectorAll('canvas, button, input, select')].filter(e => e.tabIndex === 0).length"
        )
        self.assertEqual(tabbed, 7)


if __name__ == "__main__":
    unittest.main()
