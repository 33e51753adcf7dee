# SPDX-License-Identifier: BSD-2-Clause
"""Fills the template of the page with style, scripts and data. The page needs no other file."""
import base64
import hashlib
import html
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ricochet import files
from ricochet.errors import InputError

FOLDER = Path(__file__).resolve().parent / "assets"
SHARED = ["base.js", "charts.js", "surface.js", "motion.js", "film.js", "player.js"]
REPORT = [*SHARED, "overlay.js", "modes.js", "engine.js", "instrument.js", "page.js"]
MODAL = [*SHARED, "overlay.js", "modes.js", "modal.js"]
SURFACES = [*SHARED, "overlay.js", "pick.js", "surfaces.js"]
INSTRUMENT = [*SHARED, "engine.js", "instrument.js", "play.js"]
LARGEST_MB = 16


def numbers(value: Any) -> Any:
    """Converts NumPy values to values that json can write."""
    return value.tolist()


def page_of(run: dict[str, Any], template: str, scripts: Sequence[str]) -> str:
    """The text of the page. Its content security policy allows only these scripts of this folder, by their
    hash, and what the engine of sounds starts: WebAssembly and the audio thread."""
    script = "\n" + "\n".join((FOLDER / name).read_text() for name in scripts)
    data = json.dumps(run, ensure_ascii=False, allow_nan=False, separators=(",", ":"), default=numbers)
    sounds = "engine.js" in scripts
    worklet = f'<script type="text/plain" id="worklet">{(FOLDER / "worklet.js").read_text()}</script>\n'
    parts = {
        "title": html.escape(run["title"]),
        "style": (FOLDER / "page.css").read_text(),
        "data": data.replace("<", "\\u003c"),
        "worklet": worklet if sounds else "",
        "script": script,
        "hash": base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
        "engine": " 'wasm-unsafe-eval' data:" if sounds else "",
    }
    page, rest = "", "".join((FOLDER / name).read_text() for name in ("head.html", template, "tail.html"))
    while "{{" in rest:
        before, _, rest = rest.partition("{{")
        name, _, rest = rest.partition("}}")
        page += before + parts[name]
    return page + rest


def save_page(
    run: dict[str, Any],
    path: Path,
    template: str = "page.html",
    scripts: Sequence[str] = REPORT,
    smaller: str = "A larger output.snapshot_every, no output.view or fewer receivers make it smaller.",
) -> None:
    """Writes the page atomically. `smaller` is the advice if it is too large. Raises InputError."""
    page = page_of(run, template, scripts).encode()
    if len(page) > LARGEST_MB * 2**20:
        raise InputError(
            f"{path}: the page would have {len(page) / 2**20:.0f} MB, more than {LARGEST_MB}. {smaller}"
        )
    with files.writing(path, "--out"):
        path.parent.mkdir(parents=True, exist_ok=True)
        files.write(path, page)
