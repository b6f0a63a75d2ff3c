"""Checks arrays before they go to C++: dtype, shape and contiguity, with messages that name the argument."""

from __future__ import annotations

from typing import Any, Optional, Tuple

import numpy as np

from ._errors import InputError


def _fail(name: str, what: str) -> None:
    raise InputError(f"{name}: {what}", record=name)


def _describe(shape: Tuple[Optional[int], ...]) -> str:
    letters = iter("nmk")
    sizes = [str(size) if size is not None else next(letters) for size in shape]
    return "(" + ", ".join(sizes) + ("," if len(sizes) == 1 else "") + ")"


def _shaped(name: str, value: Any, shape: Tuple[Optional[int], ...]) -> np.ndarray:
    try:
        array = np.asarray(value)
    except ValueError as e:  # rows of different lengths
        raise InputError(f"{name}: expected an array of shape {_describe(shape)}: {e}", record=name) from None
    if array.ndim != len(shape) or any(want not in (None, size) for want, size in zip(shape, array.shape)):
        _fail(name, f"expected an array of shape {_describe(shape)}, found {array.shape}")
    return array


def floats(name: str, value: Any, shape: Tuple[Optional[int], ...], dtype: Any = np.float64) -> np.ndarray:
    """A contiguous array of finite numbers. A size of None is free."""
    array = _shaped(name, value, shape)
    if array.dtype.kind not in "fiu":
        _fail(name, f"expected numbers, found dtype {array.dtype}")
    array = np.ascontiguousarray(array, dtype=dtype)
    bad = ~np.isfinite(array)
    if bad.any():
        at = tuple(int(i) for i in np.argwhere(bad)[0])
        _fail(name, f"expected finite numbers, found {array[at]} at {at}")
    return array


def integers(name: str, value: Any, shape: Tuple[Optional[int], ...], dtype: Any, below: Optional[int] = None) -> np.ndarray:
    """A contiguous array of whole numbers, from 0 to below `below` where that is given."""
    array = _shaped(name, value, shape)
    if array.size == 0:
        return np.zeros(array.shape, dtype=dtype)
    if array.dtype.kind not in "iu":
        _fail(name, f"expected whole numbers, found dtype {array.dtype}")
    limits = np.iinfo(dtype)
    low, high = (limits.min, limits.max) if below is None else (0, below - 1)
    bad = (array < low) | (array > high)
    if bad.any():
        at = tuple(int(i) for i in np.argwhere(bad)[0])
        _fail(name, f"expected values from {low} to {high}, found {array[at]} at {at}")
    return np.ascontiguousarray(array, dtype=dtype)


def image(name: str, value: Any, order: str) -> np.ndarray:
    """A contiguous (h, w, 3) image in BGR, of 8 or 16 bit."""
    array = np.asarray(value)
    if array.dtype not in (np.uint8, np.uint16):
        _fail(name, f"expected dtype uint8 or uint16, found {array.dtype}")
    if array.ndim == 2:
        array = np.repeat(array[:, :, None], 3, axis=2)
    if array.ndim != 3 or array.shape[2] not in (3, 4) or 0 in array.shape:
        _fail(name, f"expected an array of shape (h, w, 3) or (h, w), found {array.shape}")
    if order not in ("rgb", "bgr"):
        _fail("order", f'expected "rgb" or "bgr", found {order!r}')
    array = array[:, :, :3]
    return np.ascontiguousarray(array[:, :, ::-1] if order == "rgb" else array)


def mask(name: str, value: Any, shape: Tuple[int, ...]) -> Optional[np.ndarray]:
    """One byte an item, 1 where it counts; None stays None."""
    if value is None:
        return None
    array = _shaped(name, value, shape)
    if array.dtype.kind not in "biu":
        _fail(name, f"expected flags (bool or whole numbers), found dtype {array.dtype}")
    return np.ascontiguousarray(array != 0).astype(np.uint8)


def positive(name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = float("nan")
    if not (0 < number < float("inf")):
        _fail(name, f"expected a positive number, found {value!r}")
    return number
