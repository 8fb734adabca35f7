"""Shared by the tests of running nodes: waiting, and the newest message of each topic."""

import os
import signal

import rosgraph
import rosnode
import rospy
from auv_msgs.msg import EpisodeSummary
from diagnostic_msgs.msg import DiagnosticArray


from stg_common.waiting import wait_for


class Latest:
    """Keeps the newest message of a topic and counts them."""

    def __init__(self, topic, message_type):
        self.message, self.count, self.type = None, 0, message_type
        self._subscriber = rospy.Subscriber(topic, message_type, self._keep, queue_size=10)

    def _keep(self, message):
        self.message = message
        self.count += 1

    def wait(self, timeout_s=60.0):
        """Returns the newest message. Waits for the first one."""
        return wait_for(lambda: self.message, timeout_s, self._subscriber.name)

    def wait_for_more(self, number, timeout_s=60.0):
        """Waits for `number` further messages."""
        wanted = self.count + number
        wait_for(lambda: self.count >= wanted, timeout_s, f"more of {self._subscriber.name}")


class SummaryOf:
    """Keeps the summary of the episode of one seed."""

    def __init__(self, seed):
        self.message, self.seed = None, seed
        self._subscriber = rospy.Subscriber(
            "/episode_summary", EpisodeSummary, self._keep, queue_size=100
        )

    def _keep(self, message):
        if message.seed == self.seed:
            self.message = message

    def wait(self, timeout_s):
        """Waits for the summary and returns it."""
        return wait_for(lambda: self.message, timeout_s, f"summary of seed {self.seed}")


class Diagnostics:
    """The newest diagnostic values of each node, by the node's name."""

    def __init__(self):
        self.nodes = {}
        self._subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, self._keep)

    def _keep(self, array):
        for status in array.status:
            node = status.name.split(":")[0].strip().strip("/")
            values = {pair.key: pair.value for pair in status.values}
            self.nodes[node] = (status.level, status.message, values)

    def value(self, node, key):
        """Returns a number of a node's newest diagnostics, or None."""
        found = self.nodes.get(node)
        return float(found[2][key]) if found and key in found[2] else None


def rosnode_pid(node):
    """Asks a node for its process id over its own interface."""
    master = rosgraph.Master("/stg_test")
    proxy = rosnode.ServerProxy(master.lookupNode(node))
    return proxy.getPid("/stg_test")[2]


def kill(node, number=signal.SIGKILL):
    """Sends a signal to a node's process; returns its id."""
    pid = rosnode_pid(node)
    os.kill(pid, number)
    return pid


def wait_for_restart(node, old_pid, timeout_s=60.0):
    """Waits until a node runs as another process."""

    def restarted():
        try:
            return rosnode_pid(node) != old_pid
        except Exception:  # pylint: disable=broad-except
            return False  # between its two lives the node is unknown or unreachable

    wait_for(restarted, timeout_s, f"{node} comes back")
