#!/usr/bin/python3
"""A bag gives the same packet log, whichever program plays it to the channel."""

import csv
import math
import os
import pathlib
import random
import resource
import signal
import subprocess
import tempfile
import unittest

import rosbag
import roslib.packages
import rospy
import rostest
from auv_msgs.msg import AcousticPacket
from nav_msgs.msg import Odometry


from fleet_world import Diagnostics, wait_for

NAMES = ("alpha", "beta", "gamma")
START_S, DURATION_S = 1000.0, 30.0


def odometry(k, t):
    """Returns the odometry of vehicle k on a circle of 300 m; its stamp is rounded to a hundredth."""
    message = Odometry(child_frame_id=f"{NAMES[k]}/base_link")
    message.header.stamp = rospy.Time.from_sec(round(t, 2))
    message.header.frame_id = "world"
    angle = 0.01 * t + 2.0 * math.pi * k / len(NAMES)
    message.pose.pose.position.x = 300.0 * math.cos(angle)
    message.pose.pose.position.y = 300.0 * math.sin(angle)
    message.pose.pose.position.z = -30.0
    heading = angle + math.pi / 2.0
    message.pose.pose.orientation.z = math.sin(heading / 2.0)
    message.pose.pose.orientation.w = math.cos(heading / 2.0)
    message.twist.twist.linear.x = 3.0
    return message


def write_bag(path):
    """Writes odometry that jitters and packets of three vehicles; gamma joins late and falls silent.

    Returns how many messages there are of each kind.
    """
    draw = random.Random(5)
    messages = []
    for k, name in enumerate(NAMES):
        for tick in range(int(DURATION_S * 10)):
            t = START_S + 0.1 * tick + draw.uniform(0.0, 0.05)
            there = k < 2 or 5.0 < t - START_S < 12.0 or t - START_S > 20.0
            if there:
                messages.append((t, f"/{name}/odom", odometry(k, t)))
        for number in range(int(DURATION_S)):
            t = START_S + number + draw.uniform(0.0, 0.9)
            packet = AcousticPacket(sequence=number, data=bytes([k, number] * draw.randint(1, 16)))
            packet.destination = draw.choice((-1, (k + 1) % 3))
            packet.header.stamp = rospy.Time.from_sec(t)
            messages.append((t, f"/{name}/acoustic/tx", packet))
    with rosbag.Bag(str(path), "w") as bag:
        for t, topic, message in sorted(messages, key=lambda m: m[0]):
            bag.write(topic, message, rospy.Time.from_sec(t))
    packets = sum(topic.endswith("tx") for _, topic, _ in messages)
    return len(messages) - packets, packets


class BagReplay(unittest.TestCase):
    """One bag and four ways to play it to the channel."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.bag = pathlib.Path(cls.folder.name) / "fleet.bag"
        cls.odometry, cls.packets = write_bag(cls.bag)
        cls.diagnostics = Diagnostics()
        (cls.channel,) = roslib.packages.find_node("acoustic_channel", "fleet")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def run_channel(self, name, popen=None, **parameters):
        """Starts the channel alone; returns the process and its packet log."""
        log = pathlib.Path(self.folder.name) / f"{name}.csv"
        config = pathlib.Path(roslib.packages.get_pkg_dir("acoustic_channel")) / "config"
        private = {
            "vehicles": " ".join(NAMES), "config": str(config / "channel.yaml"), "seed": 7,
            "lag": 0.5,
            "packet_log": str(log), **parameters}
        rospy.set_param("/acoustic_channel", private)
        command = [self.channel, "__name:=acoustic_channel", f"__log:={log}.log"]
        return subprocess.Popen(command, **(popen or {})), log

    def end_of(self, name, popen=None, **parameters):
        """Returns (exit status, output) of a channel that reads a bag."""
        process, _ = self.run_channel(
            name, {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, **(popen or {})},
            **{"bag": str(self.bag), **parameters})
        output = process.communicate(timeout=60.0)[0].decode(errors="replace")
        return process.returncode, output

    def test_a_log_that_does_not_fit_on_the_disk_is_told(self):
        def little_room():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # this makes a write fail instead
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        status, output = self.end_of("full", {"preexec_fn": little_room})
        self.assertEqual(status, 4, output)
        self.assertRegex(output, "packets are missing in .*/full.csv")

    def test_nothing_is_emptied_before_the_bag_is_known_to_be_there(self):
        log = pathlib.Path(self.folder.name) / "before.csv"
        log.write_text("of an earlier run\n")
        status, output = self.end_of("before", bag="/nonexistent.bag")
        self.assertEqual(status, 2, output)
        self.assertEqual(log.read_text(), "of an earlier run\n")
        bag = self.bag.read_bytes()
        link = pathlib.Path(self.folder.name) / "link.bag"
        link.symlink_to(self.bag)
        for same in (self.bag, link):
            status, output = self.end_of("same", packet_log=str(same))
            self.assertEqual(status, 2, output)
            self.assertIn("is the bag of the parameter bag", output)
        self.assertEqual(self.bag.read_bytes(), bag)

    def test_a_pipe_is_neither_log_nor_bag(self):
        pipe = pathlib.Path(self.folder.name) / "pipe"
        os.mkfifo(pipe)
        for name in ("packet_log", "bag"):
            status, output = self.end_of("piped", **{name: str(pipe)})
            self.assertEqual(status, 2, output)
            self.assertRegex(output, f"parameter {name}: .*/pipe: not a regular file")

    def test_a_damaged_bag_is_named(self):
        whole = self.bag.read_bytes()
        frame = b"\x05\x00\x00\x00world"
        self.assertGreater(whole.count(frame), 100)
        at = whole.index(frame, len(whole) // 2)
        damaged = pathlib.Path(self.folder.name) / "damaged.bag"
        for content in (whole[:len(whole) // 2],
                        whole[:at] + b"\xff\xff\xff\x0fworld" + whole[at + len(frame):]):
            damaged.write_bytes(content)
            status, output = self.end_of("damaged", bag=str(damaged))
            self.assertEqual(status, 2, output)
            self.assertIn(f"parameter bag: {damaged}: ", output)

    def test_an_index_that_leaves_the_bag_is_not_followed(self):
        # rosbag reads wherever the index points.
        whole = bytearray(self.bag.read_bytes())
        damaged = pathlib.Path(self.folder.name) / "index.bag"
        operation = whole.index(b"op=\x04")
        field_length = operation + len("op=") + 1
        count = whole.index(b"count=", operation) + len("count=")
        entry_offset = count + 4 + 4 + 8  # it comes after the count, the length of the data and a time
        for place, value, reason in (
                (entry_offset, b"\xff\xff\xff\x0f", "an index entry points at no message"),
                (count, b"\xff\xff\x00\x00", "another size than stated"),
                (field_length, b"\x00\x00\x0f\x00", "a field reaches past the end of its header")):
            content = bytes(whole[:place]) + value + bytes(whole[place + len(value):])
            damaged.write_bytes(content)
            status, output = self.end_of("index", bag=str(damaged))
            self.assertEqual(status, 2, output)
            self.assertRegex(output, f"parameter bag: {damaged}: damaged at byte .*{reason}")

    def replayed_by_the_channel(self, name):
        """Returns the log of the channel that reads the bag itself."""
        process, log = self.run_channel(name, bag=str(self.bag))
        self.assertEqual(process.wait(60.0), 0)
        return log.read_text()

    def replayed_by_rosbag(self, name):
        """Returns the log of the channel while rosbag plays."""
        process, log = self.run_channel(name)
        self.diagnostics.values = {}
        try:
            subprocess.run(["rosbag", "play", "--clock", "--rate=4", "--quiet",
                            "--wait-for-subscribers", str(self.bag)], check=True, timeout=120.0,
                           stdout=subprocess.DEVNULL, env=os.environ)
            # The channel takes gamma's packets, too, and refuses them only when their time has come.
            wait_for(lambda: self.diagnostics.number("odometry taken") == self.odometry
                     and self.diagnostics.number("packets taken") == self.packets, 30.0,
                     "everything taken")
        finally:
            process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(30.0), 0)
        return log.read_text()

    def test_the_packet_log_is_always_the_same(self):
        first = self.replayed_by_the_channel("first")
        rows = list(csv.DictReader(first.splitlines()))
        fates = {row["fate"] for row in rows}
        self.assertGreater(len(rows), 80)
        self.assertIn("delivered", fates)
        self.assertGreater(len(fates), 1, "losses take part")
        heard_by_gamma = [float(row["arrival_s"]) - START_S for row in rows
                          if row["destination"] == "2" and row["fate"] == "delivered"]
        self.assertTrue(any(5.0 < t < 15.0 for t in heard_by_gamma))
        self.assertTrue(any(t > 20.0 for t in heard_by_gamma))
        self.assertFalse(any(t < 5.0 or 15.5 < t < 20.0 for t in heard_by_gamma))
        self.assertEqual(self.replayed_by_the_channel("second"), first)
        self.assertEqual(self.replayed_by_rosbag("third"), first)
        self.assertEqual(self.replayed_by_rosbag("fourth"), first)


if __name__ == "__main__":
    rospy.init_node("bag_replay_test")
    rostest.rosrun("acoustic_channel", "bag_replay", BagReplay)
