# SPDX-License-Identifier: BSD-2-Clause
"""Errors of the quantities of interest of a run."""

from collections.abc import Mapping
from typing import Any

from ricochet._core import relative_error

__all__ = ["errors", "relative_error"]


def errors(summary: Mapping[str, Any], reference: Mapping[str, Any]) -> dict[str, float]:
    """Relative error of each quantity of a summary, with the scales of the reference
    (docs/theory/accuracy.md)."""
    return {
        name: relative_error(summary["quantities"][name]["value"], of["value"], of["scale"])
        for name, of in reference["quantities"].items()
    }
