# SPDX-License-Identifier: Apache-2.0
"""Checks of arrays and numbers, whose messages name what is wrong."""
from __future__ import annotations

import dataclasses
import difflib
import operator
import os
import sys
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Optional

import numpy
from numpy.typing import ArrayLike, NDArray

from ._errors import InputError


def array_of(values: ArrayLike, name: str, shape: Sequence[Optional[int]], kind: type = float) -> NDArray[Any]:
    """The values as an array of that shape (None: any length), of finite floats or of whole numbers."""
    try:
        array = numpy.asarray(values)
    except ValueError as error:
        raise InputError(f"{name}: expected an array, found rows of different lengths") from error
    wanted = " x ".join("n" if length is None else str(length) for length in shape)
    if array.ndim != len(shape) or any(length not in (None, found) for length, found in zip(shape, array.shape)):
        raise InputError(f"{name}: expected {wanted} values, found {' x '.join(map(str, array.shape)) or 'one number'}")
    if array.dtype.kind not in "iufb":
        raise InputError(f"{name}: expected numbers, found {'text' if array.dtype.kind in 'US' else array.dtype}")
    if kind is float:
        array = array.astype(numpy.float64)
        if not numpy.isfinite(array).all():
            place = tuple(int(index) for index in numpy.argwhere(~numpy.isfinite(array))[0])
            raise InputError(f"{name}[{', '.join(map(str, place))}]: expected a finite number, found {array[place]}")
        return array
    if array.dtype.kind == "f":
        wrong = numpy.argwhere(~(numpy.isfinite(array) & (array == numpy.floor(array))))
        if len(wrong) > 0:
            place = tuple(int(index) for index in wrong[0])
            raise InputError(f"{name}[{', '.join(map(str, place))}]: expected a whole number, found {array[place]}")
        array = array.astype(numpy.int64)
    return array


def whole_array_of(values: ArrayLike, name: str, shape: Sequence[Optional[int]], most: int) -> NDArray[Any]:
    """The same, of whole numbers from 0 to `most`."""
    array = array_of(values, name, shape, int)
    wrong = numpy.argwhere((array < 0) | (array > most))
    if len(wrong) > 0:
        place = tuple(int(index) for index in wrong[0])
        raise InputError(f"{name}[{', '.join(map(str, place))}]: expected 0 to {most}, found {array[place]}")
    return array


def three(values: ArrayLike, name: str) -> tuple[float, float, float]:
    """A point or a direction."""
    array = array_of(values, name, (3,))
    return (float(array[0]), float(array[1]), float(array[2]))


def number(value: Any, name: str) -> float:
    """A finite number."""
    if isinstance(value, (bool, numpy.bool_)):
        raise InputError(f"{name}: expected a number, found {value}")
    return float(array_of([value], name, (1,))[0])


def whole(value: Any, name: str, least: int, most: int) -> int:
    """A whole number in a range."""
    try:
        found = operator.index(value)
    except TypeError as error:
        raise InputError(f"{name}: expected a whole number, found {value!r}") from error
    if not least <= found <= most:
        raise InputError(f"{name}: expected {least} to {most}, found {found}")
    return found


def suggestion(name: str, known: Sequence[str]) -> str:
    """Spelling suggestions for a name, for messages."""
    near = difflib.get_close_matches(name, known, n=3)
    return f"did you mean {' or '.join(near)}?" if near else f"known are {', '.join(known)}"


def made_from(kind: type, values: Any, name: str) -> Any:
    """A dataclass from one of its own or from a mapping of its fields."""
    if isinstance(values, kind):
        return values
    if not isinstance(values, Mapping):
        raise InputError(f"{name}: expected a {kind.__name__} or a dict of its fields, found {values!r}")
    fields = {field.name: field for field in dataclasses.fields(kind)}
    for key in values:
        if key not in fields:
            raise InputError(f"{name}: no field '{key}'; {suggestion(str(key), list(fields))}")
    for key, field in fields.items():
        if (key not in values and field.default is dataclasses.MISSING
                and field.default_factory is dataclasses.MISSING):
            raise InputError(f"{name}: expected the field '{key}', found none")
    return kind(**values)


def warn(text: str) -> None:
    """A RuntimeWarning at the line of the user who called into this package."""
    level = 2
    frame = sys._getframe(1)
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == os.path.dirname(__file__):
        frame = frame.f_back
        level += 1
    warnings.warn(text, RuntimeWarning, stacklevel=level)
