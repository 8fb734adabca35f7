"""Recordings: what is written is read again, damage is named in words, folders and bags are read."""

import math
import pathlib
import random
import subprocess
import tempfile
import unittest

import view_fixtures
from stg_common.files import Damaged, FileError
from stg_view.from_folder import read_folder
from stg_view.recording import Packets, RecordingError, Recording, encode, messages

REPORT = pathlib.Path(__file__).resolve().parents[1] / "scripts" / "report.py"
LOG = """source,destination,addressed,kind,sequence,bytes,offered_s,generation_s,transmit_s,\
transmit_end_s,begin_s,arrival_s,distance_m,travel_time_s,received_level_db,noise_level_db,sinr_db,\
error_probability,fate
0,1,all,data,0,32,1.0,1.0,1.0,1.5,1.1,1.6,150.0,0.1,100,50,20,0.01,delivered
0,2,all,data,0,32,1.0,1.0,1.0,1.5,1.2,1.7,300.0,0.2,90,50,5,0.6,loss
1,0,all,data,,32,2.0,2.0,,,,,,,,,,,queue
1,2,all,data,,32,2.0,2.0,,,,,,,,,,,queue
"""


def by_kind(data):
    """Returns {kind: (header, columns)} of the last message of each kind."""
    return {header["kind"]: (header, columns) for header, columns in messages(data)}


class FormatTest(unittest.TestCase):
    """The bytes."""

    def test_columns_come_back_as_they_went(self):
        columns = [("a", "f8", [1.5, -2.25]), ("b", "i4", [[1, 2, 3], [4, 5, 6]]), ("c", "u1", [7, 255])]
        data = b"STGVIEW1" + encode("x", columns, word="w")
        ((header, found),) = messages(data)
        self.assertEqual(("x", "w", 2), (header["kind"], header["word"], header["rows"]))
        self.assertEqual([[1.5], [-2.25]], found["a"].tolist())
        self.assertEqual([[1, 2, 3], [4, 5, 6]], found["b"].tolist())
        self.assertEqual([[7], [255]], found["c"].tolist())

    def test_header_and_columns_begin_at_multiples_of_eight(self):
        for text in ("", "a", "abcdefg"):
            data = encode("x", [("a", "u1", [1, 2, 3]), ("b", "f8", [1, 2, 3])], text=text)
            self.assertEqual(0, len(data) % 8)

    def test_what_is_cut_off_is_left_out_and_damage_is_told(self):
        data = view_fixtures.made_up(steps=5).encoded()
        whole = len(list(messages(data)))
        self.assertEqual(whole - 1, len(list(messages(data[:-3]))))
        with self.assertRaises(RecordingError):
            list(messages(b"something else"))
        rng = random.Random(1)
        for _ in range(300):
            broken = bytearray(data)
            for _ in range(5):
                broken[rng.randrange(8, len(broken))] = rng.randrange(256)
            try:
                list(messages(bytes(broken)))
            except RecordingError:
                pass

    def test_numbers_that_are_none_become_null(self):
        ((header, _),) = messages(b"STGVIEW1" + encode("x", value={"a": [math.nan, math.inf, 1.0]}))
        self.assertEqual([None, None, 1.0], header["value"]["a"])

    def test_many_packets_are_thinned_by_transmission_and_counted_whole(self):
        packets, sent = Packets(), 120_000
        for k in range(sent):
            for receiver in (1, 2):
                packets.add(0, receiver, k, 32, k % 2, k, k, k, k, 1.0, 1.0, 0.0)
        found = by_kind(b"STGVIEW1" + packets.encoded())
        self.assertEqual([sent, sent], found["totals"][0]["fates"][:2])
        self.assertEqual(sent, found["totals"][0]["transmissions"])
        self.assertEqual([sent // 2] * 2, found["totals"][0]["links"]["0>1"][:2])
        self.assertEqual(sent, found["packets"][0]["rows"])  # every second packet is kept, for two receivers

    def test_many_steps_are_thinned_and_the_page_is_told(self):
        recording = Recording(agents=1, targets=1)
        for k in range(100_000):
            recording.steps.add(t=float(k), position=[0.0] * 60)
        found = by_kind(recording.encoded())
        t = found["steps"][1]["t"].ravel()
        self.assertLess(len(t), 60_000)
        self.assertEqual(1, len(set((t[1:] - t[:-1]).tolist())))
        self.assertIn("one is shown", found["note"][0]["text"])


class FoldersTest(unittest.TestCase):
    """Folders and logs."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)

    def test_packet_log(self):
        (self.path / "packets.csv").write_text(LOG)
        found = by_kind(read_folder(self.path / "packets.csv"))
        self.assertEqual(["0", "1", "2"], found["meta"][0]["meta"]["names"])
        self.assertEqual([0, 2, 7, 7], found["packets"][1]["fate"].ravel().tolist())
        self.assertTrue(math.isnan(found["packets"][1]["transmit"][2, 0]))

    def test_simulation_has_the_ways_of_its_nodes(self):
        (self.path / "packets.csv").write_text(LOG)
        (self.path / "simulation.yaml").write_text(
            "duration_s: 100.0\nnodes:\n- {id: 0, position_m: [0, 0, -5]}\n"
            "- {id: 1, position_m: [10, 0, -5], velocity_mps: [0.5, 0, 0]}\n- {id: 2, position_m: [0, 9, -5]}\n"
        )
        steps = by_kind(read_folder(self.path))["steps"][1]
        self.assertEqual([0.0, 100.0], [steps["t"][0, 0], steps["t"][-1, 0]])
        self.assertAlmostEqual(60.0, float(steps["position"][-1, 3]), places=4)
        self.assertAlmostEqual(9.0, float(steps["position"][-1, 7]), places=4)

    def test_training_has_curves(self):
        (self.path / "progress.csv").write_text("steps,wall_seconds,reward,validation_return\n100,1,1.0,\n200,2,2.0,5\n300,3,3.0,\n")
        curves = [h["title"] for h, _ in messages(read_folder(self.path)) if h["kind"] == "curves"]
        # The purpose of a training comes first.
        self.assertEqual(["validation return", "reward", "wall seconds"], curves)

    def test_what_is_no_run_is_refused_in_words(self):
        with self.assertRaisesRegex(FileError, "nothing to report"):
            read_folder(self.path)
        (self.path / "packets.csv").write_text(LOG.replace("loss", "<b>"))
        with self.assertRaisesRegex(Damaged, "packets.csv:3: fate"):
            read_folder(self.path)
        (self.path / "recording.stgv").write_bytes(b"STGVIEW1")
        with self.assertRaisesRegex(Damaged, "no steps"):
            read_folder(self.path)

    def test_program_ends_in_one_line(self):
        for run in ("nowhere", "."):
            done = subprocess.run([REPORT, run], cwd=self.path, capture_output=True, text=True, check=False)
            self.assertEqual(2, done.returncode)
            self.assertEqual(1, len(done.stderr.splitlines()), done.stderr)
            self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    unittest.main()
