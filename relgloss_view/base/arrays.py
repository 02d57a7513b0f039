"""Array types, named once. A docstring or a comment adds each array's shape and unit."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Floats = NDArray[np.floating[Any]]  #: float64 of a twin, or float32 of the device
Mask = NDArray[np.bool_]
Ints = NDArray[np.int64]
UInts = NDArray[np.uint32]  #: 32 bits, as GLSL's uint
Bytes = NDArray[np.uint8]  #: digital values of 8 bits, or bytes of a file
Digital = NDArray[np.uint8] | NDArray[np.uint16]  #: digital values of 8 or 16 bits
AnyArray = NDArray[Any]  #: whatever type a file or a device gives
#: Red, green and blue of one colour.
Rgb = tuple[float, float, float]
