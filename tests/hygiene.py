# SPDX-License-Identifier: BSD-2-Clause
"""Every source has its licence line; C++ is formatted; what is cited has the version of the project; rooms
do not include each other in a circle; no tracked file is large, a fuzzing artefact or names a machine's folder.

    python3 tests/hygiene.py [FOLDER]          # status 1 and one line per finding; 77 without a git checkout
    python3 tests/hygiene.py [FOLDER] --all    # the format of all C++ files, not only of those that changed lately
"""
import graphlib
import re
import subprocess
import sys
from pathlib import Path

LICENCE = "SPDX-License-Identifier: BSD-2-Clause"
SOURCES = {".c", ".cmake", ".cpp", ".css", ".h", ".hpp", ".js", ".py", ".sh"}
ARTEFACT = re.compile(r"(crash|leak|oom|timeout|slow-unit)-")
HOME = re.compile(rb"/(home|root|work|Users)/\w")
LARGEST = 1 << 20
# Every commit passes the tests, so a file that none of so many has changed was checked before.
COMMITS = 20
INCLUDE = re.compile(r'^#include "([^"]+/[^"]+)"', re.MULTILINE)
UNFORMATTED = re.compile(r"^(?:\./)?(\S+?):(\d+):\d+: error: code should be clang-formatted", re.MULTILINE)


def listed(root, *words):
    """The paths that a command of git lists."""
    done = subprocess.run(["git", "-C", root, *words], capture_output=True, text=True, check=True)
    return set(done.stdout.splitlines())


def new(root, *patterns):
    """The files of a checkout that git does not know."""
    return listed(root, "ls-files", "--others", "--exclude-standard", "--", *patterns)


def changed_lately(root):
    """The files that changed in the last commits or since."""
    commits = listed(root, "log", f"-{COMMITS}", "--name-only", "--format=")
    return commits | listed(root, "diff", "--name-only", "HEAD") | new(root)


def is_source(path, content):
    return path.suffix in SOURCES or path.name == "CMakeLists.txt" or content.startswith(b"#!")


def findings(root, names):
    for name in names:
        path = root / name
        if not path.is_file():
            continue
        content = path.read_bytes()
        if ARTEFACT.match(path.name):
            yield f"{name}: is an artefact of a fuzzer: remove it, or keep it in tests/fuzz/corpus under another name"
        if len(content) > LARGEST:
            yield f"{name}: has {len(content)} bytes, more than 1 MiB"
        if name.startswith("tests/fuzz/corpus/"):
            continue
        if (
            content
            and is_source(path, content)
            and LICENCE.encode() not in b"\n".join(content.split(b"\n")[:3])
        ):
            yield f"{name}: has no line {LICENCE}"
        if found := HOME.search(content):
            line = content.count(b"\n", 0, found.start()) + 1
            yield f"{name}:{line}: names a folder of one machine"


def unformatted(root, names):
    sources = [name for name in names if name.endswith((".cpp", ".hpp")) and (root / name).is_file()]
    if not sources:
        return
    try:
        run = subprocess.run(
            ["clang-format", "--dry-run", "--Werror", *sources], cwd=root, capture_output=True, text=True
        )
    except FileNotFoundError:
        yield "clang-format is not installed: run scripts/setup --tests"
        return
    first = {}  # line of each file
    for name, line in UNFORMATTED.findall(run.stderr):
        first.setdefault(name, line)
    for name, line in first.items():
        yield f"{name}:{line}: is not formatted: run clang-format -i {name}"
    if run.returncode != 0 and not first:
        yield run.stderr.strip()


def room(path):
    """The room of a file, as in CONTRIBUTING.md: src/mesh, contact/law, kernels, …"""
    parts = path.split("/")
    return "/".join(parts[:2]) if parts[0] in ("contact", "src") and len(parts) > 2 else parts[0]


def circles(root, names):
    uses = {}
    for name in names:
        path = root / name
        if name.endswith((".cpp", ".hpp")) and not name.startswith("tests/") and path.is_file():
            included = {room(found) for found in INCLUDE.findall(path.read_text())}
            uses.setdefault(room(name), set()).update(included - {room(name)})
    try:
        graphlib.TopologicalSorter(uses).prepare()
    except graphlib.CycleError as error:
        yield f"{' ← '.join(error.args[1])}: rooms include each other in a circle"


def versions(root):
    """What is cited has the version of the project, and its authors."""
    version = re.search(r"project\(Ricochet VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text())
    cited = root / "CITATION.cff"
    if not version or not cited.is_file():
        return
    lines = cited.read_text().splitlines()
    for wanted in (f"version: {version[1]}", "  - name: the Ricochet developers", "license: BSD-2-Clause"):
        if wanted not in lines:
            yield f"CITATION.cff: has no line {wanted.strip()}"
    if f"version {version[1]}," not in (root / "docs/results.md").read_text():
        yield f"docs/results.md: Citing: does not name version {version[1]}"


def main(root, every):
    done = subprocess.run(["git", "-C", root, "ls-files", "-z"], capture_output=True, text=True)
    if done.returncode != 0:
        print(f"{root}: not a git checkout")
        return 77
    names = list(filter(None, done.stdout.split("\0")))
    changed = changed_lately(root)
    formatted = names if every or ".clang-format" in changed else [name for name in names if name in changed]
    found = [*findings(root, names), *versions(root), *circles(root, names), *unformatted(root, formatted)]
    print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    folders = [word for word in sys.argv[1:] if word != "--all"] or [Path(__file__).resolve().parents[1]]
    sys.exit(main(Path(folders[0]), "--all" in sys.argv))
