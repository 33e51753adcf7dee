# SPDX-License-Identifier: BSD-2-Clause
"""A page of ricochet report, made once for the tests of a class and opened in a browser that they drive."""

import base64
import io
import json
import shutil

import numpy as np
from matplotlib.image import imread

import report_test
import ricochet
from programs import MESHES, ProgramTest, impact
from report_test import data_of


class PageTest(ProgramTest):
    """`SCENE` is a folder of meshes/ and the scene in it, `SETS` its overrides. `path` and `data` are those of the page."""

    @classmethod
    def setUpClass(cls):
        assert shutil.which("chromium"), "no chromium: scripts/setup --tests installs it"
        cls.browser = report_test.shared_browser()
        cls.made = cls.shared_folder()
        shutil.copytree(MESHES / cls.SCENE, cls.made, dirs_exist_ok=True)
        cls.scene, cls.out = cls.made / f"{cls.SCENE}.toml", cls.made / "out"
        cls.result = impact(cls.scene, cls.out, *cls.SETS).path
        cls.path, cls.data = cls.write_page()

    @classmethod
    def write_page(cls):
        """Path and data of the page."""
        page = ricochet.report(cls.result, cls.made / "page.html")
        return page, data_of(page)

    def opened_at(self, wide, high):
        self.browser.messages.clear()
        self.browser.open(self.path, wide, high)
        self.addCleanup(lambda: self.assertEqual(self.browser.messages, []))

    def keep(self, name):
        if report_test.KEEP:
            report_test.KEEP.mkdir(parents=True, exist_ok=True)
            self.browser.screenshot(report_test.KEEP / f"{name}.png")

    def pixels(self):
        """(rows, columns, 4) of the canvas, from 0 to 255."""
        url = self.browser.evaluate("shown.canvas.toDataURL()")
        return np.rint(255 * imread(io.BytesIO(base64.b64decode(url.split(",")[1])))).astype(int)

    def pressed(self, text):
        self.assertTrue(
            self.browser.evaluate(
                f"(() => {{ const it = [...document.querySelectorAll('.cockpit button')].find(b => b.textContent === "
                f"{json.dumps(text)} && b.offsetParent); it?.click(); return Boolean(it); }})()"
            ),
            text,
        )

    def node_of_tree(self, role, name):
        tree = self.browser.call("Accessibility.getFullAXTree")["nodes"]
        (node,) = [
            node
            for node in tree
            if node.get("role", {}).get("value") == role and node.get("name", {}).get("value") == name
        ]
        return node | {item["name"]: item["value"].get("value") for item in node.get("properties", [])}
