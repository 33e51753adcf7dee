# SPDX-License-Identifier: BSD-2-Clause
"""Opens pages of ricochet report in a browser without network and reads their numbers, for the tests in report.py."""

import atexit
import base64
import functools
import html.parser
import json
import pathlib
import re
import shutil
import sys
import tempfile

import numpy as np

from programs import Command, ProgramTest


KEEP = None
if sys.argv[1:2] == ["--keep"]:
    KEEP = pathlib.Path(sys.argv[2])
    del sys.argv[1:3]


class Elements(html.parser.HTMLParser):
    """(tag, attributes, inner text) of all elements of a document."""

    VOID = {"meta", "input", "img", "br", "link"}

    def __init__(self, text):
        super().__init__()
        self.found, self.open = [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found.append([tag, dict(attributes), ""])
        if tag not in self.VOID:
            self.open.append(self.found[-1])

    def handle_endtag(self, tag):
        while self.open and self.open.pop()[0] != tag:
            pass

    def handle_data(self, data):
        for element in self.open:
            element[2] += data

    def one(self, **wanted):
        (element,) = [
            e
            for e in self.found
            if all(e[1].get(name.replace("_", "-")) == value for name, value in wanted.items())
        ]
        return element


# Without a screen and without network. Only the canvases are drawn by the software renderer of OpenGL: it would take three
# times as long for the rest of the page.
CHROMIUM = [
    "chromium",
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu-compositing",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--no-first-run",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--proxy-server=127.0.0.1:9",
    "--hide-scrollbars",
]


@functools.cache
def shared_browser():
    """A browser for all pages of this process: it takes longer to start than to show a page."""
    from browser import Browser

    scope = tempfile.TemporaryDirectory(prefix="ricochet-browser-", ignore_cleanup_errors=True)
    atexit.register(scope.cleanup)
    browser = Browser(scope.name)
    atexit.register(browser.close)
    return browser


def number(text):
    """The value of a text such as "−1.5 × 10⁻³ mN s" or "2 %", without the unit."""
    match = re.match(r"(−?[\d.]+)(?: × 10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?(?: ([numkMG]?)|µ)?", text)
    power = (match[2] or "⁰").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
    return float(match[1].replace("−", "-")) * 10.0 ** int(power)


def flat(value, path=""):
    """The numbers of a summary by dotted path."""
    if isinstance(value, dict):
        return {
            key: item for name, part in value.items() for key, item in flat(part, f"{path}{name}.").items()
        }
    if isinstance(value, list):
        return {key: item for k, part in enumerate(value) for key, item in flat(part, f"{path}{k}.").items()}
    return {path[:-1]: value}


def unpacked(packed):
    values = np.frombuffer(base64.b64decode(packed["data"]), "<" + packed["type"]).reshape(packed["shape"])
    return values * packed.get("scale", 1.0)


def data_of(page):
    """The data of a page."""
    return json.loads(
        re.search(r'<script type="application/json" id="run">(.*?)</script>', page.read_text(), re.DOTALL)[1]
    )


class ReportTest(ProgramTest):
    def page(self, result, *more):
        """The page of a result: path, text and data."""
        path = self.folder / "page.html"
        done = self.succeed(Command("report", result, "--out", path, *more))
        self.assertEqual(done.out, f"{path}\n")
        return path, path.read_text(), data_of(path)

    def opened(self, path, name, wide=500, high=600):
        """The page in the browser, which must not report any error."""
        self.assertTrue(shutil.which("chromium"), "no chromium: scripts/setup --tests installs it")
        self.browser = shared_browser()
        self.browser.messages.clear()
        self.browser.open(path, wide, high)
        found = Elements(self.browser.evaluate("document.documentElement.outerHTML"))
        root = next(attributes for tag, attributes, _ in found.found if tag == "html")
        self.assertEqual(
            (self.browser.messages, root.get("data-error"), root.get("data-ready")), ([], None, "yes")
        )
        if KEEP:
            KEEP.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, KEEP / f"{name}.html")
            self.browser.screenshot(KEEP / f"{name}.png")
        return found

    def numbers_agree(self, found, summary):
        """Compares each figure on the page with the summary: the attached value exactly, the text to its digits."""
        scalars = {
            key for key, value in summary.items() if value is None or not isinstance(value, (dict, list))
        }
        shown = {}
        for _, attributes, text in found.found:
            if "data-key" in attributes:
                shown.setdefault(attributes["data-key"], []).append(
                    (json.loads(json.dumps(attributes["data-value"])), text)
                )
        self.assertLessEqual(scalars, set(shown))
        values = flat(summary)
        for key, places in shown.items():
            for exact, text in places:
                if key.startswith("exit_velocity."):
                    self.assertEqual(json.loads(exact), summary["exit_velocity"][key.split(".")[1]])
                elif isinstance(values[key], bool):
                    self.assertEqual(json.loads(exact), values[key], key)
                elif isinstance(values[key], (int, float)):
                    self.assertEqual(float(exact), values[key], key)
                    ratio = number(text) / values[key] if values[key] else number(text) + 1
                    decade = 10.0 ** np.round(np.log10(ratio))
                    self.assertAlmostEqual(
                        ratio / decade, 1, delta=0.05 if "error" in key else 6e-3, msg=f"{key}: {text}"
                    )  # two or three digits
                    if "× 10" in text or values[key] == 0:
                        self.assertEqual(decade, 1, f"{key}: {text}")
                else:
                    none = "not known" if key.startswith("error_estimate.") else "–"
                    self.assertEqual(text, none if values[key] is None else str(values[key]), key)
