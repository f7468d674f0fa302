"""ArviZ's InferenceData of what the compiled part hands over."""

from __future__ import annotations

from typing import Any


def inference_data(groups: dict[str, Any]) -> Any:
    """The groups as InferenceData."""
    try:
        import arviz
        import numpy
        import xarray
    except ImportError as error:
        raise ImportError(
            f"{error}; InferenceData needs ArviZ: pip install couloir[arviz]"
        ) from error

    def variable(known: dict[str, Any]) -> Any:
        values = known["values"]
        if known["type"] == "str":
            values = numpy.array(values)
        else:
            values = numpy.frombuffer(values, known["type"])
        told = {k: known[k] for k in ("units", "long_name") if known[k]}
        shaped = values.reshape(known["shape"])
        return xarray.Variable(known["dimensions"], shaped, told)

    def dataset(own: dict[str, str], variables: dict[str, Any]) -> Any:
        made = {name: variable(known) for name, known in variables.items()}
        along = {name for name in made if made[name].dims == (name,)}
        data = {name: v for name, v in made.items() if name not in along}
        places = {name: made[name] for name in along}
        return xarray.Dataset(data, places, {**groups[""], **own})

    named = {name: dataset(*group) for name, group in groups.items() if name}
    return arviz.InferenceData(**named, attrs=groups[""])
