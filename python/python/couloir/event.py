"""An event of arrays, as an event folder has it of files."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from couloir._couloir import InputError

Column = Iterable[float]

QUANTITIES = ("velocity", "position", "acceleration")


@dataclass(frozen=True)
class Event:
    """Where a mass slid, what was recorded, and the model to fit.

    All quantities are SI. Laws, noises, priors and mechanisms are written as
    in an `event.toml`; `couloir new FOLDER` writes one that lists them all.

        >>> event = Event(
        ...     track=([0, 500], [300, 0]),
        ...     times=[2, 4, 6, 8], velocity=[6.6, 11.1, 15.9, 17.8],
        ...     friction="coulomb", priors={"mu": "Gamma(9, 0.03)"},
        ... )
        >>> sorted(event.files())
        ['event.toml', 'recording.csv', 'track.csv']
    """

    track: tuple[Column, Column]
    """Horizontal distances and elevations [m]."""
    times: Column
    """When the values were recorded, since the release [s]."""
    velocity: Column | None = None
    """Recorded speeds [m/s]; or `position`, or `acceleration`."""
    position: Column | None = None
    """Recorded distances along the slope [m]."""
    acceleration: Column | None = None
    """Recorded accelerations [m/s2]."""
    sigma: Column | None = None
    """The standard error of each value, in its unit."""
    window: float = 0.0
    """A value is the mean over so many last seconds [s]."""
    name: str = "event"
    """For titles; say "synthetic" where it is."""
    release: float | None = None
    """Where the mass starts [m]; the track's first point if left out."""
    release_velocity: float = 0.0
    """How fast it starts [m/s]."""
    depth: float | tuple[Column, Column] | None = None
    """Flow depth [m], or horizontal distances [m] and depths there."""
    friction: str = "voellmy"
    noise: str = "iid"
    priors: Mapping[str, str] = field(default_factory=dict)
    """Priors by parameter: `{"mu": "Gamma(9, 0.03)"}`."""
    mechanisms: Sequence[str] = ()
    """What a diagnosis has added, by their labels."""

    def files(self) -> dict[str, str]:
        """The files of its event folder, by their names."""
        quantity, values = self._recorded()
        columns = {"t": self.times, quantity: values}
        if self.sigma is not None:
            columns["sigma"] = self.sigma
        x, z = self.track
        files = {
            "event.toml": self._toml(quantity),
            "track.csv": _csv({"x": x, "z": z}),
            "recording.csv": _csv(columns),
        }
        if isinstance(self.depth, tuple):
            x, depth = self.depth
            files["depth.csv"] = _csv({"x": x, "depth": depth})
        return files

    def save(self, folder: str | Path) -> None:
        """Writes an event folder, which the command takes too.

        A file that is there already is not replaced: `FileExistsError`.
        """
        folder = Path(folder)
        files = self.files()
        for name in files:
            if (folder / name).exists():
                raise FileExistsError(f"{folder / name} is there already")
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")

    def _recorded(self) -> tuple[str, Column]:
        every = [(name, getattr(self, name)) for name in QUANTITIES]
        given = [pair for pair in every if pair[1] is not None]
        if len(given) != 1:
            names = ", ".join(name for name, _ in given) or "none"
            raise InputError(
                f"{self.name}: found {names} of velocity, position and "
                "acceleration; expected one of them"
            )
        return given[0]

    def _toml(self, quantity: str) -> str:
        depth = '"depth.csv"' if isinstance(self.depth, tuple) else self.depth
        tables: dict[str, dict[str, str | float | None]] = {
            "track": {"file": _text("track.csv")},
            "release": {"x": self.release, "velocity": self.release_velocity},
            "flow": {"depth": depth},
            "recording": {
                "file": _text("recording.csv"),
                "quantity": _text(quantity),
                "window": self.window,
            },
            "model": {
                "friction": _text(self.friction),
                "noise": _text(self.noise),
                "mechanisms": _list(self.mechanisms),
            },
            "priors": {
                _text(name): _text(prior)
                for name, prior in self.priors.items()
            },
        }
        text = f"name = {_text(self.name)}\n"
        for name, table in tables.items():
            entries = {k: v for k, v in table.items() if v is not None}
            if entries:
                text += f"\n[{name}]\n"
            for key, value in entries.items():
                text += f"{key} = {_value(value)}\n"
        return text


def _text(text: str) -> str:
    """A text as TOML has it, of which JSON's is one form."""
    return json.dumps(text)


def _list(texts: Sequence[str]) -> str | None:
    return f"[{', '.join(map(_text, texts))}]" if texts else None


def _value(value: str | float) -> str:
    return value if isinstance(value, str) else repr(float(value))


def _csv(columns: Mapping[str, Column]) -> str:
    """Columns of numbers, which read back to the same bits."""
    table = {
        name: [repr(float(x)) for x in column]
        for name, column in columns.items()
    }
    lengths = {name: len(column) for name, column in table.items()}
    if len(set(lengths.values())) > 1:
        raise InputError(
            f"found columns of different lengths {lengths}; expected as many "
            "numbers in each"
        )
    rows = [",".join(row) for row in zip(*table.values())]
    return "\n".join([",".join(table), *rows]) + "\n"
