"""Reports of bags: the page has everything of a run. A damaged bag gives a page or one line."""

import contextlib
import io
import pathlib
import random
import tempfile
import unittest

import view_fixtures
import auv_msgs.msg
import genpy
import numpy as np
import rosbag
import std_msgs.msg
from geometry_msgs.msg import Point, Pose, Twist, Vector3, Wrench
from stg_common.files import FileError
from stg_common.loading import load_program
from stg_view.bag_reading import BagError
from stg_view.from_bag import Collector
from stg_view.raw_packets import packets_message
from stg_view.recording import MAGIC, Recording, messages

report = load_program(pathlib.Path(__file__).resolve().parents[1] / "scripts" / "report.py")
AGENTS, STEPS = 3, 40


def write_bag(path):
    """Writes a run of AUVs that do not move. Every third packet is lost."""
    with rosbag.Bag(str(path), "w", compression="lz4", chunk_threshold=8192) as bag:
        scenario = std_msgs.msg.String(view_fixtures.HOSTILE)
        bag.write("/scenario", scenario, genpy.Time(1))
        bag.write(f"/{view_fixtures.HOSTILE}", scenario, genpy.Time(1))
        for k in range(STEPS):
            t = genpy.Time.from_sec(1.0 + 0.1 * k)
            state = auv_msgs.msg.SwarmState(episode=0, step=k, seed=5)
            state.header.stamp, state.header.frame_id = t, view_fixtures.HOSTILE
            state.groundings, state.collisions = [0, int(k >= 20), 0], [0, 0, int(k >= 30)]
            state.target_positions = [Point(0.5, 0.0, -1.0)]
            for i in range(AGENTS):
                pose = Pose()
                pose.position.x, pose.orientation.w = float(i), 1.0
                state.poses.append(pose)
            state.twists, state.velocities = [Twist()] * AGENTS, [Vector3()] * AGENTS
            state.target_velocities, state.wrenches = [Vector3()], [Wrench()] * AGENTS
            state.fresh = [True] * AGENTS
            bag.write("/swarm_state", state, t)
            task = auv_msgs.msg.TaskState(episode=0, step=k, phase=3 if k >= 20 else 2, target_known=True)
            task.header.stamp, task.target_position = t, Point(0.6, 0.0, -1.0)
            task.target_covariance = [0.01, 0, 0, 0.01, 0, 0.01]
            # Recorded late; it belongs to its stamp.
            bag.write("/auv_1/task_state", task, t + genpy.Duration.from_sec(0.35))
            bag.write("/acoustic_channel/packets", packets_of(k, t), t)
        summary = auv_msgs.msg.EpisodeSummary(scenario=view_fixtures.HOSTILE, policy_id=view_fixtures.HOSTILE)
        bag.write("/episode_summary", summary, t)


def packets_of(k, t):
    """One packet that was sent, and one that never left."""
    found = auv_msgs.msg.PacketEvents()
    found.header.stamp = t
    common = {"source": k % AGENTS, "destination": -1, "sequence": k, "bytes": 32, "offered": t, "transmit": t, "arrival": t}
    for receiver in range(AGENTS):
        if receiver != k % AGENTS:
            lost = (k + receiver) % 3 == 0
            kind = {"kind": 4, "reason": 2} if lost else {"kind": 3, "reason": 0}
            found.events.append(auv_msgs.msg.PacketEvent(receiver=receiver, **kind, **common))
    common.update(sequence=4294967295, transmit=genpy.Time(0), arrival=genpy.Time(0))
    found.events.append(auv_msgs.msg.PacketEvent(receiver=-1, kind=4, reason=7, **common))
    return found


class BagPageTest(unittest.TestCase):
    """Each test has a folder with the bag."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.bag = pathlib.Path(folder.name) / "run.bag"
        self.page = self.bag.with_suffix(".html")
        write_bag(self.bag)

    def test_a_whole_bag_is_in_the_recording(self):
        with contextlib.redirect_stderr(io.StringIO()):
            data = report.read_any(str(self.bag), False, "x")
        found = {}
        for header, columns in messages(data):
            found.setdefault(header["kind"], []).append((header, columns))
        steps = found["steps"][0][1]
        self.assertEqual((STEPS, 3 * AGENTS), steps["position"].shape)
        self.assertEqual([2] * 20 + [3] * 20, steps["phase"][:, 1].tolist())
        aground = [[0, int(k == 20), 2 * int(k == 30)] for k in range(STEPS)]
        self.assertEqual(aground, steps["aground"].tolist())
        fates = found["packets"][0][1]["fate"].ravel().tolist()
        # A packet that never left is lost for every receiver.
        self.assertEqual(STEPS * (AGENTS - 1), fates.count(7))
        self.assertEqual(STEPS * (AGENTS - 1), fates.count(0) + fates.count(2))
        self.assertEqual(1, len(found["summary"]))

    def test_raw_packets_are_those_of_the_messages(self):
        raws, collector = [], Collector(Recording(agents=AGENTS))
        for k in range(STEPS):
            message, buffer = packets_of(k, genpy.Time.from_sec(1.0 + 0.1 * k)), io.BytesIO()
            message.header.frame_id = "world"
            message.events[0].airtime, message.events[1].sinr_db = 0.25, -3.5
            collector.take("/acoustic_channel/packets", message)
            message.serialize(buffer)
            raws.append(buffer.getvalue())
        wanted = collector.recording.packets.encoded()
        self.assertEqual(STEPS * 2 * (AGENTS - 1), len(next(messages(MAGIC + wanted))[1]["fate"]))
        found = dict(next(messages(MAGIC + packets_message(raws, AGENTS)))[1])
        for name, column in next(messages(MAGIC + wanted))[1].items():
            np.testing.assert_allclose(found[name], column, rtol=0, atol=1e-6, err_msg=name)
        self.assertEqual(b"", packets_message([], AGENTS))

    def test_hostile_text_of_a_bag_is_text_in_the_page(self):
        self.assertEqual(0, self.report())
        text = self.page.read_text()
        self.assertEqual(text.count("<img"), 0)
        self.assertNotIn("owned", text.partition("<script")[0])

    def test_an_auv_of_no_number_is_one_line(self):
        with rosbag.Bag(str(self.bag), "a") as bag:
            bag.write(f"/auv_{view_fixtures.HOSTILE[9:30]}/task_state", auv_msgs.msg.TaskState(), genpy.Time(9))
        with self.assertRaises(BagError) as refused:
            self.report()
        self.assertNotIn("\n", str(refused.exception))

    def report(self):
        """Returns the exit status of the program for the bag."""
        with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
            return report.main([str(self.bag), "--out", str(self.page)])

    def test_fifty_cuts_give_a_page_or_a_line(self):
        whole, rng, pages = self.bag.read_bytes(), random.Random(3), 0
        cut = self.bag.with_name("cut.bag")
        for k in range(50):
            cut.write_bytes(whole[: rng.randrange(len(whole))])
            said = io.StringIO()
            with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
                try:
                    arguments = [str(cut), "--out", str(self.page), *(["--salvage"] if k % 2 else [])]
                    status = report.main(arguments)
                except (BagError, FileError) as error:  # run_program prints such an error as one line
                    self.assertNotIn("\n", str(error))
                    status = 2
            if status == 0:
                pages += 1
                self.assertIn("Content-Security-Policy", self.page.read_text())
            self.page.unlink(missing_ok=True)
        self.assertGreater(pages, 0)


if __name__ == "__main__":
    unittest.main()
