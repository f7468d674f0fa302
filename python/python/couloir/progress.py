"""Progress on one line that is written over, in a terminal or a notebook."""

from __future__ import annotations

import sys


class Line:
    """Tells on the standard error stream how far the work has come."""

    def __init__(self) -> None:
        self._width = 0

    def __call__(self, what: str, steps: int | None, done: int) -> None:
        share = "..." if not steps else f"{100 * min(done, steps) // steps} %"
        self._write(f"{what} {share}")

    def end(self) -> None:
        """Clears the line."""
        if self._width:
            self._write("")
            sys.stderr.write("\r")
            sys.stderr.flush()

    def _write(self, text: str) -> None:
        sys.stderr.write("\r" + text.ljust(self._width))
        sys.stderr.flush()
        self._width = len(text)
