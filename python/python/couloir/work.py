"""From Python's arguments to the command's words, and to what it makes."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping, Sequence
from os import PathLike, fsdecode
from pathlib import Path

from couloir import _couloir
from couloir.column import wrong
from couloir.event import Event
from couloir.progress import Line

Subject = str | bytes | PathLike[str] | PathLike[bytes] | Event


def work(
    command: str,
    options: Mapping[str, object],
    subjects: Sequence[Subject],
    quiet: bool = True,
) -> _couloir.Made:
    """What the command makes of events with these options."""
    line = None if quiet else Line()
    with tempfile.TemporaryDirectory(prefix="couloir-") as folder:
        paths = [
            _path(one, Path(folder) / f"event-{i}")
            for i, one in enumerate(subjects)
        ]
        words = [command, *words_of(options), "--", *paths]
        try:
            return _couloir.made(words, line)
        except _couloir.InputError as error:
            told = _named(str(error), subjects, paths)
            raise _couloir.InputError(told) from None
        finally:
            if line is not None:
                line.end()


def _path(subject: Subject, folder: Path) -> str:
    """Where an event is, which one of arrays is written for."""
    if isinstance(subject, Event):
        subject.save(folder)
        return str(folder)
    try:
        return fsdecode(subject)
    except TypeError:
        raise wrong("event", subject, "an event folder or an Event") from None


def _named(
    told: str, subjects: Sequence[Subject], paths: Sequence[str]
) -> str:
    """A message with an event's name for the folder that held its arrays."""
    for subject, path in zip(subjects, paths):
        if isinstance(subject, Event):
            name = subject.name
            name = name if name.isprintable() else repr(name)
            told = told.replace(path + os.sep, f"{name}: ")
    return told


def words_of(options: Mapping[str, object]) -> list[str]:
    """Options as the command has them: `check_rate=True` is `--check-rate`,
    and a mapping is as many words as it has entries.
    """
    words = []
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        if isinstance(value, Mapping):
            words += [f"{option}={k}={v}" for k, v in value.items()]
        elif value is True:
            words.append(option)
        elif value is not None and value is not False:
            words.append(f"{option}={value}")
    return words
