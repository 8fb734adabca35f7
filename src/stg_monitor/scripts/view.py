#!/usr/bin/python3
"""Opens rviz with a shipped view whose camera fits the scenario.

The views are written for the paper's box of two metres. The scenario that runs, or is replayed,
says how large the region is and how far AUVs stay from their target, and the camera's distances
follow. It also says whether the agents have search maps; without them, the display of the map is
switched off, because rviz would warn that no map arrives. Everything else is the view as shipped.
"""

import stg_common.quiet_start  # first import: Ctrl-C is blocked until here, see view.launch
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

ON_LOOPBACK = "libauv_common_nodes.so"  # makes rviz's XML-RPC server listen at the address of ROS_IP
WAIT_S = 15.0  # wall time to wait for a scenario
HALF_EXTENT_M, RADIUS_M = 1.0, 0.011  # of the scenario for which the views are written
TARGET_FRAME = "target_0"
BANDS_AWAY = 26.0  # factor of the close-up's camera for each metre of the tracking band


def number(section, key, fallback):
    """Returns a key of a section, if it is a positive number."""
    value = section.get(key)
    return float(value) if isinstance(value, (int, float)) and value > 0 else fallback


def half_extent(scenario):
    """Returns half the size of the workspace."""
    return number(scenario["workspace"], "half_extent_m", HALF_EXTENT_M)


def shown_half_extent(scenario):
    """Returns half the extent of the overview at first, as in the markers (ShownHalfExtent): in open water a
    target and the start positions of the AUVs, otherwise the whole workspace."""
    everything = half_extent(scenario)
    reset = scenario["reset"]
    if not scenario["sea"].get("open") or scenario["target"].get("count", 1) != 1:
        return everything
    stages = reset.get("stages")
    stage = stages.get(reset.get("stage")) if isinstance(stages, dict) else None
    distance = stage.get("auv_distance_m") if isinstance(stage, dict) else None
    if reset.get("deploy") == "area" or not isinstance(distance, list) or len(distance) != 2:
        return everything
    farthest = number({"farthest": distance[1]}, "farthest", everything)
    band = scenario["reward"].get("band_m") or [0.0, 0.0]
    return min(everything, farthest + float(band[1]))


def camera_scale(view, scenario):
    """Returns the factor between the needed distance of the camera and that of the shipped view."""
    if view == "overview":
        return shown_half_extent(scenario) / HALF_EXTENT_M
    # In the box the close-up shows hulls; in open water it shows the band around the target.
    hulls = number(scenario["vehicle"], "radius_m", RADIUS_M) / RADIUS_M
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


def show_maps(config, scenario):
    """Switches the displays of search maps on if the scenario has maps, and off otherwise."""
    has_map = number(scenario["track"], "search_cell_m", 0.0) > 0.0
    for display in config["Visualization Manager"]["Displays"]:
        if display["Class"] == "rviz/Map":
            display["Enabled"] = display["Value"] = has_map


def running_scenario():
    """Returns the text of the graph's scenario, or of an empty one after WAIT_S."""
    heard = threading.Event()
    text = []

    def take(message):
        text.append(message.data)
        heard.set()

    # A unique name, because rviz has the name from the launch file.
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
    # ROS adds names, such as __name:=rviz, which rviz reads.
    unknown = [word for word in names if ":=" not in word]
    if unknown:
        parser.error(f"unknown option '{unknown[0]}'")
    file = arguments.scenario_file
    if file:
        scenario = sections_of(read_yaml(file), file)
    else:
        scenario = sections_of(parse_yaml(running_scenario(), "/scenario"), "/scenario")
    package = pathlib.Path(rospkg.RosPack().get_path("stg_bringup"))
    config = yaml.safe_load((package / "rviz" / f"{arguments.view}.rviz").read_text())
    fit(config, camera_scale(arguments.view, scenario))
    show_maps(config, scenario)
    if arguments.view == "overview" and shown_half_extent(scenario) < half_extent(scenario):
        # The content of the overview then moves with the target.
        config["Visualization Manager"]["Views"]["Current"]["Target Frame"] = TARGET_FRAME
    if arguments.write:
        pathlib.Path(arguments.write).write_text(yaml.safe_dump(config))
        return 0
    with tempfile.TemporaryDirectory() as folder:
        view = pathlib.Path(folder) / f"{arguments.view}.rviz"
        view.write_text(yaml.safe_dump(config))
        viewer = subprocess.Popen(["rviz", "-d", str(view), *names],
                                  env=dict(os.environ, LD_PRELOAD=ON_LOOPBACK))
        for sent in (signal.SIGINT, signal.SIGTERM):
            signal.signal(sent, lambda *_: viewer.terminate())
        return viewer.wait()


if __name__ == "__main__":
    stg_common.program.run_program("view", main, rospkg.ResourceNotFound)
