"""Numbers and texts as a user hands them over, made sure of.

What is no finite number is refused here, where its place in the column is
still known.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from couloir._couloir import InputError

Column = Iterable[float]


def number(place: str, value: Any) -> float:
    """A finite number: Python's or numpy's, whole or not."""
    try:
        found = math.nan if isinstance(value, (str, bytes)) else float(value)
    except (TypeError, ValueError, OverflowError):
        found = math.nan
    if not math.isfinite(found):
        raise wrong(place, value, "a finite number")
    return found


def text(place: str, value: Any) -> str:
    """A text."""
    if not isinstance(value, str):
        raise wrong(place, value, "a text")
    return value


def numbers(place: str, column: Any) -> list[float]:
    """A list, an array, a column of a data frame: whatever yields numbers."""
    try:
        values = None if isinstance(column, (str, bytes)) else iter(column)
    except TypeError:
        values = None
    if values is None:
        raise wrong(place, column, "a column of numbers")
    return [number(f"{place}[{i}]", value) for i, value in enumerate(values)]


def pair(
    place: str, columns: Any, names: tuple[str, str]
) -> dict[str, list[float]]:
    """Two columns by their names."""
    try:
        both = zip(names, columns, strict=True)
        every = {name: (f"{place} {name}", one) for name, one in both}
    except (TypeError, ValueError):
        said = f"two columns of numbers, {names[0]} and {names[1]}"
        raise wrong(place, columns, said) from None
    return {name: numbers(*one) for name, one in every.items()}


def csv(place: str, columns: Mapping[str, list[float]]) -> str:
    """Columns of numbers, which read back to the same bits."""
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise InputError(
            f"{place}: found columns of different lengths {lengths}; expected "
            "as many numbers in each"
        )
    rows = [",".join(map(repr, row)) for row in zip(*columns.values())]
    return "\n".join([",".join(columns), *rows]) + "\n"


def wrong(place: str, found: Any, expected: str) -> InputError:
    """The message of every refusal: the place, what was found, what not."""
    shown = repr(found)
    if len(shown) > 60:
        shown = f"{shown[:40]} ... ({type(found).__name__})"
    return InputError(f"{place} is {shown}; expected {expected}")
