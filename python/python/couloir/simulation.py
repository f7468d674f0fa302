"""The motion with given parameter values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from couloir.parameter import of
from couloir.result import Result, opened
from couloir.work import Subject, work


@dataclass(frozen=True)
class Simulation(Result):
    """The motion at t = 0 and at the recording's times."""

    event: str
    parameters: dict[str, float]
    t: list[float] = field(repr=False)
    """[s]"""
    velocity: list[float] = field(repr=False)
    """[m/s]"""
    distance: list[float] = field(repr=False)
    """Along the slope [m]."""
    acceleration: list[float] = field(repr=False)
    """[m/s2]"""
    rest: tuple[float, float] | None
    """When [s] and where [m] the mass comes to rest, if it does."""
    notes: list[str] = field(repr=False)
    warnings: list[str]


def simulate(
    event: Subject | None = None,
    values: Mapping[str, float] | None = None,
    *,
    friction: str | None = None,
    noise: str | None = None,
) -> Simulation:
    """Runs the motion with given values, as `couloir simulate` does.

    Parameters that `values` does not name stand at the middle of their
    priors. Raises `InputError` for what has to be mended.
    """
    options = dict(friction=friction, noise=noise, set=values)
    subjects = [] if event is None else [event]
    made = opened(work("simulate", options, subjects), "simulation.json")
    known = made["document"]
    rest = known["rest"] and (known["rest"]["t"], known["rest"]["distance"])
    return of(Simulation, known, rest=rest, **made)
