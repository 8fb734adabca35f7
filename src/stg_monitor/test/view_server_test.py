#!/usr/bin/python3
"""A browser that comes late gets the tracks from the start, then what comes. No other site gets them."""

import asyncio
import io
import time
import unittest
import unittest.mock

import aiohttp
import auv_msgs.msg
import rosgraph
import rosnode
import rospy
import rostest
from geometry_msgs.msg import Point, Pose, Twist, Vector3, Wrench

from stg_view.listening import EARLY, UNSEEN_SHARE, Listener
from stg_view.recording import MAGIC, messages

URL, BEFORE, AFTER = "http://127.0.0.1:8317", 20, 10
DEADLINE_S = 30.0


def stamp_at(step):
    """The time of a step of `medium`."""
    return rospy.Time(10, 0) + rospy.Duration(0, 100_000_000 * step)


def state_at(step):
    """A state of two AUVs."""
    state = auv_msgs.msg.SwarmState(run=1, step=step, seed=8)
    state.header.stamp, state.header.frame_id = stamp_at(step), "world"
    pose = Pose()
    pose.position.x, pose.orientation.w = 0.001 * step, 1.0
    state.poses, state.twists, state.velocities = [pose] * 2, [Twist()] * 2, [Vector3()] * 2
    state.wrenches, state.fresh = [Wrench()] * 2, [True] * 2
    state.target_positions, state.target_velocities = [Point()], [Vector3()]
    return state


def task_at(step):
    """What an AUV believes at that step."""
    task = auv_msgs.msg.TaskState(target_known=True, step=step, policy_id="test", action=[0.0] * 3)
    task.header.stamp, task.header.frame_id, task.target_position.x = stamp_at(step), "world", 100.0 + step
    return task


def raw(message):
    """The message as a subscriber of rospy.AnyMsg gets it."""
    data = io.BytesIO()
    message.serialize(data)
    return rospy.AnyMsg().deserialize(data.getvalue())


def is_served():
    """Tells whether the server is connected to the metrics."""
    try:
        uri = rosgraph.Master("/view_server_test").lookupNode("/view_server")
    except rosgraph.MasterException:
        return False
    connections = rosnode.ServerProxy(uri).getBusInfo("/view_server_test")[2]
    return any(topic == "/swarm_display" and connected for *_, topic, connected in [c[:6] for c in connections])


class ViewServerTest(unittest.TestCase):
    """Plays a run, and reads the websocket."""

    @classmethod
    def setUpClass(cls):
        cls.states = rospy.Publisher("/swarm_state", auv_msgs.msg.SwarmState, queue_size=100)
        cls.tasks = [rospy.Publisher(f"/auv_{i}/task_state", auv_msgs.msg.TaskState, queue_size=100) for i in range(2)]
        own = [cls.states, *cls.tasks]
        end = time.monotonic() + DEADLINE_S
        while not (all(one.get_num_connections() for one in own) and is_served()) and time.monotonic() < end:
            time.sleep(0.05)
        cls.step = 0
        cls.publish(BEFORE)

    @classmethod
    def publish(cls, count, silent=None):
        """Publishes so many steps, more slowly than the server's rate. One AUV may be silent."""
        for _ in range(count):
            cls.states.publish(state_at(cls.step))
            for i, publisher in enumerate(cls.tasks):
                if i != silent:
                    publisher.publish(task_at(cls.step))
            cls.step += 1
            time.sleep(0.05)

    async def steps_until(self, wanted, during=None):
        """Returns the numbers and estimates (x of each AUV) of the steps that a new browser gets until it has
        `wanted` of them, and the kinds of all messages."""
        found, estimates, kinds = [], [], []
        async with aiohttp.ClientSession() as session, session.ws_connect(f"{URL}/stream") as socket:
            if during:
                asyncio.get_running_loop().run_in_executor(None, during)
            while len(found) < wanted:
                message = await asyncio.wait_for(socket.receive(), DEADLINE_S)
                for header, columns in messages(MAGIC + message.data):
                    kinds.append(header["kind"])
                    if header["kind"] == "steps":
                        found += [round((t - 10.0) / 0.1) for t in columns["t"].ravel().tolist()]
                        estimates += columns["estimate"].reshape(-1, 2, 3)[:, :, 0].tolist()
        return found, estimates, kinds

    def test_late_browser_sees_the_start_then_what_comes(self):
        found, estimates, kinds = asyncio.run(self.steps_until(self.step))
        self.assertEqual(list(range(self.step)), found)
        self.assertEqual([[100.0 + k] * 2 for k in found], estimates)
        self.assertIn("episode", kinds)
        before = self.step
        found, estimates, _ = asyncio.run(self.steps_until(before + AFTER, lambda: self.publish(AFTER)))
        self.assertEqual(list(range(before + AFTER)), found)
        self.assertEqual([[100.0 + k] * 2 for k in found], estimates)
        # The display does not wait for a silent AUV, whose last report stays.
        before = self.step
        found, estimates, _ = asyncio.run(self.steps_until(before + 5, lambda: self.publish(5, silent=1)))
        self.assertEqual(list(range(before + 5)), found)
        self.assertEqual([[100.0 + k, 99.0 + before] for k in found[before:]], estimates[before:])

    def test_a_detection_is_shown_once_and_not_before_its_time(self):
        sent = []
        listener = Listener(1e9, sent.append, lambda _, action: None, lambda: True)
        early = 1000  # a new subscriber gets the last messages of the metrics

        def show(step):
            display = auv_msgs.msg.SwarmDisplay(state=state_at(early + step))
            display.header = display.state.header
            listener.hear_display(raw(display))

        def detect(step):
            message = auv_msgs.msg.SwarmDetections(agents=[1], detections=[auv_msgs.msg.TargetDetection()])
            message.header.stamp = message.detections[0].header.stamp = stamp_at(early + step)
            listener.detections.append(raw(message))

        detect(1)
        detect(3)
        for step in (0, 2, 4, 6):
            show(step)
        rows = [columns for data in sent for header, columns in messages(MAGIC + data) if header["kind"] == "steps"]
        found = [c["detected"].ravel().tolist() for c in rows if c["t"].ravel()[0] > 100.0]
        self.assertEqual([[0, 0], [0, 1], [0, 1], [0, 0]], found)

    def test_packets_wait_for_one_timer_whatever_ends_meanwhile(self):
        timers = []
        listener = Listener(10.0, lambda data: None, lambda _, action: timers.append(action), lambda: False)
        for _ in range(3):
            listener.hear_packets(raw(auv_msgs.msg.PacketEvents()))
            listener.hear_summary(auv_msgs.msg.EpisodeSummary())  # it sends the packets, too
        self.assertEqual(1, len(timers))
        timers.pop()()
        listener.hear_packets(raw(auv_msgs.msg.PacketEvents()))
        self.assertEqual(1, len(timers))

    def test_without_a_browser_making_steps_costs_a_small_share_of_a_processor(self):
        browsers, clock, cost = [], unittest.mock.Mock(), 0.004
        clock.monotonic.return_value, clock.thread_time.return_value = 100.0, 0.0

        def work(_raw):
            clock.thread_time.return_value += cost

        def work_of_ten_seconds(listener):
            before = clock.thread_time()
            for _ in range(10_000):
                clock.monotonic.return_value += 0.001
                listener.hear_display(None)
            return clock.thread_time() - before

        with unittest.mock.patch("stg_view.listening.time", clock):
            listener = Listener(100.0, lambda data: None, lambda _, action: None, lambda: bool(browsers))
            listener.make_step = work
            work_of_ten_seconds(listener)
            self.assertAlmostEqual(10.0 * UNSEEN_SHARE / EARLY, work_of_ten_seconds(listener), delta=cost)
            browsers.append("one")
            self.assertAlmostEqual(10.0 * 100.0 / EARLY * cost, work_of_ten_seconds(listener), delta=0.1 * 10.0 * 100.0 * cost)

    def test_only_this_machine_is_answered(self):
        async def status(**headers):
            async with aiohttp.ClientSession() as session, session.get(URL, headers=headers) as answer:
                return answer.status, await answer.text()

        code, text = asyncio.run(status())
        self.assertEqual(200, code)
        self.assertIn("Content-Security-Policy", text)
        self.assertEqual(403, asyncio.run(status(Host="evil.example"))[0])
        self.assertEqual(403, asyncio.run(status(Origin="http://evil.example"))[0])


if __name__ == "__main__":
    rospy.init_node("view_server_test")
    rostest.rosrun("stg_monitor", "view_server_test", ViewServerTest)
