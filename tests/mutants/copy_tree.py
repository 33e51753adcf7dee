# SPDX-License-Identifier: BSD-2-Clause
"""The copy of the tree in which mutants are built."""
import hashlib
import subprocess


def listed(root):
    """The files of a checkout that git does not ignore."""
    command = ["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return sorted({name for name in names.split("\0") if name and (root / name).is_file()})


def synchronise(root, tree):
    """Makes `tree` equal to the checkout. Files that are equal keep their time, so that they are not compiled
    again. A mutant of a killed run is thus replaced."""
    names = listed(root)
    kept = {tree / name for name in names}
    for path in sorted(tree.rglob("*"), reverse=True):
        if path.is_file() and path not in kept:
            path.unlink()
        elif path.is_dir() and not any(path.iterdir()):
            path.rmdir()
    for name in names:
        source, target = root / name, tree / name
        content = source.read_bytes()
        if target.is_file() and target.read_bytes() == content:
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
        target.chmod(source.stat().st_mode)


def fingerprint(root, folders=("",)):
    """A hash of the names and contents of the files in some folders of a checkout."""
    digest = hashlib.sha256()
    for name in listed(root):
        if name.startswith(tuple(folders)):
            digest.update(f"{name}\0".encode() + hashlib.sha256((root / name).read_bytes()).digest())
    return digest.hexdigest()
