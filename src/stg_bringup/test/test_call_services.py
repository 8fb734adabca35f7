"""Calls of services, many of them wrong, leave a graph as it was (scripts/bench/call_services)."""

import pathlib
import subprocess
import unittest

from auv_msgs.srv import LoadPolicyRequest, PingRequest, ResetRequest
from roscpp.srv import GetLoggersRequest

from stg_common.loading import load_program

ROOT = pathlib.Path(__file__).resolve().parents[3]
SCRIPT = ROOT / "scripts" / "bench" / "call_services"
CALLS = load_program(SCRIPT.parent / "service_calls.py")
VEHICLES = {10: (0.0, 0.0, 0.0), 20: (300.0, 400.0, 0.0)}


def pool(name, type_name):
    """Returns the calls to a service that does not run."""
    return CALLS.Pool(CALLS.Service(name, ("127.0.0.1", 1), type_name, ""), 0, ["/a.onnx"], VEHICLES)


def answer(to, **fields):
    """Returns the bytes of an answer."""
    return CALLS.bytes_of(to.service.types._response_class(**fields))


class Judge(unittest.TestCase):
    """Which answers are wrong."""

    def refused(self, to, kind, request, taken, data, why):
        with self.assertRaisesRegex(CALLS.WrongAnswer, why):
            to.judge(kind, request, taken, data)

    def test_a_refusal_needs_a_reason(self):
        load = pool("/load_policy", "auv_msgs/LoadPolicy")
        request = LoadPolicyRequest(path="x")
        good = answer(load, message="no such file", policy_id="idle")
        self.assertEqual(load.judge("changed", request, True, good), "refused")
        self.refused(load, "changed", request, True, answer(load, policy_id="idle"), "without a reason")
        self.refused(load, "changed", request, True, answer(load, message="no"), "no policy")
        self.refused(load, "valid", request, True, good, "is refused: no such file")
        self.refused(load, "valid", request, False, b"", "without an answer")
        self.assertEqual(load.judge("damaged", None, False, b""), "refused")

    def test_an_answer_is_of_its_type_and_text(self):
        load = pool("/load_policy", "auv_msgs/LoadPolicy")
        no_text = answer(load, message="no", policy_id="idle").replace(b"no", b"\xff\xff")
        self.refused(load, "damaged", None, True, no_text, "not an answer of this type")

    def test_a_range_is_that_of_the_vehicles(self):
        ping = pool("/ping", "auv_msgs/Ping")
        request = PingRequest(source=10, destination=20)
        good = answer(ping, success=True, range=500.3)
        self.assertEqual(ping.judge("valid", request, True, good), "done")
        far = answer(ping, success=True, range=510.0)
        self.refused(ping, "valid", request, True, far, "a range of 510.0 m")

    def test_episodes_only_increase_and_loggers_are_named(self):
        reset = pool("/reset", "auv_msgs/Reset")
        for episode in (3, 3, 4):
            data = answer(reset, success=True, episode=episode)
            self.assertEqual(reset.judge("valid", ResetRequest(), True, data), "done")
        back = answer(reset, success=True, episode=2)
        self.refused(reset, "valid", ResetRequest(), True, back, "episode 2 after 4")
        loggers = pool("/get_loggers", "roscpp/GetLoggers")
        self.refused(loggers, "valid", GetLoggersRequest(), True, answer(loggers), "'ros' is missing")


class Graphs(unittest.TestCase):
    """A few thousand calls of each graph."""

    def check(self, graph, clients):
        run = subprocess.run([str(SCRIPT), "--graph", graph, "--calls", "8000", "--clients", clients],
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                             check=False)
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertRegex(run.stdout, r"load_policy changed|ping changed")
        self.assertEqual(run.stdout.splitlines()[-1], "as it was")

    def test_medium(self):
        self.check("medium", "4")

    def test_channel(self):
        self.check("channel", "8")


if __name__ == "__main__":
    unittest.main()
