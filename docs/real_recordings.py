"""The tables of real-recordings.md: each event diagnosed under two statements
of its errors, at some rates.

    python3 docs/real_recordings.py OUT FOLDER ... [--rates all 5 2]

`couloir` has to be on the path. Diagnoses that OUT has already are not made
again. Where a folder has a truth.json (a flow simulated by another program,
which the engine never reads), what came out is held against it.
"""

import argparse
import bisect
import itertools
import json
import math
import pathlib
import subprocess

NOISES = ["iid", "ar(1)"]
G = 9.81  # m/s2
NEAR = 1.15  # of the least-squares figure, the RMSE may be so much


def diagnosed(out, folder, rate, noise):
    """The diagnosis of one way."""
    name = "-".join([folder.name, rate, noise.replace("(1)", "")])
    path = out / f"{name}.json"
    if not path.exists():
        thin = [] if rate == "all" else ["--rate", rate, "--thin", "pick"]
        words = ["couloir", "diagnose", str(folder), "--json", *thin]
        words += ["--noise", noise]
        # What it says on the terminal stays there.
        run = subprocess.run(words, check=True, stdout=subprocess.PIPE)
        path.write_bytes(run.stdout)
    return json.loads(path.read_text())


def single(d):
    """The mechanism with the most probability."""
    return d["mechanisms"][0]["name"]


def added(d):
    if d["selected"]:
        told = ", ".join(d["selected"])
    elif d["withheld"] and d["withheld"]["names"]:
        told = "nothing, " + ", ".join(d["withheld"]["names"]) + " withheld"
    else:
        told = "nothing"
    return told + (", weak" if d["weak"] else "")


def least_squares(improvement):
    # A force of free form has no least-squares fit of its own.
    rmse = improvement["rmse_least_squares_after"]
    return "" if rmse is None else f"{rmse:.2f}"


def is_near(improvement):
    """Whether the RMSE is about that of least squares."""
    least = improvement["rmse_least_squares_after"]
    return least is None or improvement["rmse_after"] <= NEAR * least


def row(folder, rate, noise, d):
    """One row of the table of diagnoses."""
    i = d["improvement"]
    told = [
        folder.name if rate == "all" else f"{folder.name}, {rate} a second",
        noise,
        d["verdict"],
        added(d),
        ", ".join(name.replace("friction-", "") for name in d["group"]),
        d["selected_noise"],
        f"{i['rmse_before']:.2f} to {i['rmse_after']:.2f}",
        least_squares(i),
        f"{i['heldout_rmse_before']:.1f} to {i['heldout_rmse_after']:.1f}",
    ]
    return "| " + " | ".join(told) + " |"


def amount(d, name):
    """The interval of a mechanism's amplitude, as a mechanism alone."""
    of = next((m for m in d["mechanisms"] if m["name"] == name), None)
    if of is None or not of["parameters"]:
        return None
    first = next(iter(of["parameters"].items()))
    return first[0], first[1]["q05"], first[1]["q95"]


def agreement(ways):
    """How far the ways of one recording say the same."""
    met, pairs, overlapping, compared = 0, 0, 0, 0
    for a, b in itertools.permutations(ways, 2):
        pairs += 1
        name = single(a)
        met += name in b["group"] or name == single(b)
        one, other = amount(a, name), amount(b, name)
        if one and other and one[0] == other[0]:
            compared += 1
            overlapping += one[1] <= other[2] and other[1] <= one[2]
    verdicts = {d["verdict"] for d in ways}
    return met, pairs, overlapping, compared, verdicts


def tell_agreement(all_ways):
    total = [0, 0, 0, 0]
    for name, ways in all_ways.items():
        *counts, verdicts = agreement(ways)
        total = [t + c for t, c in zip(total, counts)]
        met, pairs, overlapping, compared = counts
        print(
            f"{name}: {', '.join(sorted(verdicts))}; most probable in the "
            f"group of others {met} of {pairs}; amounts overlap "
            f"{overlapping} of {compared}"
        )
    print(f"in all: {total[0]} of {total[1]}; {total[2]} of {total[3]}")
    every = [d["improvement"] for ways in all_ways.values() for d in ways]
    worse = sum(i["rmse_after"] > i["rmse_before"] + 1e-12 for i in every)
    near = sum(is_near(i) for i in every)
    print(
        f"RMSE worse {worse} of {len(every)}; at most {NEAR} of least squares "
        f"{near} of {len(every)}"
    )


def interpolated(x, xs, ys):
    i = min(max(bisect.bisect(xs, x), 1), len(xs) - 1)
    share = (x - xs[i - 1]) / (xs[i] - xs[i - 1])
    return ys[i - 1] + share * (ys[i] - ys[i - 1])


def arclengths(folder, truth):
    """How far along the track from its release each known place is."""
    rows = (folder / "track.csv").read_text().split("\n")[1:]
    rows = [row.split(",") for row in rows if row.strip()]
    x, z = ([float(row[k]) for row in rows] for k in (0, 1))
    s = [0.0]
    for i in range(1, len(x)):
        s.append(s[-1] + math.hypot(x[i] - x[i - 1], z[i] - z[i - 1]))
    begin = truth["start_x"]
    return [interpolated(at - begin, x, s) for at in truth["along"]["x"]]


def missing_force(truth):
    """What the law's block lacks of the force that acted, in m/s2."""
    along, xi = truth["along"], truth.get("xi")
    found = []
    for i, u in enumerate(along["speed"]):
        normal = math.sqrt(G**2 - along["gravity"][i] ** 2)
        block = truth["mu"] * normal + (G * u**2 / xi if xi else 0.0)
        others = along["pressure"][i] + along["viscosity"][i]
        others -= along["growth"][i]
        found.append(block - along["friction"][i] + others)
    return found


def within_band(d, s, force):
    """The share of the run over which the force of free form has the missing
    one in its band; and the same beside the law, each less its mean."""
    found = next(f for f in d["forces"] if f["coordinate"] == "arclength")

    def share(band, is_whole):
        mean = [interpolated(x, found["at"], band["mean"]) for x in s]
        sd = [interpolated(x, found["at"], band["sd"]) for x in s]
        level = sum(m - f for m, f in zip(mean, force)) / len(s)
        shift = 0.0 if is_whole else level
        inside = (
            abs(m - shift - f) <= band["band"] * width
            for m, f, width in zip(mean, force, sd)
        )
        return sum(inside) / len(s)

    return share(found, True), share(found["beside_law"], False)


def held_against(folder, noise, d):
    """One row of the table of simulated flows."""
    truth = json.loads((folder / "truth.json").read_text())
    shares = within_band(d, arclengths(folder, truth), missing_force(truth))

    def interval(key):
        p = d["law"][key]["mu"]
        holds = p["q05"] <= truth["mu"] <= p["q95"]
        return f"{p['q05']:.3f} to {p['q95']:.3f}" + ("" if holds else " (no)")

    told = [
        folder.name,
        noise,
        str(truth["mu"]),
        interval("corrected"),
        interval("with_free_form_force"),
        *(f"{share:.2f}" for share in shares),
    ]
    return "| " + " | ".join(told) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("folders", type=pathlib.Path, nargs="+")
    parser.add_argument("--rates", nargs="+", default=["all"])
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    ways, held = {}, []
    for folder in given.folders:
        for rate, noise in itertools.product(given.rates, NOISES):
            d = diagnosed(given.out, folder, rate, noise)
            ways.setdefault(folder.name, []).append(d)
            print(row(folder, rate, noise, d), flush=True)
            if (folder / "truth.json").exists():
                held.append(held_against(folder, noise, d))
    print("\n".join(held))
    tell_agreement(ways)


if __name__ == "__main__":
    main()
