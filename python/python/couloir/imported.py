"""An event folder from a log."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike

from couloir import _couloir
from couloir.column import wrong
from couloir.result import Figure
from couloir.work import work

Place = str | PathLike[str]


@dataclass(frozen=True)
class Imported:
    """An event from a log: `save` it, and calibrate the folder."""

    told: str
    """What was done, and what there is to doubt."""
    files: dict[str, bytes] = field(repr=False)
    """The files of the event folder, by their names."""
    made: _couloir.Made = field(repr=False, compare=False)

    def save(self, folder: Place) -> None:
        """Writes the event folder, as the command does with `--out`."""
        self.made.write(folder)

    def figures(self) -> list[Figure]:
        """What was taken of the log and what was cut, as SVG."""
        return [Figure("import", self.files["import.svg"].decode())]


def import_log(
    log: Place,
    *,
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
    """Makes an event of a GNSS log, a terrain model and a path, as
    `couloir import` does; `start` and `end` are its `--from` and `--to`.

    Raises `InputError` for what has to be mended.
    """
    options = {
        "columns": columns, "terrain": terrain, "path": path, "crs": crs,
        "smooth": smooth, "threshold": threshold, "margin": margin,
        "from": start, "to": end, "name": name,
    }  # fmt: skip
    if not isinstance(log, (str, bytes, PathLike)):
        raise wrong("log", log, "the path of a log")
    made = work("import", options, [log])
    files = made.files()
    return Imported(files["import.txt"].decode(), files, made)
