# SPDX-License-Identifier: BSD-2-Clause
"""The mistakes of mistakes.toml, and the files among which they are made."""

import dataclasses
import pathlib
import tomllib

import scenes


@dataclasses.dataclass
class Mistake:
    """A command that is mistaken. mistakes.toml describes the fields."""

    what: str
    command: str
    answer: str
    change: tuple[str, str] | None = None
    status: int = 2
    env: dict[str, str] = dataclasses.field(default_factory=dict)
    reader: bool = False


TABLE = tomllib.loads(pathlib.Path(__file__).with_name("mistakes.toml").read_text())


def sections():
    """Mistakes by title of their section."""
    return {
        section["title"]: [
            Mistake(*entry[:3], **{"reader": section.get("reader", False)} | dict(*entry[3:]))
            for entry in section["mistakes"]
        ]
        for section in TABLE["section"]
    }


STEEL = "density = 7800, young = 210e9"
SCENE = scenes.two_rods("Rods", "count = 8", "rate_hz = 100000\nduration = 0.001", ("a", "b"), speed=1)
SCENE = SCENE.replace("density = 1.0, young = 1.0, area = 1.0", f"{STEEL}, area = 1e-4")
BLOCK = scenes.block_on_floor(
    "Block",
    "count = 8",
    "",
    "rate_hz = 20000\nduration = 0.001",
    f"velocity = [0, 0, -1]\nmaterial = {{ {STEEL}, poisson = 0.3 }}",
)
SHEET = 'SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 1, 1};\nPhysical Surface("foot") = {1};\n'
FILES = {
    "rod.geo": scenes.rod(),
    "block.geo": scenes.skewed_block(0.6),
    "sheet.geo": SHEET,
    "scene.toml": SCENE,
    "block.toml": BLOCK,
    "speeds.toml": 'scene = "scene.toml"\n[list]\n"bodies.a.velocity[0]" = [1.0, 2.0]\n',
    "study.toml": 'scene = "scene.toml"\n[grid]\n"contact.gap" = [0.0, 0.1]\n',
    "empty.toml": "",
    "empty.msh": "",
    "part.inp": "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n*ELEMENT, TYPE=S3\n1, 1, 2, 3\n",
    "empty.result.h5": "",
    "binary.toml": "\x00\x01\x02",
    "folder/note.txt": "",
}
BYTES = {
    "utf16.toml": SCENE.encode("utf-16"),
    "latin1.toml": ("# Körper\n" + SCENE).encode("latin-1"),
    "cut.toml": SCENE.encode()[: SCENE.index("velocity") + 10],
}
