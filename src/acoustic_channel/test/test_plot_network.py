#!/usr/bin/python3
"""The pictures of packet logs show what is in the log, and bad logs are refused."""

import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from stg_common.loading import load_program

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../scripts/plot_network.py")
plot_network = load_program(SCRIPT)

HEADER = (
    "source,destination,addressed,kind,sequence,bytes,offered_s,generation_s,transmit_s,"
    "transmit_end_s,begin_s,arrival_s,distance_m,travel_time_s,received_level_db,"
    "noise_level_db,sinr_db,error_probability,fate\n"
)


def row(source, destination, sequence, made, arrival, fate="delivered"):
    """A row of a packet that lasts one second and travels for one second."""
    times = f"{made},{made},{arrival - 2},{arrival - 1},{arrival - 1},{arrival}"
    return f"{source},{destination},all,data,{sequence},8,{times},1500,1,0,0,0,0,{fate}\n"


class PlotNetwork(unittest.TestCase):
    """Each test has a folder with a packet log."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def write(self, text):
        """Writes the packet log of the folder."""
        path = os.path.join(self.folder.name, "packets.csv")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def run_script(self, *arguments):
        """Runs the program on the folder."""
        return subprocess.run(
            [SCRIPT, self.folder.name, *arguments], capture_output=True, text=True, check=False
        )

    def test_log_of_a_node_is_drawn_from_its_first_time_on(self):
        start_s = 1.75e9  # seconds of the wall clock
        rows = [(0, 1, 0, 1.0, 4.0), (0, 1, 1, 6.0, 9.0)]
        at_zero = plot_network.Log(self.write(HEADER + "".join(row(*r) for r in rows)))
        at_zero.count_from_first()
        file = os.path.join(self.folder.name, "log of a node.csv")
        with open(file, "w", encoding="utf-8") as log:
            log.write(HEADER + "".join(row(*r[:3], start_s + r[3], start_s + r[4]) for r in rows))
        read, _, picture = plot_network.read(file)
        self.assertEqual(read.end_s, 8.0)
        self.assertEqual(picture, os.path.join(self.folder.name, "log of a node.png"))
        self.assertEqual(read.transmissions(), at_zero.transmissions())
        for pieces, same in zip(plot_network.age_segments(read), plot_network.age_segments(at_zero)):
            np.testing.assert_array_equal(pieces, same)
        done = subprocess.run([SCRIPT, file], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout), (0, picture + "\n"), done.stderr)
        self.assertTrue(os.path.isfile(picture))

    def test_what_is_written_is_named_also_where_it_cannot_be(self):
        self.write(HEADER + row(0, 1, 0, 1.0, 4.0))
        picture = os.path.join(self.folder.name, "picture")
        done = self.run_script("--out", picture)
        self.assertEqual(done.stdout, picture + ".png\n", done.stderr)
        self.assertTrue(os.path.isfile(picture + ".png"))
        os.symlink("/dev/full", picture + ".svg")
        done = self.run_script("--out", picture + ".svg")
        self.assertEqual(done.stderr, f"plot_network: {picture}.svg: No space left on device\n")
        self.assertEqual(done.returncode, 2)

    def test_a_packet_fills_every_span_that_it_is_in(self):
        # One sender never stops: nine seconds from 0.5 s on, then one more.
        load = plot_network.airtime_per_time(
            np.arange(0.0, 12.0, 2.0), np.array([0.5, 9.5]), np.array([9.0, 0.5])
        )
        np.testing.assert_allclose(load, [0.75, 1.0, 1.0, 1.0, 1.0])
        half = plot_network.airtime_per_time(
            np.array([0.0, 4.0]), np.array([1.0, 2.0]), np.array([1.0, 1.0]), np.array([0.5, 1.0])
        )
        np.testing.assert_allclose(half, [1.5 / 4.0])

    def test_age_is_the_sawtooth_of_the_deliveries(self):
        log = plot_network.Log(
            self.write(
                HEADER
                + row(0, 1, 0, 1.0, 3.0)
                + row(0, 1, 1, 0.5, 4.0)  # it is older than what the receiver knows
                + row(0, 1, 2, 5.0, 7.0)
                + row(0, 1, 3, 8.0, 10.0, "collision")
            )
        )
        (pieces,) = plot_network.age_segments(log)
        # The age 0 grows to 3. It falls to 2 (made at 1, received at 3) and grows to 6, then from 2 to 5 at
        # the end.
        np.testing.assert_allclose(pieces, [[0.0, 3.0], [2.0, 6.0], [2.0, 5.0]])
        share = plot_network.share_of_time(pieces, np.array([0.0, 2.0, 3.0, 6.0]))
        np.testing.assert_allclose(share, [0.0, 0.2, 0.5, 1.0])

    def test_transmissions_know_how_many_heard_them(self):
        log = plot_network.Log(
            self.write(
                HEADER
                + row(10, 2, 0, 1.0, 3.0)
                + row(10, 9, 0, 1.0, 3.0, "half_duplex")
                + row(9, 2, 0, 4.0, 6.0, "fading")
                + "9,2,all,data,,8,7,7,,,,,,,,,,,queue\n"
            )
        )
        self.assertEqual(log.nodes(), ["2", "9", "10"])
        self.assertEqual(
            sorted(log.transmissions()), [(1.0, 2.0, "10", 0.5), (4.0, 5.0, "9", 0.0)]
        )

    def test_draws_with_and_without_a_summary(self):
        self.write(HEADER + "".join(row(0, 1, k, 5.0 * k, 5.0 * k + 2.0) for k in range(9)))
        picture = os.path.join(self.folder.name, "network.png")
        result = self.run_script()
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.strip(), picture)
        with open(picture, "rb") as file:
            self.assertEqual(file.read(4), b"\x89PNG")
        with open(os.path.join(self.folder.name, "summary.json"), "w", encoding="utf-8") as file:
            file.write('{"energy_j": {"0": 2.0, "1": 1.0}}')
        result = self.run_script("--out", picture + ".svg", "--window", "0", "10")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_network_that_never_sends_is_drawn(self):
        self.write(HEADER + "9,2,all,data,,8,7,7,,,,,,,,,,,queue\n")
        result = self.run_script()
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_refuses_what_is_no_log(self):
        for text, message in (
            ("", "no column"),
            (HEADER, "no packets"),
            ("a,b\n1,2\n", "no column source"),
            (HEADER + row(0, 1, 0, 1.0, 3.0).replace("1500", "far"), "packets.csv:2: distance_m"),
            (HEADER + row(0, 1, 0, 1.0, 3.0).replace("1500", ""), "packets.csv:2: distance_m"),
            (HEADER + 2 * row(0, 1, 0, 1.0, 3.0)[:-30], "packets.csv:2: "),
            (HEADER + "9,2,all,data,,8,,7,,,,,,,,,,,queue\n", "packets.csv:2: offered_s"),
            (HEADER + "9,2\n", "packets.csv:2: 2 cells"),
        ):
            self.write(text)
            result = self.run_script()
            self.assertEqual(result.returncode, 2, text)
            self.assertIn(message, result.stderr)
            self.assertRegex(result.stderr, r"^plot_network: [^\n]*\n$")
        os.remove(os.path.join(self.folder.name, "packets.csv"))
        os.mkfifo(os.path.join(self.folder.name, "packets.csv"))
        self.assertEqual(self.run_script().returncode, 2)
        os.remove(os.path.join(self.folder.name, "packets.csv"))
        self.assertEqual(self.run_script().returncode, 2)
        self.assertEqual(self.run_script("--window", "5", "1").returncode, 2)

    def test_refuses_a_damaged_summary(self):
        self.write(HEADER + row(0, 1, 0, 1.0, 3.0))
        path = os.path.join(self.folder.name, "summary.json")
        for text, message in (
            ("[]", "summary.json: is not an object"),
            ("{", "summary.json:1: is not JSON"),
            ("[" * 99999, "summary.json: is nested"),
            ('{"energy_j": [2.0]}', "energy_j: is not an object"),
            ('{"energy_j": {"0": "much"}}', "0: is not a finite number"),
            ('{"model": "physical"}', "access: missing"),
            ('{"model": "m", "access": "a", "transmitted": null}', "transmitted: is not"),
        ):
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            with self.assertRaises(plot_network.Damaged) as caught:
                plot_network.read_summary(path)
            self.assertIn(message, str(caught.exception))
        result = self.run_script()
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"^plot_network: [^\n]*summary.json: transmitted[^\n]*\n$")

    def test_helps_where_nothing_can_draw(self):
        program = "import runpy, sys; sys.modules['matplotlib'] = None; sys.argv[1:] = ['--help']; "
        result = subprocess.run(
            [sys.executable, "-c", program + f"runpy.run_path({SCRIPT!r}, run_name='__main__')"],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, check=False,
        )  # fmt: skip
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assertIn("usage:", result.stdout)


if __name__ == "__main__":
    unittest.main()
