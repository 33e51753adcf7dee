# SPDX-License-Identifier: BSD-2-Clause
"""Sources of the core and of the player include only Eigen, the standard library and headers of the core itself.

    core_includes.py COMPILER ROOT EIGEN

EIGEN is the folder of Eigen. The headers of the standard library are those of a unit that includes nothing else.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOMS = ("simd", "pairing", "bodies", "rows", "model", "complementarity", "law", "motion", "stepping")
OWN = re.compile(
    r"(base/(aligned|archive|format|processor|reserved)\.[ch]pp|kernels/(crease_angle\.hpp|kernel\.cpp|flexibility\.[ch]pp|format\.hpp)|include/ricochet/\w+\.hpp|contact/(%s)/\w+\.[ch]pp|player/\w+\.[ch]pp)$"
    % "|".join(ROOMS)
)
STANDARD = "#include <bits/stdc++.h>\n#include <immintrin.h>\n"


def includes(compiler, folders, source, text=None):
    """Absolute paths of all files that a translation unit includes, as listed by the compiler."""
    command = [compiler, "-std=c++20", "-x", "c++", "-M", *[f"-I{folder}" for folder in folders], source]
    rule = subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout
    return {
        str(Path(name).resolve())
        for name in rule.split(":", 1)[1].replace("\\\n", " ").split()
        if name != source or not text
    }


def main():
    compiler, root, eigen = sys.argv[1:]
    root = Path(root).resolve()
    sources = [root / path for path in ("base/format.cpp", "kernels/flexibility.cpp", "kernels/kernel.cpp")]
    for room in ROOMS:
        sources += sorted((root / "contact" / room).glob("*.cpp"))
    sources += sorted((root / "player").glob("*.cpp"))
    assert len(sources) > 20, sources
    known = includes(compiler, [], "-", STANDARD)
    folders = [root, root / "include", eigen]

    def strangers(found):
        for path in sorted(found - known):
            inside = path.removeprefix(f"{root}/")
            if not OWN.match(inside) and not path.startswith(f"{eigen}/"):
                yield inside

    # All sources as one unit: the preprocessor takes long to read the standard library for each.
    together = "".join(f'#include "{source}"\n' for source in sources)
    if not any(strangers(includes(compiler, folders, "-", together))):
        return
    for source in sources:
        for inside in strangers(includes(compiler, folders, str(source))):
            print(f"{source.relative_to(root)} includes {inside}")
    sys.exit(1)


if __name__ == "__main__":
    main()
