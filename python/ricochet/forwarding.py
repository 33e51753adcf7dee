# SPDX-License-Identifier: BSD-2-Clause
"""Properties of Python classes that return values of an object of the extension module, `self._core`."""
import operator
from typing import Any


def of_core(name: str, doc: str) -> Any:
    """A read-only property that returns `self._core.name`."""
    return property(operator.attrgetter(f"_core.{name}"), doc=doc)
