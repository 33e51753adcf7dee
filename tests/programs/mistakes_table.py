# SPDX-License-Identifier: BSD-2-Clause
"""Mistakes of newcomers, each with the words that the answer must contain. mistakes.py makes them and docs/mistakes.md shows them."""

import dataclasses

import scenes


@dataclasses.dataclass
class Mistake:
    """A command that is mistaken, in a folder with the files of `FILES`.

    @param what     the mistake, as the page names it
    @param command  the command line, for sh
    @param answer   a regular expression for the line on standard error: place, value found and remedy
    @param change   (old, new): a text in scene.toml and what `wrong.toml`, which the command names, has in its place
    @param status   0 for a warning
    """

    what: str
    command: str
    answer: str
    change: tuple[str, str] | None = None
    status: int = 2
    variables: dict[str, str] = dataclasses.field(default_factory=dict)


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
    "study.toml": 'scene = "scene.toml"\n[grid]\n"contact.gap" = [0.0, 0.1]\n',
    "empty.toml": "",
    "empty.msh": "",
    "empty.result.h5": "",
    "binary.toml": "\x00\x01\x02",
    "folder/note.txt": "",
}
BYTES = {
    "utf16.toml": SCENE.encode("utf-16"),
    "latin1.toml": ("# Körper\n" + SCENE).encode("latin-1"),
    "cut.toml": SCENE.encode()[: SCENE.index("velocity") + 10],
}
VELOCITY = "bodies.a.velocity=[0, 0, -1]"

WORDS = [
    Mistake("no verb", "ricochet scene.toml", "scene.toml is a file: .* ricochet run scene.toml"),
    Mistake("the verb after the scene", "ricochet scene.toml impact", "ricochet impact scene.toml"),
    Mistake("a misspelt verb", "ricochet swep study.toml", '"swep": did you mean "sweep"'),
    Mistake("the name of a program as verb", "ricochet contact scene.toml", 'did you mean "impact"'),
    Mistake("no scene", "ricochet run", "required: SCENE.toml"),
    Mistake("no scene for a program", "ricochet-contact", "SCENE is required: name a file"),
    Mistake("two scenes", "ricochet run scene.toml block.toml", "block.toml: is one word too many: give one SCENE"),
    Mistake("two scenes", "ricochet impact scene.toml block.toml", "block.toml: .*give one SCENE"),
    Mistake("a misspelt option", "ricochet run scene.toml --acuracy 0.1", "did you mean --accuracy"),
    Mistake("a misspelt option", "ricochet impact scene.toml --quite", "did you mean --quiet"),
    Mistake("an option of another verb", "ricochet run scene.toml --vtk", "--vtk: is an option of ricochet impact"),
    Mistake("an option of another verb", "ricochet impact scene.toml -n 4", "-n: is an option of ricochet kernel"),
    Mistake("blanks in a value without quotes", f"ricochet run scene.toml --set {VELOCITY}", f"quote it.*'{VELOCITY}'".replace("[", r"\[")),
    Mistake("blanks in a value without quotes", f"ricochet impact --set {VELOCITY} scene.toml", f"quote it.*'{VELOCITY}'".replace("[", r"\[")),
    Mistake("a blank in place of =", "ricochet impact scene.toml --set modes.count 5", "write --set modes.count=5"),
    Mistake("a colon in place of =", "ricochet impact scene.toml --set modes.count:5", 'modes.count:5: has no "=": write KEY=VALUE'),
    Mistake("a setting without --set", "ricochet run scene.toml modes.count=5", "write --set 'modes.count=5'"),
    Mistake("nothing after --set", "ricochet impact scene.toml --set", "--set: 1 required KEY=VALUE missing"),
    Mistake("no setting after --set", "ricochet impact --set scene.toml", "scene.toml: is not KEY=VALUE"),
    Mistake("a key that does not exist", "ricochet impact scene.toml --set mode.count=5", 'mode = .*: unknown key. Did you mean "modes"'),
    Mistake("no number of ranks", "ricochet kernel -n scene.toml", "scene.toml: give a number from 1 to 4096"),
    Mistake("too many ranks", "ricochet kernel -n 5000 scene.toml", "5000: give a number from 1 to 4096"),
    Mistake("more ranks than cores (a warning)", "ricochet kernel -n 64 --keys scene.toml | head -0", "64 ranks share .*: -n .* is faster", status=0, variables={"RICOCHET_LAUNCHER": ""}),
]
FILE_KINDS = [
    Mistake("a file that does not exist", "ricochet run none.toml", "none.toml: no such file: name a scene"),
    Mistake("a scene without its ending", "ricochet run scene", "scene: no such file: did you mean scene.toml"),
    Mistake("a folder in place of a scene", "ricochet run out", "out: is a folder: name a scene"),
    Mistake("a result in place of a scene", "ricochet impact out/rods.result.h5", "is a result: name the scene"),
    Mistake("a kernel in place of a scene", "ricochet impact out/a-*.kernel.h5", "is a kernel: name the scene"),
    Mistake("a mesh in place of a scene", "ricochet run rod.geo", "rod.geo: is a mesh or drawing: name a scene"),
    Mistake("a study in place of a scene", "ricochet run study.toml", "is a study: run it with ricochet sweep study.toml"),
    Mistake("an empty scene", "ricochet impact empty.toml", "empty.toml: bodies: is missing: a scene needs a body"),
    Mistake("a binary file", "ricochet impact binary.toml", "binary.toml: is not a text file: name a scene"),
    Mistake("a scene in place of a result", "ricochet plot scene.toml", "is a scene: name its result, out/rods.result.h5"),
    Mistake("a scene that was not computed", "ricochet plot block.toml", "ricochet run block.toml first, then .* out/block.result.h5"),
    Mistake("a folder in place of a result", "ricochet plot out", "out: is a folder: .* such as out/rods.result.h5"),
    Mistake("a folder in place of a result", "ricochet report folder", "folder: is a folder: .* ends in .result.h5"),
    Mistake("a kernel in place of a result", "ricochet report out/a-*.kernel.h5", "is a kernel: name a result"),
    Mistake("a summary in place of a result", "ricochet plot out/rods.summary.json", "name out/rods.result.h5"),
    Mistake("a study in place of a result", "ricochet plot study.toml", "is a study: name the result"),
    Mistake("a mesh in place of a result", "ricochet plot rod.geo", "is a drawing or mesh: name a result"),
    Mistake("a result that does not exist", "ricochet plot out/none.result.h5", "none.result.h5: there is no such file. Name a .result.h5"),
    Mistake("an empty result", "ricochet plot empty.result.h5", "empty.result.h5: is not an HDF5 file. Compute it again"),
    Mistake("a scene in place of a drawing", "ricochet surfaces scene.toml", "is a scene: name a drawing or mesh, such as rod.geo"),
    Mistake("a folder in place of a drawing", "ricochet surfaces folder", "folder: is a folder: name a drawing in it"),
    Mistake("a result in place of a drawing", "ricochet surfaces out/rods.result.h5", "is a result or kernel: name a drawing"),
    Mistake("a scene in place of a kernel", "ricochet-recast scene.toml", "scene.toml: is not a kernel: name a file that ends in .kernel.h5"),
    Mistake("a result in place of a kernel", "ricochet-recast out/rods.result.h5", "is not a kernel: name a file"),
    Mistake("a scene in place of matrices", "ricochet import scene.toml", "'scene.toml' .choose from 'calculix', 'matrices'"),
]


def change(what, old, new, answer, verb="impact", status=2):
    return Mistake(what, f"ricochet {verb} wrong.toml", answer, (old, new), status)


SYNTAX = [
    Mistake("a file in UTF-16", "ricochet impact utf16.toml", "utf16.toml: is UTF-16 text: save it as UTF-8"),
    Mistake("a file in Latin-1", "ricochet impact latin1.toml", "latin1.toml:1:3: this is not UTF-8: save"),
    Mistake("a file that was cut off", "ricochet impact cut.toml", "cut.toml:.*: velocity =: a value is missing"),
    change("a text without quotes", '"rod.geo"', "rod.geo", "toml:3:8: mesh = rod.geo: write text in quotes"),
    change("curly quotes", '"rod.geo"', "“rod.geo”", "use straight quotes"),
    change("a quote that is not closed", '"rod.geo"', '"rod.geo', "close the text with a quote"),
    change("a path with backslashes", '"rod.geo"', '"C:\\users\\rod.geo"', "write / in place of"),
    change("a colon in place of =", "mesh =", "mesh:", "write = between key and value"),
    change("a semicolon", '"rod.geo"', '"rod.geo";', "remove the semicolon"),
    change("a comma at the end of a line", "count = 8", "count = 8,", "count = 8,: remove the comma"),
    change("a comment of another language", "count = 8", "count = 8 // modes", "a comment starts with #"),
    change("a decimal comma", "0.001", "0,001", "duration = 0,001: write a decimal point"),
    change("a number without its first digit", "0.001", ".001", "write a digit before the decimal point"),
    change("a unit", "young = 210e9", "young = 210 GPa", "210 GPa.*: give the number alone: docs/keys.md"),
    change("True in place of true", "count = 8", "residual_flexibility = True", "write true or false, in lower case"),
    change("parentheses", "[1, 0, 0]", "(1, 0, 0)", r"velocity = \(1, 0, 0\): write a vector in brackets"),
    change("a vector without commas", "[1, 0, 0]", "[1 0 0]", "separate the entries of a list by commas"),
    change("a list that is not closed", "[1, 0, 0]", "[1, 0, 0", "the list before it is not closed"),
    change("a key without value", "count = 8", "count =", "count =: a value is missing"),
    change("a key that is given twice", "count = 8", "count = 8\ncount = 9", "count = 9: the table has this key already"),
    change("a body that is given twice", "[bodies.b]", "[bodies.a]", r"\[bodies.a\]: the file has this table already"),
    change("a table that is not closed", "[bodies.b]", "[bodies.b", "close the name of the table with ]"),
    change("a blank in place of a dot", "[bodies.b]", "[bodies b]", r"write dots .* \[bodies.NAME\]"),
]
KEYS = [
    change("a misspelt table", "[modes]", "[mode]", 'wrong.toml: mode = .*: unknown key. Did you mean "modes"'),
    change("a misspelt table", "[contact]", "[contacts]", 'Did you mean "contact"'),
    change("a symbol in place of the key", "young = ", "E = ", 'bodies.a.material.E = .*Did you mean "young"'),
    change("a step in place of a rate", "rate_hz = 100000", "dt = 1e-5", 'time.dt = 1e-05: .*Did you mean "rate_hz"'),
    change("a key that is missing", "density = 7800, ", "", "material.density: is missing: give a number in kg/m³"),
    change("a number in quotes", "count = 8", 'count = "8"', 'modes.count = "8": must be a whole number, without quotes'),
    change("true in quotes", "count = 8", 'count = 8\nresidual_flexibility = "true"', '"true": must be true or false, without quotes'),
    change("a fraction", "count = 8", "count = 8.5", "modes.count = 8.5: must be a whole number"),
    change("a negative number", "count = 8", "count = -8", "modes.count = -8: must be at least 1"),
    change("zero", "young = 210e9", "young = 0", "material.young = 0: must be above 0"),
    change("two components", "[1, 0, 0]", "[1, 0]", r"velocity = \[1, 0\]: must be three numbers, \[x, y, z\]"),
    change("a speed in place of a velocity", "[1, 0, 0]", "-1", r"must be three numbers, .*: write \[0, 0, -1\]"),
    change("a misspelt choice", "[contact]", '[contact]\nscheme = "complient"', 'contact.scheme = "complient": must be "compliant"'),
    change("a body that does not exist", '["a", "b"]', '["a", "c"]', 'no body or obstacle "c": there are "a", "b"'),
    change("one body alone", '["a", "b"]', '["a"]', "must name two bodies, or a body and an obstacle"),
    Mistake("a new body by a misspelt name", "ricochet impact scene.toml --set bodies.c.order=2", "bodies.c.mesh: is missing"),
    Mistake("an incompressible material", "ricochet impact block.toml --set bodies.block.material.poisson=0.5", "poisson = 0.5: .*below 0.5. .*try 0.49"),
]
MESHES = [
    change("a misspelt mesh", "rod.geo", "rodd.geo", 'rodd.geo": no such file. Did you mean "rod.geo"'),
    change("a folder in place of a mesh", "rod.geo", "folder", '"folder": is a folder'),
    Mistake("an empty mesh", "ricochet kernel -n 1 block.toml --set bodies.block.mesh=empty.msh", "empty.msh: line 1: is not a gmsh mesh .*: write it with gmsh"),
    Mistake("a mesh of surfaces alone", "ricochet kernel -n 1 block.toml --set bodies.block.mesh=sheet.geo", "sheet.geo: has surface elements but no volume: mesh the volume"),
    Mistake("a misspelt surface", "ricochet kernel -n 1 block.toml --set bodies.block.contact=foots", 'no physical surface "foots": the groups are "foot", "side"'),
    Mistake("a misspelt volume", "ricochet kernel -n 1 block.toml --set 'bodies.block.material={ steel={density=7800,young=210e9} }'", 'no physical volume "steel": the groups are "block"'),
    Mistake("a misspelt support", "ricochet kernel -n 1 block.toml --set 'bodies.block.support={fot=\"xyz\"}'", 'no physical surface "fot": the groups are'),
    Mistake("a parameter that the geometry lacks", "ricochet kernel -n 1 scene.toml --set 'bodies.a.geometry={size=1}'", "geometry.size = 1: .* it defines elements"),
    Mistake("a rod without cross-section", "ricochet kernel -n 1 scene.toml --set 'bodies.a.material={density=7800,young=210e9}'", "give bodies.a.material its cross-section, area = "),
    Mistake("a density in g/cm³ (a warning)", "ricochet kernel --quiet -n 1 block.toml --out w --set bodies.block.material.density=7.8", r"waves in block run at .*density = 7.8 kg/m³\).*check the units", status=0),
    Mistake("a modulus in GPa (a warning)", "ricochet kernel --quiet -n 1 block.toml --out w --set bodies.block.material.young=210", r"young = 210 Pa.*check the units", status=0),
    Mistake("a mesh in millimetres (a warning)", "ricochet kernel --quiet -n 1 scene.toml --out w --set bodies.a.scale=500", "a is 500 m long: check bodies.a.scale .0.001", status=0),
]
IMPACTS = [
    Mistake("no kernel yet", "ricochet impact block.toml", "no kernel for body .block.* Run ricochet-kernel block.toml first"),
    Mistake("a setting that needs another kernel", "ricochet impact scene.toml --set modes.count=9", "no kernel .*with the same --set"),
    change("bodies that overlap", "[-1, 0, 0]", "[-0.5, 0, 0]", 'between "a" and "b": they overlap by 0.5 m .*Move one'),
    change("bodies that face away", "direction = [1", "direction = [-1", 'no point of "a" faces "b" .*Check'),
    change("too short a run (a warning)", "[-1, 0, 0]", "[-1.5, 0, 0]", "nothing touched: .* was 0.499 m. Check velocity", "impact --quiet --set title=w", 0),
    change("too large a step (a warning)", "100000", "20000", "the longest touch has . steps.*Raise time.rate_hz", "impact --quiet --set title=w", 0),
    change("a rod that moves sideways", "[1, 0, 0]", "[0, 0, -1]", "bodies.a.velocity.* A rod moves along its axis"),
    change("a run of less than a step", "0.001", "1e-9", "time.duration = 1e-09: makes 0.0001 samples"),
]
MACHINE = [
    Mistake("--out below a file", "ricochet kernel -n 1 scene.toml --out rod.geo/x", "rod.geo/x: cannot create this folder .Not a directory.: choose another with --out"),
    Mistake("a full disk", "prlimit --fsize=2048 ricochet impact --quiet scene.toml --set title=full", "out/full.result.h5: cannot write the file .File too large.. Is the disk full"),
    Mistake("a wrong RICOCHET_BIN", "ricochet kernel scene.toml", "RICOCHET_BIN=/none must be the folder of the programs", variables={"RICOCHET_BIN": "/none"}),
    Mistake("a folder without programs", "ricochet kernel scene.toml", "folder/ricochet-kernel: no such program: RICOCHET_BIN=folder must", variables={"RICOCHET_BIN": "folder"}),
    Mistake("a launcher that is not installed", "ricochet kernel scene.toml", "nolauncher: no such program: .*RICOCHET_LAUNCHER", variables={"RICOCHET_LAUNCHER": "nolauncher -n {ranks}"}),
    Mistake("a quote that the launcher lacks", "ricochet kernel scene.toml", "RICOCHET_LAUNCHER='mpirun: No closing quotation", variables={"RICOCHET_LAUNCHER": "'mpirun"}),
    Mistake("an output that cannot be written", "ricochet --help > /dev/full", "cannot write to standard output .No space left", status=1),
]
SECTIONS = {
    "Words of the command": WORDS,
    "Files": FILE_KINDS,
    "The text of a scene": SYNTAX,
    "Keys and values": KEYS,
    "Meshes and materials": MESHES,
    "Impacts": IMPACTS,
    "Machine": MACHINE,
}
