# SPDX-License-Identifier: BSD-2-Clause
"""Whether this Python can run the package. Runs on any Python 3, because it complains about those that are too old."""
import importlib.machinery
import importlib.util
import sys
from pathlib import Path

NEEDED = ("numpy", "h5py", "matplotlib")


def complaint(folders):  # type: ignore[no-untyped-def]  # annotations of lists need Python 3.9
    """What is wrong with this Python, in one line; empty if nothing is.

    @param folders  folders of the package, some of which may contain the extension module
    """
    this = "%s is Python %d.%d" % (sys.executable, *sys.version_info[:2])
    right = "use /usr/bin/python3, or the command ricochet, which finds it itself"
    built = [path.name for folder in folders for path in Path(folder).glob("_core.*.so")]
    own = ["_core" + suffix for suffix in importlib.machinery.EXTENSION_SUFFIXES]
    if built and not set(built) & set(own):
        return "%s, and the package is built for another one (%s): %s" % (this, built[0], right)
    if sys.version_info < (3, 11):
        return "%s, and the package needs 3.11: %s" % (this, right)
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    return "%s without %s: %s" % (this, ", ".join(missing), right) if missing else ""
