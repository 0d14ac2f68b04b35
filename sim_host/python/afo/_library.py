"""The shared library and its declarations, which are library.h's own; its words become AfoError."""
from __future__ import annotations

import pathlib
import re
from typing import Any

import cffi
import numpy as np
from numpy.typing import ArrayLike, NDArray

HERE = pathlib.Path(__file__).resolve().parent
SYSTEM = HERE / "system"
"""Where the program afo, the persons, devices and the view lie, as `make install` lays them out."""


class AfoError(ValueError):
    """What was asked for cannot be done. The text says what was found, what is allowed, and what to do."""


def _declarations() -> str:
    """library.h without the preprocessor's lines, but for numbers: what cffi reads."""
    lines = (HERE / "library.h").read_text(encoding="utf-8").splitlines()
    return "\n".join(line for line in lines if not line.startswith("#") or re.match(r"#define \w+ -?\d+( |$)", line))


ffi = cffi.FFI()
ffi.cdef(_declarations())
try:
    lib: Any = ffi.dlopen(str(HERE / "libafo.so"))
except OSError as error:
    raise ImportError(f"{error}; build it anew: pip install sim_host/python, or make python, in a clone of afo") from None

TEXT_BYTES = 1024


def text_buffer() -> Any:
    return ffi.new("char[]", TEXT_BYTES)


def words(text: Any) -> str:
    """A reason of the C side's; options are spelled as Python's arguments are."""
    said = ffi.string(text).decode("utf-8", "replace")
    return re.sub(r"--([a-z][a-z0-9-]*)", lambda match: match[1].replace("-", "_"), said)


def complain(text: Any) -> AfoError:
    return AfoError(words(text))


def number(value: Any, name: str, unit: str, low: float = -np.inf) -> float:
    """value as a finite float not below low, or AfoError."""
    try:
        found = float(value)
    except (TypeError, ValueError):
        raise AfoError(f"{name} must be a number in {unit}, not {value!r}") from None
    if not np.isfinite(found) or found < low:
        limit = "" if low == -np.inf else f" from {low:g} on"
        raise AfoError(f"{name} = {found} {unit}: it must be a finite number{limit}")
    return found


def whole(value: Any, name: str, low: int, high: int) -> int:
    """value as an int from low to high, or AfoError."""
    try:
        found = int(value)
    except (TypeError, ValueError, OverflowError):
        found = low - 1
    if not low <= found <= high or found != value:
        raise AfoError(f"{name} must be a whole number from {low} to {high}, not {value!r}")
    return found


def choice(value: Any, name: str, names: tuple[str, ...]) -> int:
    """The place of value among names, or AfoError."""
    if value not in names:
        raise AfoError(f"{name} = {value!r} is none of {', '.join(names)}")
    return names.index(value)


def numbers(value: ArrayLike, name: str) -> NDArray[np.float64]:
    """value as an array of doubles, or AfoError; no copy where it is one."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise AfoError(f"{name} must be numbers, not {value!r:.60}: {error}") from None


def states(value: ArrayLike, name: str = "x") -> NDArray[np.float64]:
    """value as apexes, (..., 3), or AfoError."""
    found = numbers(value, name)
    if found.ndim == 0 or found.shape[-1] != 3:
        raise AfoError(f"{name} has the shape {found.shape}; it must be (..., 3): stance rate rad/s, swing angle rad, "
                       "swing rate rad/s of each walker")
    return found


def doubles(array: NDArray[np.float64] | None) -> Any:
    """A pointer to a contiguous array of doubles, NULL for None."""
    return ffi.NULL if array is None else ffi.cast("double *", ffi.from_buffer(array))


version: str = ffi.string(lib.afo_version()).decode()
