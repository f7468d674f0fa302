"""A parameter's posterior in figures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, TypeVar

Kind = TypeVar("Kind")


@dataclass(frozen=True)
class Parameter:
    """A parameter's posterior in figures, each in the parameter's unit."""

    name: str
    unit: str
    """SI; "1" for a pure number."""
    mean: float
    sd: float
    q05: float
    q50: float
    q95: float
    q025: float | None = None
    q975: float | None = None
    map: float | None = None
    """Its value at the posterior mode."""
    rhat: float | None = None
    """R-hat between and within chains; 1 where they agree."""
    ess_bulk: float | None = None
    ess_tail: float | None = None
    mcse_mean: float | None = None
    """The Monte Carlo error of the mean."""


def parameters(known: Mapping[str, Any]) -> dict[str, Parameter]:
    """Those of a document of couloir's, by their names."""
    return {name: of(Parameter, known[name], name=name) for name in known}


def of(kind: type[Kind], known: Mapping[str, Any], **more: Any) -> Kind:
    """A dataclass of those entries of a document that it has fields for."""
    every = fields(kind)  # type: ignore[arg-type]
    names = {field.name for field in every} - set(more)
    own = {name: known[name] for name in names if name in known}
    return kind(**own, **more)
