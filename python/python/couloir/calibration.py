"""A friction law calibrated."""

from __future__ import annotations

from dataclasses import dataclass, field

from couloir.parameter import Parameter, of, parameters
from couloir.result import Result, opened
from couloir.work import Subject, work


@dataclass(frozen=True)
class Evidence:
    """ln p(recording | model), with its standard error."""

    value: float
    se: float
    method: str


@dataclass(frozen=True)
class Checks:
    """How the model stands to the recording; p-values where named so."""

    rmse: float | None
    """Of the posterior mean prediction, in the recording's unit."""
    coverage90: float | None
    """The share of values in the 90 % band."""
    ljung_box_p: float | None
    shapiro_wilk_p: float | None
    kolmogorov_smirnov_p: float | None


@dataclass(frozen=True)
class Calibration(Result):
    """A friction law calibrated."""

    event: str
    friction: str
    noise: str
    backend: str
    seed: int
    parameters: dict[str, Parameter]
    log_evidence: Evidence | None
    checks: Checks
    notes: list[str] = field(repr=False)
    warnings: list[str]
    doubts: list[str] = field(repr=False)
    """Those of the warnings for which it should not be used."""


def calibrate(
    event: Subject | None = None,
    *,
    friction: str | None = None,
    noise: str | None = None,
    backend: str | None = None,
    chains: int | None = None,
    draws: int | None = None,
    warmup: int | None = None,
    seed: int | None = None,
    rate: float | None = None,
    thin: str | None = None,
    quick: bool = False,
    rest: bool = False,
    quiet: bool = False,
) -> Calibration:
    """Calibrates a friction law, as `couloir calibrate` does.

    `event` is an event folder or an `Event`; a passenger car coasting uphill,
    a real recording, where none is given. What is left out is as in the
    command, whose help says what each means.

    Raises `InputError` for what has to be mended, `RuntimeError` for an
    inference that failed.
    """
    options = dict(
        friction=friction, noise=noise, backend=backend, chains=chains,
        draws=draws, warmup=warmup, seed=seed, rate=rate, thin=thin,
        quick=quick, rest=rest,
    )  # fmt: skip
    subjects = [] if event is None else [event]
    made = opened(work("calibrate", options, subjects, quiet),
                  "calibration.json")  # fmt: skip
    known = made["document"]
    evidence = known["log_evidence"]
    return of(
        Calibration,
        known,
        friction=known["model"]["friction"],
        noise=known["model"]["noise"],
        parameters=parameters(known["parameters"]),
        log_evidence=evidence and of(Evidence, evidence),
        checks=of(Checks, known["checks"]),
        **made,
    )
