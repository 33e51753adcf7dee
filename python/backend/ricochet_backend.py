# SPDX-License-Identifier: BSD-2-Clause
"""Builds wheels and source distributions of the Python package for pip (PEP 517). The wheel contains everything that needs
neither MPI nor PETSc nor gmsh: the package with its extension module, the player, and the programs ricochet-contact and
ricochet-recast. CMake compiles it; this module needs only Python.

    pip install ./python
    pip wheel --no-deps ./python
    pip install ./python --config-settings build-dir=/tmp/ricochet   # default: build/ of the checkout, if it fits
"""
import base64
import contextlib
import hashlib
import importlib
import io
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import tomllib
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

Settings = Mapping[str, Any] | None

PYTHON = Path(__file__).resolve().parents[1]
ROOT = PYTHON.parent
PROJECT: dict[str, Any] = tomllib.loads((PYTHON / "pyproject.toml").read_text("utf-8"))["project"]
PROGRAMS = ("ricochet-contact", "ricochet-recast")
TARGETS = ("ricochet_python", "ricochet_lv2", *PROGRAMS)
OPTIONS = {"PREPROCESSOR": "OFF", "TESTS": "OFF", "EXAMPLES": "OFF", "PYTHON": "ON"}  # each after RICOCHET_
DEBIAN = """cmake ninja-build g++ pkg-config pybind11-dev python3-dev libhdf5-dev libeigen3-dev libfmt-dev libtomlplusplus-dev
nlohmann-json3-dev libcli11-dev libssl-dev libkissfft-dev libsndfile1-dev libsamplerate0-dev lv2-dev"""
# What a source distribution contains: all that CMake reads with these options, and what the files themselves refer to.
SOURCES = """CMakeLists.txt LICENSE README.md CHANGELOG.md base cmake contact include kernels lv2 player python scripts/player
src web""".split()
OLDEST = 315532800  # the first moment that a zip file can state, 1 January 1980


class Refused(SystemExit):
    """Why nothing can be built, in one line."""


# ---- The hooks of pip ----


def get_requires_for_build_wheel(config_settings: Settings = None) -> list[str]:
    """Tools that are missing here and that PyPI has. Libraries come from the system."""
    if fits(folder_of(config_settings)):
        return []
    wanted = {
        "cmake>=3.25": has_cmake(),
        "ninja>=1.10": shutil.which("ninja"),
        "pybind11>=2.10": has_pybind11(),
    }
    return [name for name, there in wanted.items() if not there]


def get_requires_for_build_sdist(config_settings: Settings = None) -> list[str]:
    return []


def prepare_metadata_for_build_wheel(metadata_directory: str, config_settings: Settings = None) -> str:
    folder = Path(metadata_directory) / f"{stem()}.dist-info"
    folder.mkdir()
    for name, content in metadata().items():
        (folder / name).write_text(content, "utf-8")
    return folder.name


def build_wheel(
    wheel_directory: str, config_settings: Settings = None, metadata_directory: str | None = None
) -> str:
    build = folder_of(config_settings)
    compile_in(build)
    with tempfile.TemporaryDirectory(prefix="ricochet-wheel-") as folder:
        run("cmake", "--install", build, "--component", "python", "--strip", "--prefix", folder)
        packages = Path(folder) / "lib/python3/dist-packages"
        programs = packages / "ricochet" / "bin"
        programs.mkdir()
        for name in PROGRAMS:
            shutil.copy2(build / "bin" / name, programs)
            run("strip", programs / name)
        path = Path(wheel_directory) / f"{stem()}-{tag()}.whl"
        write_wheel(path, packages)
    return path.name


def build_sdist(sdist_directory: str, config_settings: Settings = None) -> str:
    path = Path(sdist_directory) / f"{stem()}.tar.gz"
    # The project of a source distribution is its top folder, not python/.
    own = (PYTHON / "pyproject.toml").read_text("utf-8")
    made = {
        "pyproject.toml": own.replace('backend-path = ["backend"]', 'backend-path = ["python/backend"]'),
        "PKG-INFO": metadata()["METADATA"],
    }
    with tarfile.open(path, "w:gz", format=tarfile.PAX_FORMAT) as archive:
        for source in sources():
            name = source.relative_to(ROOT).as_posix()
            add(archive, f"{stem()}/{name}", source.read_bytes(), source.stat().st_mode & 0o111 != 0)
        for name, text in made.items():
            add(archive, f"{stem()}/{name}", text.encode(), False)
    return path.name


# ---- Parts ----


def version() -> str:
    found = re.search(r"project\(Ricochet VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text("utf-8"))
    if not found:
        raise Refused(f"{ROOT}/CMakeLists.txt: states no version: give pip the folder python/ of a checkout")
    return found[1]


def stem() -> str:
    return f"{PROJECT['name']}-{version()}"


def tag() -> str:
    """The interpreter and the system for which a wheel is compiled, as in its name."""
    interpreter = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{interpreter}-{interpreter}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def has_cmake() -> bool:
    if not shutil.which("cmake"):
        return False
    said = subprocess.run(["cmake", "--version"], capture_output=True, text=True).stdout
    found = re.search(r"(\d+)\.(\d+)", said)
    return found is not None and (int(found[1]), int(found[2])) >= (3, 25)


def has_pybind11() -> bool:
    asked = ["pkg-config", "--exists", "pybind11 >= 2.10"]
    return bool(shutil.which(asked[0])) and subprocess.run(asked).returncode == 0


def folder_of(settings: Settings) -> Path:
    """The build folder: that of --config-settings, that of the checkout if it fits, or one for this interpreter."""
    if settings and settings.get("build-dir"):
        return Path(settings["build-dir"]).absolute()
    checkout = ROOT / "build"
    return checkout if fits(checkout) else checkout / f"pip-{tag()}"


def fits(build: Path) -> bool:
    """Whether a build folder is of this tree, for this interpreter, and without instruments."""
    try:
        cache = dict(
            re.findall(r"^(\w+):\w+=(.*)$", (build / "CMakeCache.txt").read_text("utf-8"), re.MULTILINE)
        )
    except OSError:
        return False
    instruments = ("SANITIZE", "COVERAGE", "FUZZ")
    return (
        cache.get("CMAKE_HOME_DIRECTORY") == str(ROOT)
        and cache.get("CMAKE_BUILD_TYPE") == "Release"
        and cache.get("RICOCHET_PYTHON") == "ON"
        and Path(cache.get("PYTHON_EXECUTABLE", "")).resolve() == Path(sys.executable).resolve()
        and not any(cache.get(f"RICOCHET_{name}") == "ON" for name in instruments)
    )


def compile_in(build: Path) -> None:
    """Compiles what the wheel contains, and only what has changed since the last time."""
    if not fits(build):
        words = [f"-DRICOCHET_{name}={value}" for name, value in OPTIONS.items()]
        words += ["-DCMAKE_BUILD_TYPE=Release", f"-DPYTHON_EXECUTABLE={sys.executable}"]
        with contextlib.suppress(ImportError):  # that of PyPI; CMake finds that of the system
            words.append(f"-Dpybind11_DIR={importlib.import_module('pybind11').get_cmake_dir()}")
        if shutil.which("ninja"):
            words += ["-G", "Ninja"]
        if "CXX" not in os.environ and shutil.which(
            "clang++-16"
        ):  # as scripts/build: two thirds of the time of g++
            words += ["-DCMAKE_C_COMPILER=clang-16", "-DCMAKE_CXX_COMPILER=clang++-16"]
        try:
            run("cmake", "-S", ROOT, "-B", build, *words)
        except Refused:
            needed = " ".join(DEBIAN.split())
            raise Refused(
                f"CMake does not find all that a wheel needs. On Debian 12: apt-get install {needed}"
            )
    run("cmake", "--build", build, "--parallel", str(os.cpu_count() or 1), "--target", *TARGETS)


def run(*words: str | Path) -> None:
    """Runs a command, whose output pip shows with --verbose or if it fails."""
    try:
        done = subprocess.run([str(word) for word in words], stdout=sys.stderr)
    except FileNotFoundError:
        raise Refused(f"{words[0]}: no such program: install it, on Debian 12 by apt-get") from None
    if done.returncode != 0:
        raise Refused(f"{words[0]} failed: {' '.join(map(str, words))}")


def metadata() -> dict[str, str]:
    """The files of the folder .dist-info, without RECORD."""
    lines = ["Metadata-Version: 2.1", f"Name: {PROJECT['name']}", f"Version: {version()}"]
    lines += [f"Summary: {PROJECT['description']}", f"License: {PROJECT['license']['text']}"]
    lines += [f"Keywords: {','.join(PROJECT['keywords'])}", f"Requires-Python: {PROJECT['requires-python']}"]
    lines += [f"Classifier: {text}" for text in PROJECT["classifiers"]]
    lines += [f"Requires-Dist: {text}" for text in PROJECT["dependencies"]]
    for extra, needed in PROJECT["optional-dependencies"].items():
        lines += [
            f"Provides-Extra: {extra}",
            *(f'Requires-Dist: {text}; extra == "{extra}"' for text in needed),
        ]
    lines += ["Description-Content-Type: text/markdown", "", (ROOT / "README.md").read_text("utf-8")]
    scripts = [f"{name} = {target}\n" for name, target in PROJECT["scripts"].items()]
    return {
        "METADATA": "\n".join(lines),
        "WHEEL": f"Wheel-Version: 1.0\nGenerator: ricochet_backend\nRoot-Is-Purelib: false\nTag: {tag()}\n",
        "entry_points.txt": "[console_scripts]\n" + "".join(scripts),
        "LICENSE": (ROOT / "LICENSE").read_text("utf-8"),
    }


def write_wheel(path: Path, packages: Path) -> None:
    """Packs a folder of packages and the metadata. Wheels of the same content have the same bytes."""
    content = {}
    for file in sorted(packages.rglob("*")):
        if file.is_file():
            content[file.relative_to(packages).as_posix()] = (
                file.read_bytes(),
                file.stat().st_mode & 0o111 != 0,
            )
    info = f"{stem()}.dist-info"
    content |= {f"{info}/{name}": (text.encode(), False) for name, text in metadata().items()}
    record = []
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, (data, runs) in content.items():
            write_member(archive, name, data, runs)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{name},sha256={digest},{len(data)}\n")
        record.append(f"{info}/RECORD,,\n")
        write_member(archive, f"{info}/RECORD", "".join(record).encode(), False)


def write_member(archive: zipfile.ZipFile, name: str, data: bytes, runs: bool) -> None:
    member = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
    member.compress_type = zipfile.ZIP_DEFLATED
    member.external_attr = (0o100755 if runs else 0o100644) << 16
    archive.writestr(member, data)


def sources() -> Iterator[Path]:
    """The files of a source distribution: those that git knows, or all of an unpacked one."""
    if (ROOT / ".git").exists():
        listed = subprocess.run(
            [
                "git",
                "-C",
                ROOT,
                "ls-files",
                "-z",
                "--cached",
                "--others",
                "--exclude-standard",
                "--",
                *SOURCES,
            ],
            check=True,
            capture_output=True,
            text=True,
        )
        found = {ROOT / name for name in listed.stdout.split("\0") if name}
    else:
        found = set()
        for name in SOURCES:
            found |= set((ROOT / name).rglob("*") if (ROOT / name).is_dir() else [ROOT / name])
    yield from sorted(path for path in found if path.is_file() and "__pycache__" not in path.parts)


def add(archive: tarfile.TarFile, name: str, data: bytes, runs: bool) -> None:
    member = tarfile.TarInfo(name)
    member.size, member.mtime, member.mode = len(data), OLDEST, 0o755 if runs else 0o644
    archive.addfile(member, io.BytesIO(data))
