#!/usr/bin/python3
"""A browser that comes late is sent the tracks from the start, then what comes; no other site is."""

import asyncio
import collections
import io
import time
import unittest

import aiohttp
import auv_msgs.msg
import rospy
import rostest
from geometry_msgs.msg import Point, Pose

from stg_view.listening import Ears
from stg_view.recording import MAGIC, messages

URL, BEFORE, AFTER = "http://127.0.0.1:8317", 20, 10
DEADLINE_S = 30.0


def state_at(t):
    """A state of two AUVs."""
    state = auv_msgs.msg.SwarmState(episode=3, step=t, seed=8)
    state.header.stamp = rospy.Time(10 + t)
    pose = Pose()
    pose.position.x, pose.orientation.w = float(t), 1.0
    state.poses, state.target_positions, state.fresh = [pose, pose], [Point()], [True, True]
    return state


def raw(message):
    """The message as a subscriber of rospy.AnyMsg gets it."""
    data = io.BytesIO()
    message.serialize(data)
    return rospy.AnyMsg().deserialize(data.getvalue())


class ViewServerTest(unittest.TestCase):
    """Publishes states and listens to the websocket."""

    @classmethod
    def setUpClass(cls):
        cls.states = rospy.Publisher("/swarm_state", auv_msgs.msg.SwarmState, queue_size=100)
        end = time.monotonic() + DEADLINE_S
        while cls.states.get_num_connections() == 0 and time.monotonic() < end:
            time.sleep(0.05)
        cls.t = 0
        cls.publish(BEFORE)

    @classmethod
    def publish(cls, count):
        """Publishes so many states, slower than the server's rate."""
        for _ in range(count):
            cls.states.publish(state_at(cls.t))
            cls.t += 1
            time.sleep(0.05)

    async def steps_until(self, wanted, during=None):
        """Times of all steps that a new browser is sent until there are as many as wanted, and all kinds."""
        found, kinds = [], []
        async with aiohttp.ClientSession() as session, session.ws_connect(f"{URL}/stream") as socket:
            if during:
                asyncio.get_running_loop().run_in_executor(None, during)
            while len(found) < wanted:
                message = await asyncio.wait_for(socket.receive(), DEADLINE_S)
                for header, columns in messages(MAGIC + message.data):
                    kinds.append(header["kind"])
                    if header["kind"] == "steps":
                        found += columns["t"].ravel().tolist()
        return found, kinds

    def test_late_browser_sees_the_start_then_what_comes(self):
        found, kinds = asyncio.run(self.steps_until(self.t))
        self.assertEqual([10.0 + k for k in range(self.t)], found)
        self.assertIn("episode", kinds)
        before = self.t
        found, _ = asyncio.run(self.steps_until(before + AFTER, lambda: self.publish(AFTER)))
        self.assertEqual([10.0 + k for k in range(before + AFTER)], found)

    def test_a_step_shows_what_was_said_at_its_time(self):
        """One AUV already speaks of the next state, the other one answers late, and then not at all."""
        sent, timers = [], []
        ears = Ears(1e9, sent.append, lambda _, action: timers.append(action))
        ears.more = [None]  # somebody looks
        kept = {}
        for topic in ("/auv_0/task_state", "/auv_1/task_state"):
            kept[topic] = collections.deque()
            ears.answers[topic] = (auv_msgs.msg.TaskState, kept[topic])

        def say(i, t):
            task = auv_msgs.msg.TaskState(target_known=True, episode=3)
            task.header.stamp = rospy.Time(10 + t)
            task.target_position.x = 100.0 + t
            ears.hear_answer(kept[f"/auv_{i}/task_state"], raw(task))

        def estimates():
            steps = [columns for data in sent for header, columns in messages(MAGIC + data) if header["kind"] == "steps"]
            return [row[::3].tolist() for columns in steps for row in columns["estimate"]]

        say(1, 0)
        ears.hear_state(raw(state_at(0)))
        self.assertEqual([], estimates())  # AUV 0 has not answered
        say(0, 0)
        self.assertEqual([[100.0, 100.0]], estimates())
        say(0, 1)
        say(0, 2)
        ears.hear_state(raw(state_at(1)))
        self.assertEqual(1, len(estimates()))
        timers[-1]()  # AUV 1 does not answer in time: its last word counts
        self.assertEqual([101.0, 100.0], estimates()[1])
        say(1, 2)
        ears.hear_state(raw(state_at(2)))
        self.assertEqual([102.0, 102.0], estimates()[2])

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
