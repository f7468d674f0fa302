"""The command `couloir`, as the package carries it."""

import signal
import sys

from couloir import _couloir


def main() -> int:
    """Runs the command with the words of the command line."""
    # The command knows nothing of Python's signals: Ctrl-C ends it.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _couloir.command(sys.argv[1:])
