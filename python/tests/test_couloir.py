"""The package against the command that it carries, and by itself."""

import json
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import couloir

ROOT = Path(__file__).parents[2]
EVENT = ROOT / "tests" / "data" / "voellmy-21"
COMMAND = str(Path(sys.executable).parent / "couloir")

# What may differ between two runs: how long they took, and how they were
# asked for.
OWN = {"seconds", "command"}


def printed(*words):
    """The JSON document that the command prints."""
    command = [COMMAND, *map(str, words), "--json", "--quiet"]
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout
    return json.loads(text)


class AsTheCommand(unittest.TestCase):
    """For the same seed all figures are the same to the last bit."""

    def same(self, document, other):
        self.assertEqual(set(document), set(other))
        for key in set(document) - OWN:
            self.assertEqual(document[key], other[key], key)

    def test_calibrate(self):
        for event in (None, EVENT):
            words = [] if event is None else [event]
            found = couloir.calibrate(event, quick=True, seed=3, quiet=True)
            other = printed("calibrate", "--quick", "--seed=3", *words)
            self.same(found.document, other)
            self.assertNotEqual(
                found.document["parameters"],
                printed("calibrate", "--quick", *words)["parameters"],
            )

    def test_diagnose(self):
        for events, words in ((None, []), (EVENT, [EVENT])):
            found = couloir.diagnose(events, quick=True, seed=3, quiet=True)
            other = printed("diagnose", "--quick", "--seed=3", *words)
            self.same(found.document, other)

    def test_simulate(self):
        found = couloir.simulate(EVENT, {"mu": 0.3, "xi": 900})
        other = printed("simulate", EVENT, "--set=mu=0.3", "--set=xi=900")
        self.same(found.document, other)

    def test_what_is_saved_is_what_the_command_writes(self):
        with tempfile.TemporaryDirectory() as root:
            saved, written = Path(root) / "a", Path(root) / "b"
            couloir.simulate(EVENT, {"mu": 0.3}).save(saved)
            words = ["simulate", EVENT, "--set=mu=0.3", "--out", written]
            subprocess.run([COMMAND, *words], check=True, capture_output=True)
            names = sorted(p.name for p in written.iterdir())
            self.assertEqual(names, sorted(p.name for p in saved.iterdir()))
            for name in names:
                both = saved / name, written / name
                one, other = (file.read_text() for file in both)
                if name.endswith(".json"):
                    self.same(json.loads(one), json.loads(other))
                elif name == "couloir.sha256":
                    # The JSON's differs, which says how it was asked for.
                    sums = re.compile(r"^[0-9a-f]{64}", re.MULTILINE)
                    self.assertEqual(sums.sub("", one), sums.sub("", other))
                else:
                    self.assertEqual(one, other, name)


def columns(path):
    rows = [line.split(",") for line in path.read_text().split()[1:]]
    return [[float(x) for x in column] for column in zip(*rows)]


class Arrays(unittest.TestCase):
    def event(self, **changed):
        times, speeds = columns(EVENT / "recording.csv")[:2]
        arguments = dict(
            track=tuple(columns(EVENT / "track.csv")),
            times=times,
            velocity=speeds,
            name="Lautaret-like, synthetic, AR(1) errors",
            release=0.0,
            depth=2.19,
            friction="voellmy",
            noise="ar(1)",
            priors={
                "mu": "Gamma(9, 0.03)",
                "xi": "Gamma(2.5, 400)",
                "phi": "Uniform(-1, 1)",
                "sigma2": "InverseGamma(3, 20)",
            },
        )
        return couloir.Event(**{**arguments, **changed})

    def test_arrays_are_as_good_as_files(self):
        arrays = couloir.calibrate(self.event(), quick=True, quiet=True)
        files = couloir.calibrate(EVENT, quick=True, quiet=True)
        self.assertEqual(arrays.parameters, files.parameters)

    def test_what_is_wrong_is_told(self):
        wrong = {
            "voellmy": dict(friction="voelmy"),
            "different lengths": dict(velocity=[1.0]),
            "expected one of them": dict(velocity=None),
            "recording.csv": dict(times=list(range(21, 0, -1))),
        }
        for said, change in wrong.items():
            with self.assertRaises(couloir.InputError) as caught:
                couloir.calibrate(self.event(**change), quiet=True)
            self.assertIn(said, str(caught.exception))
        self.assertTrue(issubclass(couloir.InputError, ValueError))

    def test_an_option_is_told_as_in_a_terminal(self):
        with self.assertRaisesRegex(couloir.InputError, "--backend"):
            couloir.calibrate(backend="hmc", quiet=True)


class Running(unittest.TestCase):
    def test_other_threads_run_meanwhile(self):
        # Without the lock released, nothing is counted while it computes.
        ticks, done = [], threading.Event()

        def tick():
            while not done.wait(0.01):
                ticks.append(time.monotonic())

        counter = threading.Thread(target=tick)
        counter.start()
        begun = time.monotonic()
        couloir.diagnose(quick=True, quiet=True)
        took = time.monotonic() - begun
        done.set()
        counter.join()
        self.assertGreater(len(ticks), 10 * took)

    def test_ctrl_c_is_heard(self):
        code = (
            "import couloir, signal, threading, os, time\n"
            # Where the tests run in the background, it is ignored.
            "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
            "kill = os.getpid(), signal.SIGINT\n"
            "threading.Timer(1, os.kill, kill).start()\n"
            "begun = time.monotonic()\n"
            "try:\n"
            "    couloir.calibrate(draws=900_000, quiet=True)\n"
            "except KeyboardInterrupt:\n"
            "    print('heard', time.monotonic() - begun < 5)\n"
        )
        run = subprocess.run(
            [sys.executable, "-c", code], stdout=subprocess.PIPE, timeout=60
        )
        self.assertEqual(run.stdout, b"heard True\n")

    def test_the_command_ends_as_it_should(self):
        ended = [
            subprocess.run([COMMAND, *words], capture_output=True).returncode
            for words in (["--help"], ["--nonsense"], ["calibrate", "nowhere"])
        ]
        self.assertEqual(ended, [0, 2, 2])


class Shown(unittest.TestCase):
    def test_draws_are_those_of_the_table(self):
        found = couloir.calibrate(quick=True, quiet=True)
        draws = found.draws()
        for name, column in draws.columns.items():
            mean = sum(column) / len(column)
            told = found.parameters[name].mean
            # Sums of thousands of numbers in another order.
            self.assertAlmostEqual(mean / told, 1.0, places=9)
        self.assertEqual(set(draws.chain), {0, 1, 2, 3})

    def test_a_notebook_shows_pages_and_pictures(self):
        found = couloir.calibrate(quick=True, quiet=True)
        self.assertIn("recording", [f.name for f in found.figures()])
        self.assertTrue(found._repr_html_().startswith("<iframe"))
        found = couloir.diagnose(quick=True, quiet=True)
        for figure in found.figures():
            self.assertTrue(figure._repr_svg_().startswith("<svg"))
        self.assertIn("recording-0", [f.name for f in found.figures()])

    def test_arviz_takes_it(self):
        try:
            import arviz
        except ImportError:
            self.skipTest("there is no ArviZ")
        found = couloir.calibrate(EVENT, quick=True, quiet=True)
        data = found.to_inferencedata()
        self.assertEqual(
            data.observed_data.velocity.values.tolist(),
            columns(EVENT / "recording.csv")[1],
        )
        # Three digits, as .ci/arviz has them.
        rhat = float(arviz.rhat(data)["mu"])
        self.assertAlmostEqual(rhat, found.parameters["mu"].rhat, delta=5e-4)


class Many(unittest.TestCase):
    """A sweep in shards on Dask is the command's own, byte for byte."""

    def events(self, root):
        for number in range(3):
            event = root / f"event {number}"
            event.mkdir()
            for file in EVENT.iterdir():
                (event / file.name).write_bytes(file.read_bytes())
        return sorted(root.glob("event *"))

    def test_dask(self):
        try:
            from dask.distributed import Client, LocalCluster
        except ImportError:
            self.skipTest("there is no Dask")
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            events, options = self.events(root), {"quick": True, "draws": 100}
            here = couloir.sweep(
                events, root / "here", verb="calibrate", **options
            )
            self.assertEqual((here.events, here.failed), (3, 0))
            with LocalCluster(
                n_workers=2, threads_per_worker=1, dashboard_address=None
            ) as cluster, Client(cluster) as client:
                there = couloir.sweep(
                    events, root / "there", verb="calibrate", client=client,
                    shards=2, **options
                )
            self.assertEqual(here.document, there.document)
            self.assertEqual(
                *(
                    (x.folder / "sweep.json").read_bytes()
                    for x in (here, there)
                )
            )

    def test_what_is_wrong_is_an_error_of_input(self):
        with tempfile.TemporaryDirectory() as out:
            for events in ("missing", [], b"x"):
                with self.assertRaises(couloir.InputError):
                    couloir.sweep(events, out)


if __name__ == "__main__":
    unittest.main()
