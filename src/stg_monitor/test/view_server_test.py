#!/usr/bin/python3
"""A browser that comes late is sent the tracks from the start, then what comes; no other site is."""

import asyncio
import time
import unittest

import aiohttp
import auv_msgs.msg
import rospy
import rostest
from geometry_msgs.msg import Point, Pose

from stg_view.recording import MAGIC, messages

URL, BEFORE, AFTER = "http://127.0.0.1:8317", 20, 10
DEADLINE_S = 30.0


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
            state = auv_msgs.msg.SwarmState(episode=3, step=cls.t, seed=8)
            state.header.stamp = rospy.Time(10 + cls.t)
            pose = Pose()
            pose.position.x, pose.orientation.w = float(cls.t), 1.0
            state.poses, state.target_positions, state.fresh = [pose, pose], [Point()], [True, True]
            cls.states.publish(state)
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
