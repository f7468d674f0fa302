"""The guides, line by line: every Python block runs as it is written."""

import contextlib
import io
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from test_couloir import COMMAND, EVENT, ROOT, columns

RAW = ROOT.parent / "shared" / "recordings" / "avanodes" / "raw"


def run(guide, names):
    """Runs a guide's blocks in one namespace; what they print."""
    text = guide.read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```$", text, re.DOTALL | re.M)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for i, block in enumerate(blocks):
            exec(compile(block, f"{guide.name}, block {i}", "exec"), names)
    return len(blocks), printed.getvalue()


class Guides(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        for name in ("mine", "event"):
            subprocess.run([COMMAND, "new", name, "--quiet"], check=True)

    def test_the_manual(self):
        count, printed = run(ROOT / "manual" / "src" / "python.md", {})
        self.assertEqual(count, 5)
        self.assertIn("missing-physics ['turbulent-drag']", printed)
        self.assertIn('did you mean "voellmy"?', printed)
        self.assertTrue(Path("from-python/report.html").is_file())

    def test_the_readme(self):
        x, z = columns(EVENT / "track.csv")
        t, v = columns(EVENT / "recording.csv")[:2]
        names = dict(x=x, z=z, t=t, v=v)
        count, _ = run(ROOT / "python" / "README.md", names)
        self.assertEqual(count, 1)
        self.assertEqual(names["diagnosis"].verdict, "adequate")
        self.assertTrue(Path("results/report.html").is_file())


class SeveralRecordings(unittest.TestCase):
    def test_each_is_an_event(self):
        import couloir

        rows = [f"{t},{0.5 * t * t},0,{100 - 0.3 * t * t}" for t in range(12)]
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.csv", "b.csv"):
                text = "\n".join(["t,x,y,z", *rows]) + "\n"
                (Path(folder) / name).write_text(text)
            both = couloir.import_log(
                Path(folder) / "a.csv", front=Path(folder) / "b.csv"
            )
            both.save(Path(folder) / "events")
            self.assertTrue((Path(folder) / "events/b/event.toml").is_file())
        self.assertTrue(both.told.startswith("a/\n"))
        names = [figure.name for figure in both.figures()]
        self.assertEqual(names, ["a/import", "b/import"])


class RecordedLog(unittest.TestCase):
    def test_it_goes_to_a_diagnosis(self):
        import couloir

        if not RAW.is_dir():
            self.skipTest(f"there is no {RAW}")
        with tempfile.TemporaryDirectory() as folder:
            event = Path(folder) / "event"
            couloir.import_log(
                RAW / "ava220123_C01.txt",
                terrain=RAW / "dem_crop_5m_epsg31254.asc",
                crs="EPSG:31254",
            ).save(event)
            found = couloir.diagnose(
                event, friction="coulomb", quick=True, quiet=True
            )
        # Coulomb friction alone has no terminal speed. Those who recorded
        # this avalanche name a state of steady flow.
        self.assertNotEqual(found.verdict, "adequate")


if __name__ == "__main__":
    unittest.main()
