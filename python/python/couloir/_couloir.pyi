"""What the compiled part offers."""

from collections.abc import Callable
from os import PathLike
from typing import Any

class InputError(ValueError):
    """An input that has to be mended: a file, a name, a value."""

class Made:
    """What a command made."""

    def files(self) -> dict[str, bytes]: ...
    def write(self, folder: str | PathLike[str]) -> None: ...
    def groups(self) -> dict[str, Any]: ...

def made(
    words: list[str],
    tell: Callable[[str, int | None, int], None] | None = None,
) -> Made: ...
def events_of(list: str) -> int: ...
def command(words: list[str]) -> int: ...
