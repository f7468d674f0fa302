"""What a model lacks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

from couloir.column import wrong
from couloir.event import Event
from couloir.parameter import Parameter, of, parameters
from couloir.result import Result, opened
from couloir.work import Subject, work


@dataclass(frozen=True)
class Mismatch:
    """A stretch in which simulation and recording differ."""

    coordinate: str
    """Along what it is given: "arclength" [m] or "time" [s]."""
    start: float
    end: float
    specific_force: float
    """The mean force there [m/s2]; below 0 it brakes."""
    specific_force_q05: float
    specific_force_q95: float
    delta_mu: float
    """The change of mu that would have the same effect."""
    probability: float
    """The posterior mass of a force of that sign."""


@dataclass(frozen=True)
class Mechanism:
    """A mechanism as the evidence judges it."""

    name: str
    kind: str
    probability: float
    log10_bayes_factor: float
    """Against the model as it was."""
    says: str = field(repr=False)
    parameters: dict[str, Parameter] = field(repr=False)


@dataclass(frozen=True)
class Noise:
    """A noise as the evidence judges it."""

    name: str
    probability: float
    log10_bayes_factor: float
    parameters: dict[str, Parameter] = field(repr=False)


@dataclass(frozen=True)
class Improvement:
    """What adding the selected mechanisms brings."""

    log10_bayes_factor: float | None
    rmse_before: float | None
    rmse_after: float | None
    elpd_before: float | None
    elpd_after: float | None
    heldout_rmse_before: float | None
    heldout_rmse_after: float | None
    coverage90_before: float | None
    coverage90_after: float | None


@dataclass(frozen=True)
class Rival:
    """Other terms that do nearly as well as those selected."""

    names: list[str]
    log10_bayes_factor: float


@dataclass(frozen=True)
class Withheld:
    """What the evidence asks for, and makes the fit worse."""

    names: list[str]
    noise: str
    rmse_before: float
    rmse_after: float


@dataclass(frozen=True)
class Diagnosis(Result):
    """What a model lacks, and what adding it brings."""

    event: str
    seed: int
    verdict: str
    """"adequate", "missing-physics", "measurement", "noise", "unexplained"."""
    weak: bool
    quick: bool
    selected: list[str]
    """What is added to the model."""
    selected_noise: str
    withheld: Withheld | None
    """What is not added, since the fit would be worse with it."""
    group: list[str]
    """What the recording cannot tell apart."""
    rivals: list[Rival] = field(repr=False)
    mismatch: list[Mismatch] = field(repr=False)
    mechanisms: list[Mechanism] = field(repr=False)
    """Everything that was weighed, most probable first."""
    noise: list[Noise] = field(repr=False)
    improvement: Improvement = field(repr=False)
    parameters: dict[str, Parameter] = field(repr=False)
    """Those of the corrected model, the mechanisms' first."""
    words: list[str] = field(repr=False)
    """All of it in sentences."""
    notes: list[str] = field(repr=False)
    warnings: list[str]
    doubts: list[str] = field(repr=False)
    """Those of the warnings for which it should not be used."""

    def __str__(self) -> str:
        return "\n".join(self.words)


def diagnose(
    events: Subject | Sequence[Subject] | None = None,
    *,
    friction: str | None = None,
    noise: str | None = None,
    odds: Mapping[str, float] | None = None,
    one_law: bool = False,
    pooled: bool = False,
    rate: float | None = None,
    thin: str | None = None,
    check_rate: bool = False,
    seed: int | None = None,
    quick: bool = False,
    quiet: bool = False,
) -> Diagnosis:
    """Finds where recording and model differ and what was left out, as
    `couloir diagnose` does.

    `events` is an event folder or an `Event`, or several to be explained
    together; a passenger car coasting uphill, a real recording, where none is
    given. What is left out is as in the command.

    Raises `InputError` for what has to be mended, `RuntimeError` for an
    inference that failed.
    """
    options = dict(
        friction=friction, noise=noise, odds=odds, one_law=one_law,
        pooled=pooled, rate=rate, thin=thin, check_rate=check_rate, seed=seed,
        quick=quick,
    )  # fmt: skip
    made = opened(work("diagnose", options, _subjects(events), quiet),
                  "diagnosis.json")  # fmt: skip
    known = made["document"]
    return of(
        Diagnosis,
        known,
        mismatch=[
            of(Mismatch, one, start=one["from"], end=one["to"])
            for one in known["mismatch"]
        ],
        mechanisms=[_judged(Mechanism, one) for one in known["mechanisms"]],
        noise=[_judged(Noise, one) for one in known["noise"]],
        withheld=known["withheld"] and of(Withheld, known["withheld"]),
        rivals=[of(Rival, one) for one in known["rivals"]],
        improvement=of(Improvement, known["improvement"]),
        parameters=parameters(known["parameters"]),
        **made,
    )


def _subjects(
    events: Subject | Sequence[Subject] | None,
) -> list[Subject]:
    """One event or several as a list; nothing for the built-in one."""
    if events is None:
        return []
    if isinstance(events, (str, bytes, PathLike, Event)):
        return [events]
    if not isinstance(events, Sequence) or not events:
        raise wrong("events", events, "an event, or several in a list")
    every: Sequence[Any] = events
    return list(every)


def _judged(kind: Any, one: Mapping[str, Any]) -> Any:
    return of(kind, one, parameters=parameters(one["parameters"]))
