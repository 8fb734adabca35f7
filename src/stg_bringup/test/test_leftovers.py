"""Parameters that earlier launches left on a long-lived master change nothing."""

import json
import os
import pathlib
import subprocess
import tempfile
import time
import unittest

import rosgraph


from run_launcher import free_port, launch, stop

SHORT = ("episodes:=1", "real_time_factor:=0", "deadline:=20", "seed:=3", "policy:=pursuit_separated",
         "table:=false", "overrides:=[time.episode_steps=60, time.tail_steps=20]")
# channel.launch, a recorded run or a user's rosparam leaves them like this.
LEFT = {
    "/acoustic_channel/overrides": ["channel.extended.loss_probability=0.9"],
    "/acoustic_channel/seed": 5,
    "/world/wait_for_node": "/no_node",
    "/world/start_timeout": 60.0,
    "/metrics/scenario": "hard",
    "/auv_0/overrides": ["sensing.noise_std_m=0.5"],
    "/auv_0/agent/overrides": ["sensing.noise_std_m=0.5"],
    "/auv_1/controller/scenario": "hard",
    "/autopilot": "onboard",
    "/summary_timeout": -1.0,
    "/start_timeout": 0.0,
    "/use_sim_time": False,
}


class Leftovers(unittest.TestCase):
    """Two runs on one master."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.port = free_port()
        uri = f"http://127.0.0.1:{self.port}"
        environment = dict(os.environ, ROS_MASTER_URI=uri, ROS_IP="127.0.0.1",
                           ROS_HOME=str(self.folder / "core"))
        core = subprocess.Popen(["roscore", "-p", str(self.port)], env=environment,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(stop, core)
        self.master = rosgraph.Master("/test_leftovers", master_uri=uri)
        end = time.monotonic() + 30.0
        while not self.master.is_online():
            self.assertLess(time.monotonic(), end, "no master")
            time.sleep(0.1)

    def run_once(self, name):
        """Runs once; returns the summary of the run."""
        process, _ = launch(self.folder, "medium.launch", *SHORT, f"summary_file:={name}.json",
                            port=self.port)
        self.addCleanup(stop, process)
        output = process.communicate(timeout=120)[0]
        self.assertEqual(process.returncode, 0, output)
        return json.loads((self.folder / f"{name}.json").read_text())

    def test_they_change_no_result(self):
        clean = self.run_once("clean")
        for name, value in LEFT.items():
            self.master.setParam(name, value)
        left = self.run_once("left")
        self.assertEqual(left, clean)


if __name__ == "__main__":
    unittest.main()
