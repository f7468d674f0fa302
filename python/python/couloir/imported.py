"""Event folders from logs, a front, or a simulation by AvaFrame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from os import PathLike

from couloir import _couloir
from couloir.column import wrong
from couloir.result import Figure
from couloir.work import work

Place = str | PathLike[str]


@dataclass(frozen=True)
class Imported:
    """An event from a log, or one from each of several recordings: `save` it,
    and calibrate the folder."""

    told: str
    """What was done, and what there is to doubt."""
    files: dict[str, bytes] = field(repr=False)
    """The files of the event folder, by their names; each event's behind the
    name of its recording where there are several."""
    made: _couloir.Made = field(repr=False, compare=False)

    def save(self, folder: Place) -> None:
        """Writes the event folder, or one for each recording, as the command
        does with `--out`."""
        self.made.write(folder)

    def figures(self) -> list[Figure]:
        """What was taken of the log and what was cut, as SVG."""
        return [
            Figure(name.removesuffix(".svg"), text.decode())
            for name, text in self.files.items()
            if name.endswith("import.svg")
        ]


def import_log(
    *logs: Place,
    front: Place | None = None,
    avaframe: Place | None = None,
    simulation: str | None = None,
    particles: Sequence[str | int] = (),
    columns: str | None = None,
    terrain: Place | None = None,
    path: Place | None = None,
    crs: str | None = None,
    smooth: float | None = None,
    threshold: float | None = None,
    margin: float | None = None,
    start: float | str | None = None,
    end: float | str | None = None,
    name: str | None = None,
) -> Imported:
    """Makes an event of a GNSS log, a terrain model and a path, or one of each
    of several recordings, as `couloir import` does; `start` and `end` are its
    `--from` and `--to`, `particles` its `--particle`: of a project of AvaFrame
    `"mean"`, `"front"`, or a particle's number.

    Raises `InputError` for what has to be mended.
    """
    options = {
        "front": front, "avaframe": avaframe, "simulation": simulation,
        "particle": ",".join(map(str, particles)) if particles else None,
        "columns": columns, "terrain": terrain, "path": path, "crs": crs,
        "smooth": smooth, "threshold": threshold, "margin": margin,
        "from": start, "to": end, "name": name,
    }  # fmt: skip
    for log in logs:
        if not isinstance(log, (str, bytes, PathLike)):
            raise wrong("log", log, "the path of a log")
    if isinstance(particles, (str, int)):
        raise wrong("particles", particles, 'a list such as ["mean", 17]')
    made = work("import", options, logs)
    files = made.files()
    told = "\n".join(
        (name.removesuffix("import.txt") + "\n").lstrip("\n") + text.decode()
        for name, text in files.items()
        if name.endswith("import.txt")
    )
    return Imported(told, files, made)
