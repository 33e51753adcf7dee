# SPDX-License-Identifier: BSD-2-Clause
"""The type of arrays in annotations; docstrings state shapes and units."""
from typing import Any

from numpy.typing import NDArray

Array = NDArray[Any]
