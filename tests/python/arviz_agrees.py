"""Calibrates by the command, reads its Zarr and Parquet back, and compares
R-hat, effective sizes and leave-one-out prediction by ArviZ with what
calibration.json says, to three digits.

    python tests/python/arviz_agrees.py target/release/couloir

The command has to be built with --features export; requirements.txt beside
this file names the versions.
"""

import json
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

warnings.simplefilter("ignore")

import arviz as az  # noqa: E402
import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402

EVENT = Path(__file__).parents[1] / "data" / "voellmy-21"

# Three digits of a figure.
DIGITS = 5e-4

GROUPS = {
    "posterior", "log_likelihood", "posterior_predictive", "sample_stats",
    "prior", "prior_predictive", "observed_data",
}


def calibrate(couloir, folder, *options):
    """The draws and the JSON of a run."""
    command = [couloir, "calibrate", EVENT, "--out", folder]
    formats = ["--format", "zarr,parquet,csv,latex"]
    subprocess.run(
        [*command, *formats, *options], check=True, stdout=subprocess.DEVNULL
    )
    data = az.from_zarr(str(folder / "draws.zarr"))
    found = json.loads((folder / "calibration.json").read_text())
    return data, found


def near(what, found, expected, tolerance=DIGITS):
    """Fails where two figures differ by more than a share."""
    found, expected = np.asarray(found, float), np.asarray(expected, float)
    scale = np.maximum(1e-9, np.abs(expected))
    largest = np.max(np.abs(found - expected) / scale)
    assert largest <= tolerance, f"{what}: {found} for {expected}"
    return largest


def tail_size(draws):
    """The effective size of the tails as the paper has it, of indicators of
    draws at or below the quantiles. ArviZ's own rounds a quantile between
    two equal draws, and may so leave both out."""
    sizes = []
    for p in (0.05, 0.95):
        below = (draws <= np.quantile(draws, p)).astype(float)
        sizes.append(float(az.ess(below.values, method="mean")))
    return min(sizes)


def columns(variable):
    """A name, as in the JSON, and draws for each parameter of a variable."""
    further = [d for d in variable.dims if d not in ("chain", "draw")]
    if not further:
        return [(variable.name, variable)]
    (along,) = further
    labels = variable[along].values
    name = variable.name
    return [(f"{name}[{x}]", variable.sel({along: x})) for x in labels]


def check_parameters(data, found):
    known = found["parameters"]
    seen, worst = set(), {}
    for variable in data.posterior.data_vars.values():
        for name, draws in columns(variable):
            figures = known[name]
            seen.add(name)
            bulk = az.ess(draws.values, method="bulk")
            error = az.mcse(draws.values, method="mean")
            pairs = {
                "bulk": (figures["ess_bulk"], bulk),
                "tail": (figures["ess_tail"], tail_size(draws)),
                "mcse": (figures["mcse_mean"], error),
            }
            # ArviZ has none of a single chain.
            if len(draws.chain) > 1:
                pairs["rhat"] = (figures["rhat"], az.rhat(draws.values))
            for key, pair in pairs.items():
                off = near(f"{name}: {key}", *pair)
                worst[key] = max(worst.get(key, 0), off)
            own = az.ess(draws.values, method="tail")
            off = abs(figures["ess_tail"] / own - 1)
            worst["tail, ArviZ's own"] = max(
                worst.get("tail, ArviZ's own", 0), off
            )
            near(f"{name}: mean", figures["mean"], draws.mean(), 1e-12)
            assert draws.attrs.get("units", figures["unit"]) == figures["unit"]
    assert seen == set(known), f"{seen} for {set(known)}"
    return worst


def check_loo(data, found):
    loo = found["loo"]
    # Of one chain ArviZ takes every draw for independent.
    one = len(data.posterior.chain) == 1
    efficiency = loo["r_eff"] if one else None
    own = az.loo(data, pointwise=True, reff=efficiency)
    k = np.array(loo["pareto_k"], float)
    # A shape may be anything near 0: three digits of 1.
    off = float(np.max(np.abs(k - own.pareto_k.values)))
    assert off <= DIGITS, f"Pareto k: {k} for {own.pareto_k.values}"
    # ArviZ divides the variance by n, the paper by n - 1.
    n = own.n_data_points
    return {
        "elpd_loo": near("elpd_loo", loo["elpd"], own.elpd_loo),
        "p_loo": near("p_loo", loo["p_loo"], own.p_loo),
        "se": near("se", loo["se"] * np.sqrt((n - 1) / n), own.se),
        "pareto_k": off,
        "pointwise": near("pointwise", loo["pointwise"], own.loo_i.values),
    }


def check_groups(data, found):
    assert GROUPS <= set(data.groups()), data.groups()
    recording = pd.read_csv(EVENT / "recording.csv")
    seen = data.observed_data.velocity
    assert np.array_equal(seen.values, recording["velocity"].values)
    assert np.array_equal(seen.time.values, recording["t"].values)
    assert seen.attrs["units"] == "m/s" and seen.time.attrs["units"] == "s"
    sizes = data.posterior.sizes
    whole = (sizes["chain"], sizes["draw"], len(recording))
    for group in ("log_likelihood", "posterior_predictive"):
        assert data[group].velocity.shape == whole, group
        assert data[group].velocity.dims == ("chain", "draw", "time")
    prior = data.prior_predictive.velocity
    assert prior.shape == (1, data.prior.sizes["draw"], len(recording))
    assert set(data.prior.data_vars) == set(data.posterior.data_vars)
    attributes = data.posterior.attrs
    assert attributes["seed"] == str(found["seed"])
    assert json.loads(attributes["inputs"]) == found["inputs"]
    # The prediction covers what it was fitted to about as often as it says.
    low, high = np.quantile(
        data.posterior_predictive.velocity, [0.05, 0.95], axis=(0, 1)
    )
    inside = np.mean((low <= seen.values) & (seen.values <= high))
    near("coverage", inside, found["checks"]["coverage90"], 1.5 / len(seen))


def check_tables(data, folder):
    parquet = pd.read_parquet(folder / "draws.parquet")
    # The shortest digits that read back to the same bits.
    csv = pd.read_csv(folder / "draws.csv", float_precision="round_trip")
    assert parquet.equals(csv)
    for variable in data.posterior.data_vars.values():
        for name, draws in columns(variable):
            assert np.array_equal(parquet[name].values, draws.values.ravel())


def main(couloir):
    runs = {
        "mh": ["--backend", "mh"],
        "vector": ["--backend", "mh", "--noise", "ar(2)", "--draws", "4000"],
        "smc": ["--backend", "smc"],
        "importance": ["--backend", "importance"],
    }
    with tempfile.TemporaryDirectory() as root:
        for name, options in runs.items():
            folder = Path(root) / name
            data, found = calibrate(couloir, folder, *options)
            check_groups(data, found)
            worst = check_parameters(data, found) | check_loo(data, found)
            check_tables(data, folder)
            told = ", ".join(f"{k} {float(v):.1e}" for k, v in worst.items())
            print(f"{name}: largest differences: {told}")
        folder = Path(root) / "averaged"
        data, found = calibrate(couloir, folder, "--noise", "infer")
        assert data.groups() == ["posterior"] and "loo" not in found
    print("ArviZ", az.__version__, "agrees")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]).resolve())
