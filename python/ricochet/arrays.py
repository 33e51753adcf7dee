# SPDX-License-Identifier: BSD-2-Clause
"""Types of arrays for annotations. Docstrings state shapes and units."""
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Floats = NDArray[np.float64]
