"""Time, memory and kills of `couloir sweep`.

    cargo build --release
    cargo run --release --example 18_survey -- SURVEY 100 100
    python3 benches/sweep.py target/release/couloir SURVEY

It prints a table for docs/sweep.md.
"""

import filecmp
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

KILLS = 20
OPTIONS = ["--", "--quick", "--draws=500", "--warmup=500"]


def start(couloir, survey, out, cores=None):
    """A sweep, on these cores."""
    words = [couloir, "sweep", "--quiet", "--verb=calibrate", "--out", out]
    words += [survey] + OPTIONS

    def pin():
        if cores:
            os.sched_setaffinity(0, cores)

    return subprocess.Popen(words, stdout=subprocess.DEVNULL, preexec_fn=pin)


def finish(child):
    """Its exit code and the most memory it held [MB]."""
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, usage.ru_maxrss / 1024


def timed(*words, **more):
    begun = time.monotonic()
    code, memory = finish(start(*words, **more))
    assert code == 0, f"exit code {code}"
    return time.monotonic() - begun, memory


def part(survey, number):
    """The list's first events, with every seed in turn."""
    lines = (survey / "list.csv").read_text().splitlines()
    chance = random.Random(1)
    chosen = sorted(chance.sample(range(1, len(lines)), number))
    path = survey / f"list-{number}.csv"
    text = [lines[0]] + [lines[at] for at in chosen]
    path.write_text("\n".join(text) + "\n")
    return path


def main():
    couloir, survey = sys.argv[1], Path(sys.argv[2]).resolve()
    whole = survey / "list.csv"
    events = len(whole.read_text().splitlines()) - 1
    folder = Path(tempfile.mkdtemp(prefix="couloir-sweep-"))
    cores = sorted(os.sched_getaffinity(0))

    alone = min(300, events)
    seconds, memory = timed(couloir, part(survey, alone), folder / "one", cores={cores[0]})
    each = seconds / alone
    print(f"one core, {alone} events: {each * 1e3:.1f} ms an event, {memory:.0f} MB", flush=True)
    for number in (alone * 3, events):
        if number > events:
            continue
        seconds, memory = timed(couloir, part(survey, number), folder / f"all-{number}")
        efficiency = number * each / (len(cores) * seconds)
        print(
            f"{len(cores)} cores, {number} events: {seconds:.1f} s, "
            f"{memory:.0f} MB, efficiency {efficiency:.3f}",
            flush=True,
        )
    list_of_all, out = part(survey, events), folder / "killed"
    chance, done = random.Random(2), 0
    for _ in range(KILLS):
        child = start(couloir, list_of_all, out)
        time.sleep(chance.uniform(0.0, 1.5 * seconds / KILLS))
        child.send_signal(signal.SIGKILL)
        finish(child)
    for journal in (out / "results").iterdir():
        done += journal.read_bytes().count(b"\n")
    code, _ = finish(start(couloir, list_of_all, out))
    lines = sum(j.read_bytes().count(b"\n") for j in (out / "results").iterdir())
    same = filecmp.cmp(out / "sweep.json", folder / f"all-{events}" / "sweep.json", shallow=False)
    print(
        f"{KILLS} kills: {done} events kept, {lines} lines at the end, "
        f"exit code {code}, sweep.json {'the same' if same else 'ANOTHER'}",
        flush=True,
    )
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
