"""For tests: starts and ends whole runs as `./stg run` does."""

import contextlib
import os
import pathlib
import signal
import socket
import subprocess
import time
import xmlrpc.client

import rosgraph

LAUNCH = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "run" / "launch.py"


def free_port():
    """Returns a loopback port on which no program listens."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def launch(folder, *arguments, port=None, program=LAUNCH):
    """Starts a launch as `./stg run` does, by default with a master of its own.

    Another program, such as roslaunch, is given the same arguments.

    Returns (process, environment).
    """
    port = port or free_port()
    environment = dict(os.environ, ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1",
                       ROS_HOME=str(folder / "ros_home"), PWD=str(folder))
    process = subprocess.Popen(
        [str(program), "-p", str(port), "stg_bringup", *arguments], cwd=folder, env=environment,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    return process, environment


def process_of(node, environment):
    """Waits until a node runs; returns its process id."""
    master = rosgraph.Master("/record_replay", master_uri=environment["ROS_MASTER_URI"])
    end = time.monotonic() + 30.0
    while time.monotonic() < end:
        try:
            with xmlrpc.client.ServerProxy(master.lookupNode(node)) as server:
                return server.getPid("/record_replay")[2]
        except (OSError, rosgraph.MasterException):
            time.sleep(0.1)
    raise AssertionError(f"no {node}")


def processes_with(master_uri):
    """Returns {program: process id} of all programs that run with this master."""
    found = {}
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            environment = (folder / "environ").read_bytes()
            if f"ROS_MASTER_URI={master_uri}".encode() in environment:
                found[(folder / "comm").read_text().strip()] = int(folder.name)
        except OSError:  # the process has ended
            pass
    return found


def stop(process):
    """Ends a roslaunch as Ctrl-C does. If it does not end, this kills it and its nodes."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        return process.communicate(timeout=20)[0]
    except subprocess.TimeoutExpired:
        process.kill()
        port = process.args[process.args.index("-p") + 1]
        while found := processes_with(f"http://127.0.0.1:{port}"):  # the nodes hold its output open
            for node in found.values():
                with contextlib.suppress(ProcessLookupError):
                    os.kill(node, signal.SIGKILL)
        return process.communicate()[0]
