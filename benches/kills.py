"""Long runs, killed at random moments and begun again.

    cargo build --release
    python3 benches/kills.py target/release/couloir [KILLS]

Each command is run once to its end, then again with kill -9 at moments drawn
evenly over as long, until as many kills as asked for have met a run; what it
then writes has to be the same but for the seconds it took. It prints a table
for docs/sweep.md.
"""

import json
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

RUNS = {
    "calibrate": (
        ["calibrate", "--draws=300000", "--warmup=50000", "--format=csv"],
        "calibration.json",
    ),
    "challenge": (["challenge", "--cases=10", "--quick"], "challenge.json"),
    "reproduce": (["reproduce", "--samples=10"], "reproduction.json"),
}


def without_seconds(value):
    """A document without the times that it took."""
    if isinstance(value, dict):
        kept = {k: v for k, v in value.items() if k not in ("seconds", "command")}
        return {k: without_seconds(v) for k, v in kept.items()}
    if isinstance(value, list):
        return [without_seconds(one) for one in value]
    return value


def start(couloir, words, out):
    words = [couloir, *words, "--out", out]
    return subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def result(out, file):
    found = without_seconds(json.loads((out / file).read_text()))
    draws = out / "draws.csv"
    return found, draws.read_bytes() if draws.exists() else b""


def main():
    couloir = sys.argv[1]
    kills = int(sys.argv[2]) if len(sys.argv) > 2 else 50
    chance = random.Random(1)
    folder = Path(tempfile.mkdtemp(prefix="couloir-kills-"))
    print("command | s without a stop | kills | s with them | went on | same")
    for verb, (words, file) in RUNS.items():
        begun = time.monotonic()
        whole = start(couloir, words, folder / verb)
        whole.communicate()
        assert whole.returncode == 0, verb
        alone = time.monotonic() - begun
        spent, met, resumed, out = 0.0, 0, 0, folder / f"{verb}-killed"
        while met < kills:
            begun = time.monotonic()
            child = start(couloir, words, out)
            try:
                child.communicate(timeout=chance.uniform(0.0, alone))
                # It came to its end: the next begins anew.
                assert child.returncode == 0, verb
                assert result(out, file) == result(folder / verb, file), verb
                shutil.rmtree(out)
            except subprocess.TimeoutExpired:
                child.kill()
                resumed += b"Going on" in child.communicate()[1]
                met += 1
            spent += time.monotonic() - begun
        last = start(couloir, words, out)
        told = last.communicate()[1].decode()
        assert last.returncode == 0, told
        same = result(out, file) == result(folder / verb, file)
        resumed += "Going on" in told
        print(f"{verb} | {alone:.1f} | {met} | {spent:.1f} | {resumed} | {same}", flush=True)
        assert same, verb
        assert not (out / ".couloir-checkpoint").exists()
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
