"""What a user gets wrong: one clear exception, which names the place."""

import math
import os
import tempfile
import unittest
from pathlib import Path

import couloir

GIVEN = dict(
    track=([0, 300, 600, 1200], [400, 200, 80, 20]),
    times=[4, 8, 12, 16, 20, 24],
    velocity=[19.5, 27.0, 30.2, 30.9, 28.4, 25.1],
    depth=1.5,
    friction="voellmy",
    priors={"mu": "Gamma(9, 0.03)"},
    name="six speeds, synthetic",
)

# Each change, and what the message says of it.
ARRAYS = [
    (dict(friction="voelmy"), 'did you mean "voellmy"'),
    (dict(friction=""), "friction"),
    (dict(friction=5), "friction is 5; expected a text"),
    (dict(friction=None), "friction is None; expected a text"),
    (dict(noise="ar1"), "noise"),
    (dict(noise=["iid"]), "noise is ['iid']; expected a text"),
    (dict(times=[1, 2]), "different lengths {'t': 2, 'velocity': 6}"),
    (dict(times=[], velocity=[]), "six speeds, synthetic: recording.csv"),
    (dict(times=[4, 8, 12, 16, 24, 20]), "recording.csv"),
    (dict(times=5.0), "times is 5.0; expected a column of numbers"),
    (dict(times=None), "times is None; expected a column of numbers"),
    (dict(times="123456"), "times is '123456'; expected a column"),
    (dict(velocity=[1, 2, math.nan, 4, 5, 6]), "velocity[2] is nan"),
    (dict(velocity=[1, 2, math.inf, 4, 5, 6]), "velocity[2] is inf"),
    (dict(velocity=[1, 2, None, 4, 5, 6]), "velocity[2] is None"),
    (dict(velocity=[1, "2", 3, 4, 5, 6]), "velocity[1] is '2'"),
    (dict(velocity=[1, 10**400, 3, 4, 5, 6]), "velocity[1] is "),
    (dict(velocity=[1, 1j, 3, 4, 5, 6]), "velocity[1] is 1j"),
    (dict(velocity=[[1, 2], [3, 4]]), "velocity[0] is [1, 2]"),
    (dict(velocity=None), "found none of velocity, position"),
    (dict(position=[1, 2, 3, 4, 5, 6]), "found velocity, position of"),
    (dict(sigma=[1.0]), "different lengths"),
    (dict(sigma=[-1.0] * 6), "sigma"),
    (dict(track=([0, 1, 2], [2, 1])), "track: found columns of different"),
    (dict(track=([], [])), "track.csv"),
    (dict(track=([0], [1])), "track.csv"),
    (dict(track=[[0, 1], [1, 0], [2, 0]]), "two columns of numbers, x and z"),
    (dict(track=None), "track is None"),
    (dict(track="track.csv"), "track is 'track.csv'"),
    (dict(depth="thick"), "depth is 'thick'; expected a finite number"),
    (dict(depth=-1), "depth"),
    (dict(depth=math.nan), "depth is nan"),
    (dict(depth=([0, 9], [1])), "depth: found columns of different lengths"),
    (dict(depth={1: 2}), "depth is {1: 2}"),
    (dict(release="top"), "release is 'top'; expected a finite number"),
    (dict(release=-50), "release"),
    (dict(release_velocity=-1), "velocity"),
    (dict(window="long"), "window is 'long'"),
    (dict(window=-1), "window"),
    (dict(priors={"mu": 0.3}), "priors['mu'] is 0.3; expected a text"),
    (dict(priors={"mu": "Gama(9, 1)"}), 'did you mean "Gamma"'),
    (dict(priors={"nu": "Gamma(9, 1)"}), "nu"),
    (dict(priors=["Gamma(9, 1)"]), "expected priors by parameter"),
    (dict(mechanisms="surge"), "mechanisms is 'surge'; expected a list"),
    (dict(mechanisms=["serge"]), '"serge" is no mechanism'),
    (dict(mechanisms=[1]), "mechanisms[0] is 1; expected a text"),
    (dict(name="a\n[b]\x7f"), "'a\\n[b]\\x7f': event.toml:1: name"),
    (dict(name=None), "name is None; expected a text"),
]

CALLS = [
    (lambda: couloir.calibrate("nowhere"), "nowhere: does not exist"),
    (lambda: couloir.calibrate(""), "a value is required for '[EVENT]'"),
    (lambda: couloir.calibrate("a\0b"), "a"),
    (lambda: couloir.calibrate(5), "event is 5; expected an event folder"),
    (lambda: couloir.calibrate(["a", "b"]), "event is ['a', 'b']"),
    (lambda: couloir.calibrate(draws=2.5), "--draws"),
    (lambda: couloir.calibrate(draws=-1), "--draws"),
    (lambda: couloir.calibrate(draws=0), "--draws"),
    (lambda: couloir.calibrate(chains=0), "--chains"),
    (lambda: couloir.calibrate(warmup="many"), "--warmup"),
    (lambda: couloir.calibrate(seed=2**70), "--seed"),
    (lambda: couloir.calibrate(seed=-1), "--seed"),
    (lambda: couloir.calibrate(rate=math.nan), "--rate"),
    (lambda: couloir.calibrate(rate=0), "--rate"),
    (lambda: couloir.calibrate(backend="hmc"), "--backend"),
    (lambda: couloir.calibrate(noise="pink"), "pink"),
    (lambda: couloir.calibrate(quick="yes"), "--quick"),
    (lambda: couloir.diagnose("nowhere"), "nowhere: does not exist"),
    (lambda: couloir.diagnose([]), "events is []"),
    (lambda: couloir.diagnose(5), "events is 5"),
    (lambda: couloir.diagnose([5]), "event is 5"),
    (lambda: couloir.diagnose(odds={"surge": -1}), "odds"),
    (lambda: couloir.diagnose(odds={"serge": 2}), "serge"),
    (lambda: couloir.diagnose(odds="surge"), "odds"),
    (lambda: couloir.simulate(None, {"mu": "high"}), "mu"),
    (lambda: couloir.simulate(None, {"mu": math.nan}), "mu"),
    (lambda: couloir.simulate(None, {"nu": 1}), 'no parameter "nu"'),
    (lambda: couloir.simulate(None, [0.3]), "--set"),
    (lambda: couloir.import_log("nowhere.csv"), "nowhere.csv"),
    (lambda: couloir.import_log(5), "log is 5"),
    (lambda: couloir.import_log(), "avaframe"),
    (lambda: couloir.import_log(particles="mean"), "particles is"),
    (lambda: couloir.import_log(particles=["x"]), "--particle"),
    (lambda: couloir.import_log(avaframe="nowhere"), "nowhere"),
]


class Wrong(unittest.TestCase):
    def refused(self, call, said):
        with self.assertRaises(couloir.InputError) as caught:
            call()
        told = str(caught.exception)
        self.assertIn(said, told)
        # A folder of the package's own is gone when this is read.
        self.assertNotIn(tempfile.gettempdir() + "/couloir-", told)

    def test_arrays(self):
        for change, said in ARRAYS:
            with self.subTest(change):
                event = couloir.Event(**{**GIVEN, **change})
                self.refused(
                    lambda: couloir.calibrate(event, quick=True, quiet=True),
                    said,
                )

    def test_calls(self):
        for i, (call, said) in enumerate(CALLS):
            with self.subTest(i=i, said=said):
                self.refused(call, said)

    def test_a_keyword_that_is_not_known(self):
        with self.assertRaisesRegex(TypeError, "format"):
            couloir.calibrate(format="hdf5")

    def test_a_file_in_the_way(self):
        event = couloir.Event(**GIVEN)
        found = couloir.simulate(event)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "file"
            file.write_text("mine")
            for save in (found.save, event.save):
                with self.assertRaises((OSError, couloir.InputError)):
                    save(file)
            self.assertEqual(file.read_text(), "mine")


class Right(unittest.TestCase):
    """What is another type and as good."""

    def setUp(self):
        self.files = couloir.Event(**GIVEN).files()

    def same(self, **change):
        files = couloir.Event(**{**GIVEN, **change}).files()
        self.assertEqual(files, self.files)

    def test_whole_numbers_and_iterators(self):
        self.same(times=map(float, GIVEN["times"]), track=iter(GIVEN["track"]))

    def test_numpy(self):
        import numpy

        for kind in (numpy.float64, numpy.float32, numpy.int64):
            self.same(
                times=numpy.array(GIVEN["times"], kind),
                track=numpy.array(GIVEN["track"], kind),
                depth=numpy.float32(1.5),
            )
        # What is no multiple of a power of two is what the array holds.
        event = couloir.Event(
            **{**GIVEN, "velocity": numpy.array(GIVEN["velocity"], "f4")}
        )
        known = couloir.simulate(event, {"mu": numpy.float32(0.25)})
        self.assertEqual(known.parameters["mu"], 0.25)
        held = repr(float(numpy.float32(30.2)))
        self.assertIn(held, event.files()["recording.csv"])

    def test_data_frames(self):
        import pandas
        import polars

        for kind in (pandas.DataFrame, polars.DataFrame):
            frame = kind({k: GIVEN[k] for k in ("times", "velocity")})
            self.same(times=frame["times"], velocity=frame["velocity"])
        gap = polars.Series([1.0, None])
        with self.assertRaisesRegex(couloir.InputError, r"\[1\] is None"):
            couloir.Event(**{**GIVEN, "times": gap}).files()
        gap = pandas.Series([1.0, None])
        with self.assertRaisesRegex(couloir.InputError, r"\[1\] is nan"):
            couloir.Event(**{**GIVEN, "times": gap}).files()

    def test_any_text_is_a_name(self):
        for name in ('"', "\\", "Piz 🏔 Ü", "a = 1 [b]"):
            found = couloir.simulate(couloir.Event(**{**GIVEN, "name": name}))
            self.assertEqual(found.event, name)

    def test_paths_of_any_kind(self):
        with tempfile.TemporaryDirectory() as folder:
            place = os.path.join(folder, "with space")
            couloir.Event(**GIVEN).save(place)
            for path in (place, Path(place), os.fsencode(place)):
                self.assertEqual(couloir.simulate(path).event, GIVEN["name"])


if __name__ == "__main__":
    unittest.main()
