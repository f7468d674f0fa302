"""An event of arrays, as an event folder has it of files."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Real
from pathlib import Path
from types import NoneType

from couloir._couloir import InputError
from couloir.column import (
    Column,
    csv,
    number,
    numbers,
    pair,
    text,
    wrong,
)

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
        """The files of its event folder, by their names.

        Raises `InputError` for what is no number or no text, and for columns
        of different lengths.
        """
        quantity, values = self._recorded()
        columns = {
            "t": numbers("times", self.times),
            quantity: numbers(quantity, values),
        }
        if self.sigma is not None:
            columns["sigma"] = numbers("sigma", self.sigma)
        track = pair("track", self.track, ("x", "z"))
        files = {
            "event.toml": self._toml(quantity),
            "track.csv": csv("track", track),
            "recording.csv": csv("recording", columns),
        }
        if self._depth_varies():
            depths = pair("depth", self.depth, ("x", "depth"))
            files["depth.csv"] = csv("depth", depths)
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

    def _depth_varies(self) -> bool:
        return not isinstance(self.depth, (Real, str, NoneType))

    def _toml(self, quantity: str) -> str:
        depth = _text("depth", "depth.csv") if self._depth_varies() else (
            _number("depth", self.depth)
        )  # fmt: skip
        tables: dict[str, dict[str, str | None]] = {
            "track": {"file": _text("track", "track.csv")},
            "release": {
                "x": _number("release", self.release),
                "velocity": _number("release_velocity", self.release_velocity),
            },
            "flow": {"depth": depth},
            "recording": {
                "file": _text("recording", "recording.csv"),
                "quantity": _text("quantity", quantity),
                "window": _number("window", self.window),
            },
            "model": {
                "friction": _text("friction", self.friction),
                "noise": _text("noise", self.noise),
                "mechanisms": _list("mechanisms", self.mechanisms),
            },
            "priors": _priors(self.priors),
        }
        lines = [f"name = {_text('name', self.name)}"]
        for name, table in tables.items():
            known = {k: v for k, v in table.items() if v is not None}
            if known:
                lines += ["", f"[{name}]"]
                lines += [f"{key} = {value}" for key, value in known.items()]
        return "\n".join(lines) + "\n"


def _text(place: str, value: object) -> str:
    """A text as TOML has it: as in JSON, but for the character 127."""
    written = json.dumps(text(place, value), ensure_ascii=False)
    return written.replace("\x7f", "\\u007f")


def _number(place: str, value: object) -> str | None:
    return None if value is None else repr(number(place, value))


def _list(place: str, values: Sequence[str]) -> str | None:
    if isinstance(values, str) or not isinstance(values, Sequence):
        raise wrong(place, values, "a list of texts")
    every = [_text(f"{place}[{i}]", one) for i, one in enumerate(values)]
    return f"[{', '.join(every)}]" if every else None


def _priors(priors: Mapping[str, str]) -> dict[str, str | None]:
    if not isinstance(priors, Mapping):
        raise wrong("priors", priors, "priors by parameter")
    return {
        _text("a name in priors", name): _text(f"priors[{name!r}]", prior)
        for name, prior in priors.items()
    }
