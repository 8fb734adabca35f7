#!/usr/bin/python3
"""Opens rviz with a shipped view whose camera fits the scenario.

The views are written for the paper's box of two metres. The scenario that runs, or is replayed,
says how large the region is and how far AUVs stay from their target, and the camera's distances
follow. Everything else is the view as shipped.
"""

import stg_common.quiet_start  # first: until here Ctrl-C is blocked, see view.launch
import argparse
import os
import pathlib
import signal
import subprocess
import tempfile
import threading

import rospkg
import rospy
import std_msgs.msg
import yaml

import stg_common.program
from stg_common.yaml_files import parse_yaml, read_yaml
from stg_view.scenario_reading import sections_of

ON_LOOPBACK = "libauv_common_nodes.so"  # lets rviz's XML-RPC listen where ROS_IP says
WAIT_S = 15.0  # of wall time for a scenario to appear
HALF_EXTENT_M, RADIUS_M = 1.0, 0.011  # of the scenario that the views are written for
BANDS_AWAY = 26.0  # factor of the close-up's camera for each metre of the tracking band


def camera_scale(view, scenario):
    """Returns how many times farther away than in the shipped view the camera has to be."""

    def number(section, key, fallback):
        value = scenario[section].get(key)
        return float(value) if isinstance(value, (int, float)) and value > 0 else fallback

    if view == "overview":
        return number("workspace", "half_extent_m", HALF_EXTENT_M) / HALF_EXTENT_M
    # In the box the close-up shows hulls, in open water the band around the target.
    hulls = number("vehicle", "radius_m", RADIUS_M) / RADIUS_M
    band = scenario["reward"].get("band_m")
    if not scenario["sea"].get("open") or not band:
        return hulls
    return max(hulls, BANDS_AWAY * float(band[1]))


def fit(config, scale):
    """Multiplies every distance of a view's camera."""
    camera = config["Visualization Manager"]["Views"]["Current"]
    for key in ("Distance", "Near Clip Distance", "Focal Shape Size"):
        camera[key] *= scale
    camera["Focal Point"] = {axis: x * scale for axis, x in camera["Focal Point"].items()}


def running_scenario():
    """Returns the text of the scenario that the graph tells of, or of an empty one after WAIT_S."""
    heard = threading.Event()
    text = []

    def take(message):
        text.append(message.data)
        heard.set()

    # A name of its own: rviz has the one that the launch file gives.
    rospy.init_node("view_camera", anonymous=True, argv=[], disable_signals=True)
    subscriber = rospy.Subscriber("/scenario", std_msgs.msg.String, take)
    heard.wait(WAIT_S)
    subscriber.unregister()
    rospy.signal_shutdown("known")
    return text[0] if text else "{}"


def main():
    """Returns rviz's exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("view", choices=["overview", "follow"])
    parser.add_argument("--scenario-file", default="", help="instead of the running scenario")
    parser.add_argument("--write", metavar="FILE", help="write the view there instead of opening it")
    arguments, names = parser.parse_known_args()
    file = arguments.scenario_file
    if file:
        scenario = sections_of(read_yaml(file), file)
    else:
        scenario = sections_of(parse_yaml(running_scenario(), "/scenario"), "/scenario")
    package = pathlib.Path(rospkg.RosPack().get_path("stg_bringup"))
    config = yaml.safe_load((package / "rviz" / f"{arguments.view}.rviz").read_text())
    fit(config, camera_scale(arguments.view, scenario))
    if arguments.write:
        pathlib.Path(arguments.write).write_text(yaml.safe_dump(config))
        return 0
    with tempfile.TemporaryDirectory() as folder:
        view = pathlib.Path(folder) / f"{arguments.view}.rviz"
        view.write_text(yaml.safe_dump(config))
        viewer = subprocess.Popen(["rviz", "-d", str(view), *names],
                                  env=dict(os.environ, LD_PRELOAD=ON_LOOPBACK))
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: viewer.terminate())
        return viewer.wait()


if __name__ == "__main__":
    stg_common.program.run_program("view", main, rospkg.ResourceNotFound)
