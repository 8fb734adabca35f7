#!/usr/bin/python3
"""No message can kill, blind or silence a node: mutations of every message on every topic."""

import contextlib
import io
import json
import pathlib
import random
import re
import socket
import struct
import unittest
import urllib.parse

import rosgraph
import roslib.message
import rosservice
import rospy
import rostest
from auv_msgs.msg import AcousticReception, EpisodeSummary, StepReport, SwarmState, TaskState
from auv_msgs.srv import LoadPolicyResponse
from graph_listener import Diagnostics, Latest, rosnode_pid, wait_for
from mutations import mutated, stamped
from roscpp.srv import GetLoggers
from std_msgs.msg import Header
from stg_common.loading import load_program

ROOT = pathlib.Path(__file__).resolve().parents[3]
CALLS = load_program(ROOT / "scripts" / "bench" / "service_calls.py")
MUTATIONS = 60  # of each topic
FLOOD = 300_000  # messages
FAR_FUTURE = (2.0**31 + 2.0, 2.0**32 - 0.05)  # [s]
NOT_OURS = ("/rosout", "/mutations_test", "/recorder")
KINDS = ("world", "acoustic_channel", "metrics", "auv_0/agent", "auv_0/controller")  # a node of each


def changed_bytes(message_type, change):
    """Returns a message type of the same name whose messages are changed on their way."""

    class Changed(message_type):
        """The same message with other bytes."""

        def serialize(self, buff):
            plain = io.BytesIO()
            super().serialize(plain)
            buff.write(change(plain.getvalue()))

    return Changed


def copied(message, message_type):
    """Returns a message of another type with the same fields, whose values it copies."""
    base = type(message)
    return message_type(**{name: getattr(message, name) for name in base.__slots__})


class Tap:
    """A topic as a stranger sees it: the newest message, and a way to send others."""

    def __init__(self, topic, type_name):
        message_type = roslib.message.get_message_class(type_name)
        self.topic = topic
        self.latest = Latest(topic, message_type)
        self.publisher = rospy.Publisher(topic, message_type, queue_size=1000)

    def message(self):
        """Returns the newest message, or an empty one if there is none."""
        return self.latest.message or self.latest.type()

    def send(self, messages):
        """Sends messages one after the other, slowly enough for a queue of 20."""
        for message in messages:
            self.publisher.publish(message)
            rospy.rostime.wallsleep(0.002)


class Mutations(unittest.TestCase):
    """Short episodes without end. Each test leaves all nodes at work."""

    @classmethod
    def setUpClass(cls):
        cls.diagnostics = Diagnostics()
        cls.task = Latest("/auv_0/task_state", TaskState)
        cls.reception = Latest("/auv_0/acoustic/rx", AcousticReception)
        cls.report = Latest("/step_report", StepReport)
        cls.summary = Latest("/episode_summary", EpisodeSummary)
        cls.task.wait(30.0)
        cls.summary.wait(30.0)
        master = rosgraph.Master("/mutations_test")
        _, subscribers, _ = master.getSystemState()
        types = dict(master.getTopicTypes())
        ours = {}
        for topic, nodes in subscribers:
            heard_by = [node for node in nodes if node not in NOT_OURS]
            if heard_by and topic in types:
                ours[topic] = heard_by
        cls.nodes = sorted({node for nodes in ours.values() for node in nodes})
        cls.pids = {node: rosnode_pid(node) for node in cls.nodes}
        cls.taps = [Tap(topic, types[topic]) for topic in sorted(ours)]
        wait_for(lambda: all(tap.publisher.get_num_connections() > 0 for tap in cls.taps),
                 20.0, "every node hears this test")

    def check_all_is_well(self):
        """All nodes are alive, and whole episodes are flown with all that belongs to them."""
        self.report.wait_for_more(20)
        self.reception.wait_for_more(20)
        self.assertEqual({node: rosnode_pid(node) for node in self.nodes}, self.pids)
        wait_for(lambda: len(self.task.message.neighbours) == 3, 60.0, "neighbours are heard")
        # The episode that ends first may have begun during the disturbance.
        self.summary.wait_for_more(2, 120.0)
        wait_for(lambda: self.summary.message.complete, 120.0, "a complete episode")

    def test_1_the_test_hears_of_the_topics_that_matter(self):
        topics = {tap.topic for tap in self.taps}
        self.assertLessEqual(
            {"/swarm_state", "/auv_0/sensor_frame", "/auv_0/wrench", "/auv_0/acoustic/tx",
             "/auv_0/acoustic/rx", "/auv_0/odom", "/auv_0/cmd_vel", "/auv_0/task_state",
             "/acoustic_channel/done", "/acoustic_channel/links", "/episode_summary"}, topics)
        self.assertLessEqual({"/world", "/acoustic_channel", "/metrics", "/auv_3/agent",
                              "/auv_3/controller"}, set(self.nodes))

    def test_2_stamps_from_the_far_future_end_nobody(self):
        for tap in self.taps:
            for seconds in FAR_FUTURE:
                message = stamped(tap.message(), seconds)
                tap.send([message, message])
        rospy.rostime.wallsleep(2.5)  # diagnostics are made once a second
        self.check_all_is_well()

    def test_3_a_minute_ahead_nobody_is_silenced(self):
        for tap in self.taps:
            now = self.task.message.header.stamp.to_sec()
            tap.send(stamped(tap.message(), now + 58.0 + k / 10) for k in range(2))
        self.check_all_is_well()

    def test_4_many_future_detections_and_receptions_do_not_blind_or_deafen(self):
        for tap in self.taps:
            if tap.topic not in ("/auv_0/sensor_frame", "/auv_0/acoustic/rx"):
                continue
            for ahead in (8.0, 1e6):
                def future(tap=tap, ahead=ahead):
                    message = tap.message()
                    now = message.header.stamp.to_sec()
                    if tap.topic.endswith("rx"):
                        return stamped(message, now + ahead)
                    header = message.header
                    message = stamped(message, now + ahead)
                    message.detections = (message.detections * 150)[:150]
                    message.header = header
                    return message
                tap.send(future() for _ in range(150))
        self.check_all_is_well()
        wait_for(lambda: self.task.message.target_known, 20.0, "the target is seen")

    def test_5_mutations_of_every_message_end_nobody_and_are_counted(self):
        source = random.Random(14)
        before = self.refusals()
        for tap in self.taps:
            tap.send(mutated(tap.message(), source) for _ in range(MUTATIONS))
        self.check_all_is_well()
        for node, count in before.items():
            wait_for(lambda node=node, count=count: self.refusals()[node] > count, 10.0,
                     f"{node} counts what it refuses")

    def test_6_counts_of_elements_take_no_memory(self):
        # roscpp takes memory for as many poses as a message claims to have.
        size = len(SwarmState(header=Header(frame_id="world")).header.frame_id) + 40
        swarm = Tap("/swarm_state", "auv_msgs/SwarmState")
        message = swarm.latest.wait()
        publisher = rospy.Publisher("/swarm_state", changed_bytes(
            SwarmState, lambda data: data[:size] + b"\xff\xff\xff\x0f" + data[size + 4:]),
            queue_size=10)
        wait_for(lambda: publisher.get_num_connections() >= 2, 20.0, "channel and metrics hear")
        for _ in range(5):
            publisher.publish(copied(message, publisher.data_class))
            rospy.rostime.wallsleep(0.05)
        publisher.unregister()
        self.check_all_is_well()
        for node in ("/acoustic_channel", "/metrics"):
            status = pathlib.Path(f"/proc/{self.pids[node]}/status").read_text(encoding="utf-8")
            peak_kb = int(re.search(r"VmHWM:\s*(\d+)", status).group(1))
            self.assertLess(peak_kb, 2**21, f"{node} had more than 2 GiB")

    def test_7_text_that_is_no_utf8_gets_into_no_file(self):
        summaries = pathlib.Path(rospy.get_param("/metrics/summary_file"))
        self.addCleanup(summaries.unlink)
        before = self.diagnostics.value("metrics", "refused task_state: malformed")
        publisher = rospy.Publisher("/auv_0/task_state", changed_bytes(
            TaskState, lambda data: data.replace(b"pursuit", b"\xff\xfe\xc0suit")), queue_size=10)
        wait_for(lambda: publisher.get_num_connections() > 0, 20.0, "metrics hear")

        def sent_and_refused():
            publisher.publish(copied(self.task.message, publisher.data_class))
            return self.diagnostics.value("metrics", "refused task_state: malformed") > before

        wait_for(sent_and_refused, 20.0, "the metrics refuse it")
        publisher.unregister()
        self.check_all_is_well()
        for line in summaries.read_bytes().splitlines():
            self.assertIn("episode", json.loads(line.decode()))

    def test_8_a_flood_takes_no_memory(self):
        # The test sends pieces of a thousand messages, as fast as the sockets take them.
        tap = next(tap for tap in self.taps if tap.topic == "/auv_0/task_state")
        buffer = io.BytesIO()
        tap.message().serialize(buffer)
        piece = (struct.pack("<I", len(buffer.getvalue())) + buffer.getvalue()) * 1000
        before = self.resident_kb("/metrics")
        for _ in range(FLOOD // 1000):
            for connection in tap.publisher.impl.connections:
                connection.write_data(piece)
        grown = self.resident_kb("/metrics") - before
        self.check_all_is_well()
        self.assertLess(grown, 70 * 1024, "the metrics keep what they cannot handle yet")

    def test_9_nobody_dies_of_questions_about_loggers_or_of_peers_that_claim_memory(self):
        for node in KINDS:
            # rosconsole's own answer would end a node at the next one, or at its next message.
            for _ in range(3):
                loggers = rospy.ServiceProxy(f"/{node}/get_loggers", GetLoggers)().loggers
                self.assertIn("ros", [logger.name for logger in loggers])
            address = urllib.parse.urlparse(rosservice.get_service_uri(f"/{node}/get_loggers"))
            with contextlib.ExitStack() as peers:
                # The header of a connection, of 900 MB; a node may use 2 GiB.
                for _ in range(4):
                    peer = socket.create_connection((address.hostname, address.port), 20.0)
                    peers.enter_context(peer).sendall(struct.pack("<I", 900_000_000) + b"x")
                    rospy.rostime.wallsleep(0.1)
                rospy.ServiceProxy(f"/{node}/get_loggers", GetLoggers)()
        self.check_all_is_well()

    def test_10_a_path_that_is_no_text_is_refused_and_not_repeated(self):
        master = rosgraph.Master("/mutations_test")
        (service,) = [s for s in CALLS.services_of(master) if s.name == "/auv_0/agent/load_policy"]
        connection = CALLS.Connection(service)
        self.addCleanup(connection.close)
        for path in (b"pursu\xff", b"idle\x00", b"a\x1b[2Jb.onnx"):
            taken, data = connection.call(struct.pack("<I", len(path)) + path)
            answer = LoadPolicyResponse().deserialize(data)
            self.assertTrue(taken)
            self.assertFalse(answer.success)
            self.assertEqual(answer.message, "policy: must be UTF-8 without control characters")
            self.assertEqual(answer.policy_id, "pursuit_separated")

    def resident_kb(self, node):
        """Returns the resident memory of a node."""
        status = pathlib.Path(f"/proc/{self.pids[node]}/status").read_text(encoding="utf-8")
        return int(re.search(r"VmRSS:\s*(\d+)", status).group(1))

    def refusals(self):
        """Returns how many messages each node says it has refused."""
        wait_for(lambda: all(name in self.diagnostics.nodes for name in KINDS), 20.0, "diagnostics")
        return {
            name: sum(float(value) for key, value in self.diagnostics.nodes[name][2].items()
                      if "refused" in key)
            for name in KINDS
        }


if __name__ == "__main__":
    rospy.init_node("mutations_test")
    rostest.rosrun("stg_bringup", "mutations", Mutations)
