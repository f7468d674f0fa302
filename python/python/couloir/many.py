"""Many events, each of them once: here, or on the workers of Dask."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from couloir import _couloir
from couloir.column import wrong
from couloir.work import words_of

Place = str | os.PathLike[str]


class Client(Protocol):
    """What is asked of a `dask.distributed.Client`."""

    def map(self, func: Any, *iterables: Any, pure: bool) -> Any: ...
    def gather(self, futures: Any) -> Any: ...


@dataclass(frozen=True)
class Sweep:
    """What came of many events."""

    folder: Path
    """Where `sweep.json`, `sweep.csv` and the results are."""
    events: int
    done: int
    failed: int
    mechanisms: list[dict[str, Any]]
    """How often each was selected, and its mean probability."""
    models: list[dict[str, Any]]
    """The same of the models of comparisons."""
    failures: list[dict[str, Any]]
    """Messages, with the events that failed by each."""
    rows: list[dict[str, Any]] = field(repr=False)
    """Each event, with its result or why there is none."""
    document: dict[str, Any] = field(repr=False, compare=False)
    """`sweep.json`."""


def sweep(
    events: Place | Sequence[Place],
    out: Place,
    *,
    verb: str = "diagnose",
    client: Client | None = None,
    shards: int | None = None,
    jobs: int | None = None,
    retry: bool = False,
    **options: object,
) -> Sweep:
    """Does `verb` ("diagnose", "calibrate" or "compare") with each event, as
    `couloir sweep` does; `options` are the verb's own.

    `events` is a list of event folders, or what the command takes: a folder
    of them, a pattern, a CSV file. With a `client` of Dask the events are
    shared out as so many `shards`, where not given 10 events or more in each
    and 100 shards at most, and the workers must see the same folders.
    """
    folder = Path(out).absolute()
    listed = _listed(events, folder)
    begin = [f"--out={folder}", f"--verb={verb}", "--quiet"]
    begin += ["--retry"] if retry else []
    behind = [listed, "--", *words_of(options)]
    if client is not None:
        number = shards if shards is not None else _shards(listed)
        parts = [
            [*begin, "--jobs=1", f"--shard={i}/{number}", *behind]
            for i in range(1, number + 1)
        ]
        # Not pure: what is done on the disk is no value to be kept.
        client.gather(client.map(_run, parts, pure=False))
        # What failed there has just been tried.
        begin = [word for word in begin if word != "--retry"]
    _run([*begin, *([f"--jobs={jobs}"] if jobs else []), *behind])
    document = json.loads((folder / "sweep.json").read_text())
    known = {k: document[k] for k in ("events", "done", "failed")}
    lists = {k: document[k] for k in ("mechanisms", "failures", "rows")}
    lists["models"] = document.get("models", [])
    return Sweep(folder=folder, document=document, **known, **lists)


def _shards(listed: str) -> int:
    """As many as there can be of 10 events or more, but not above 100: each
    is a process, whose start takes as long as a quick calibration."""
    return max(1, min(100, _couloir.events_of(listed) // 10))


def _listed(events: Place | Sequence[Place], folder: Path) -> str:
    """The list as the command takes it."""
    if isinstance(events, (str, os.PathLike)):
        return os.path.abspath(os.fspath(events))
    if isinstance(events, (bytes, Mapping)):
        raise wrong("events", events, "a path, or a list of event folders")
    paths = [os.path.abspath(os.fspath(event)) for event in events]
    if not paths:
        raise wrong("events", paths, "at least one event folder")
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "events.csv"
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([["event"], *([p] for p in paths)])
    return str(path)


PROGRAM = "from couloir._command import main; raise SystemExit(main())"


def _run(words: list[str]) -> None:
    """Runs the command, as this Python has it, in a process of its own: it
    may be killed with its worker, and harm nothing."""
    command = [sys.executable, "-c", PROGRAM, "sweep", *words]
    done = subprocess.run(command, capture_output=True, text=True)
    told = done.stderr.strip().removeprefix("couloir: ")
    # 3: events failed, which the summary tells.
    if done.returncode in (0, 3):
        return
    raise (_couloir.InputError if done.returncode == 2 else OSError)(told)
