#!/usr/bin/python3
"""Measures the page of the view in Debian's Chromium, and how much it slows a run. Prints JSON.

Parts: page (a report: size, seconds to open, frames a second while it plays, memory), live (twenty AUVs
at 10 Hz: lag and frames a second), lockstep (what a run in lockstep loses to the view). The last two
need a sourced workspace. Other work of the machine changes the figures. So the output also has the
machine's `load`, and the processor time of all processes of the browser [s], which depends less on
the load.
In lockstep, the view starts and stops to listen many times during one run, because two runs differ
by more than the view slows them.
"""

import argparse
import contextlib
import importlib.machinery
import json
import os
import pathlib
import socket
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]

from stg_view.browser import show, started

MASTER_PORT = 11818
PORT, AGENTS, RATE_HZ = 8318, 20, 10.0
VIEW = ROOT / "src/stg_monitor/scripts/view_server.py"
CHANGED_S = 0.7  # after the server or the browser begins or stops to listen, before a window begins
SETTLED_S = 3.0  # a browser still works for this time after its start; it does not count as opening a page
FRAMES = """const done = arguments[1], seconds = arguments[0], times = [];
const next = (now) => { times.push(now);
  if (now - times[0] < 1000 * seconds) requestAnimationFrame(next); else done((times.length - 1) * 1000 / (now - times[0])); };
requestAnimationFrame(next);"""


def frames_per_s(driver, seconds):
    """Number of frames per second that the page draws."""
    driver.set_script_timeout(seconds + 30.0)
    return driver.execute_async_script(FRAMES, seconds)


def work_of(pid):
    """Processor time of a process and its descendants [s]."""
    parents, work = {}, {}
    for entry in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = entry.read_text().rpartition(")")[2].split()
        except OSError:  # the process has ended
            continue
        one = int(entry.parent.name)
        parents[one], work[one] = int(fields[1]), (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    below = {pid}
    while more := {one for one, parent in parents.items() if parent in below} - below:
        below |= more
    return sum(work.get(one, 0.0) for one in below)


def measure_page(page, seconds):
    """Measurements of a report."""
    with started() as driver:
        driver.get("about:blank")
        time.sleep(SETTLED_S)
        begin, before = time.monotonic(), work_of(driver.service.process.pid)
        show(driver, page.resolve().as_uri())
        opening, opened = time.monotonic() - begin, work_of(driver.service.process.pid)
        driver.execute_script("STG.app.play(true)")
        frames = frames_per_s(driver, seconds)
        work = (work_of(driver.service.process.pid) - opened) / max(1.0, frames * seconds)
        driver.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
        used = driver.execute_cdp_cmd("Runtime.getHeapUsage", {})
        steps, agents = driver.execute_script("return [STG.app.recording.steps.count, STG.app.recording.agents]")
    memory = (used["usedSize"] + used.get("backingStorageSize", 0.0)) / 1e6
    return {"agents": agents, "decisions": steps, "megabytes": page.stat().st_size / 1e6, "opens_in_s": opening,
            "opening_work_s": opened - before, "frames_per_s": frames, "work_of_a_frame_s": work, "memory_mb": memory}  # fmt: skip


def publish(seconds):
    """Publishes a circling swarm as /swarm_display, in a process of its own."""
    import math

    import auv_msgs.msg
    import rospy
    from geometry_msgs.msg import Point, Pose

    rospy.init_node("bench_view_swarm")
    states = rospy.Publisher("/swarm_display", auv_msgs.msg.SwarmDisplay, queue_size=10)
    for k in range(int(seconds * RATE_HZ)):
        state = auv_msgs.msg.SwarmState(step=k, target_positions=[Point()], fresh=[True] * AGENTS)
        state.header.stamp = rospy.Time.from_sec(1.0 + k / RATE_HZ)
        for i in range(AGENTS):
            angle, pose = 0.01 * k + 2 * math.pi * i / AGENTS, Pose()
            pose.position.x, pose.position.y, pose.orientation.w = 90 * math.cos(angle), 90 * math.sin(angle), 1.0
            state.poses.append(pose)
        states.publish(auv_msgs.msg.SwarmDisplay(header=state.header, state=state))
        time.sleep(1.0 / RATE_HZ)


def wait_for(port):
    """Waits until a program listens at the port."""
    for _ in range(600):
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1.0):
            return
        time.sleep(0.1)
    raise SystemExit(f"bench_view: port {port} has no listener")


def measure_live(seconds):
    """Lag and frames of a live page."""
    server = [sys.executable, VIEW, f"_port:={PORT}", f"_rate_hz:={RATE_HZ}"]
    own = {**os.environ, "ROS_MASTER_URI": f"http://127.0.0.1:{MASTER_PORT}"}
    ends = []
    try:
        ends.append(subprocess.Popen(["roscore", "-p", str(MASTER_PORT)], stdout=subprocess.DEVNULL, env=own))
        wait_for(MASTER_PORT)
        ends.append(subprocess.Popen(server, stdout=subprocess.DEVNULL, env=own))
        ends.append(subprocess.Popen([sys.executable, __file__, "--publish", str(3 * seconds + 120)], env=own))
        wait_for(PORT)
        with started() as driver:
            show(driver, f"http://127.0.0.1:{PORT}")
            frames, lags = frames_per_s(driver, seconds), []
            for _ in range(int(4 * seconds)):
                time.sleep(0.25)
                lags.append(driver.execute_script("return STG.app.lag"))
    finally:
        for one in reversed(ends):
            one.terminate()
            one.wait()
    lags = sorted(lag for lag in lags if lag is not None)
    return {"agents": AGENTS, "frames_per_s": frames, "lag_s": statistics.median(lags), "lag_s_95": lags[int(0.95 * len(lags))]}


def look(stop, start):
    """Reads the stream of a live page while `start` is set, like a browser on another machine, until `stop` is set.

    It takes the processor only when the run leaves it idle, because that browser would not take it at all.
    """
    import asyncio

    import aiohttp

    os.nice(19)

    async def read():
        async with aiohttp.ClientSession() as session:
            while not stop.is_set():
                await asyncio.sleep(0.1)
                with contextlib.suppress(OSError, TypeError, aiohttp.ClientError, asyncio.TimeoutError):
                    while start.is_set() and not stop.is_set():
                        async with session.ws_connect(f"http://127.0.0.1:{PORT}/stream", max_msg_size=0) as stream:
                            while start.is_set() and not stop.is_set():
                                await asyncio.wait_for(stream.receive_bytes(), 1.0)

    asyncio.run(read())


def serve():
    """Runs the server of the view. Each line of the standard input lets it begin or stop to listen to the run."""
    view = importlib.machinery.SourceFileLoader("view_server", str(VIEW)).load_module()
    import rospy
    from stg_view.listening import UNSEEN_SHARE, Kept

    os.nice(view.NICE)
    rospy.init_node("view_server", disable_signals=True, disable_rostime=True)
    server = view.Server(PORT, RATE_HZ, UNSEEN_SHARE)
    listener = server.listener
    listener.unsubscribe()
    for line in sys.stdin:
        if line.strip() == "on":
            listener.kept = Kept()  # as in a new run, a browser gets little at once
            listener.subscribe()
        else:
            listener.unsubscribe()


class Run:
    """A run in lockstep without an end, its server of the view, a reader, and the times of its steps."""

    def __init__(self):
        import multiprocessing

        self.environment = {**os.environ, "ROS_MASTER_URI": f"http://127.0.0.1:{MASTER_PORT}"}
        os.environ["ROS_MASTER_URI"] = self.environment["ROS_MASTER_URI"]
        self.stop, self.start = multiprocessing.Event(), multiprocessing.Event()
        self.eye = multiprocessing.Process(target=look, args=(self.stop, self.start), daemon=True)
        self.eye.start()
        launch = [sys.executable, ROOT / "scripts/run/launch.py", "stg_bringup", "medium.launch"]
        command = [*launch, "episodes:=1000000", "real_time_factor:=0", "table:=false", "gui:=false", f"display_rate:={RATE_HZ}"]
        self.launch = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT, env=self.environment)
        wait_for(MASTER_PORT)
        import auv_msgs.msg
        import rospy

        # A node in Python that reads every message of /clock would take processor time from the run.
        rospy.init_node("bench_view", disable_signals=True, disable_rostime=True)
        self.times = []  # wall and simulated times [s], some of each second
        rospy.Subscriber("/acoustic_channel/links", auv_msgs.msg.LinkStates, self.hear)
        command = [sys.executable, __file__, "--serve"]
        self.server = subprocess.Popen(command, stdin=subprocess.PIPE, text=True, env=self.environment)
        wait_for(PORT)
        while not self.times:
            time.sleep(0.1)

    def hear(self, message):
        """Notes how far the run is."""
        self.times.append((time.monotonic(), message.header.stamp.to_sec()))

    def rate(self, kind, seconds):
        """Simulated seconds a second during a window: plain, viewed (with the server), watched (with a browser, too)."""
        print("off" if kind == "plain" else "on", file=self.server.stdin, flush=True)
        (self.start.set if kind == "watched" else self.start.clear)()
        time.sleep(CHANGED_S)
        begin = time.monotonic()
        time.sleep(seconds)
        inside = [t for t in self.times if t[0] >= begin]
        print("off", file=self.server.stdin, flush=True)
        return (inside[-1][1] - inside[0][1]) / (inside[-1][0] - inside[0][0])

    def end(self):
        """Ends the run."""
        self.stop.set()
        self.server.stdin.close()
        self.server.wait()
        self.launch.terminate()
        self.launch.wait()


def measure_lockstep(rounds, seconds):
    """The view comes and goes during one run: a window with it, or with a browser, is between two windows without it."""
    run, plain, losses = Run(), [], {"viewed": [], "watched": []}
    try:
        time.sleep(SETTLED_S)
        plain.append(run.rate("plain", seconds))
        for kind in list(losses) * rounds:
            speed = run.rate(kind, seconds)
            plain.append(run.rate("plain", seconds))
            losses[kind].append(1 - speed / statistics.mean(plain[-2:]))
    finally:
        run.end()

    def slower(kind):
        """Median over the rounds, and its standard error by the median absolute deviation."""
        middle = statistics.median(losses[kind])
        return middle, 1.86 * statistics.median(abs(loss - middle) for loss in losses[kind]) / len(losses[kind]) ** 0.5

    return {"plain": plain, "slower_with_view": slower("viewed"), "slower_when_watched": slower("watched")}


def main():
    """Measures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", help="page, live, lockstep (default: page)")
    parser.add_argument("--page", type=pathlib.Path, help="a report (default: one of field20 is flown and made)")
    parser.add_argument("--seconds", type=float, default=10.0, help="of each measurement (default: 10)")
    parser.add_argument("--rounds", type=int, default=40, help="windows of each kind in lockstep (default: 40)")
    parser.add_argument("--publish", type=float, help=argparse.SUPPRESS)
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.publish:
        publish(options.publish)
        return
    if options.serve:
        serve()
        return
    found = {"load": os.getloadavg()[0], "cores": os.cpu_count()}
    for part in options.parts or ["page"]:
        if part == "live":
            found[part] = measure_live(options.seconds)
        elif part == "lockstep":
            found[part] = measure_lockstep(options.rounds, options.seconds)
        elif part == "page":
            with tempfile.TemporaryDirectory() as folder:
                page = options.page or fly(pathlib.Path(folder))
                found[part] = measure_page(page, options.seconds)
        else:
            parser.error(f"no part '{part}'; there are page, live and lockstep")
    print(json.dumps(found))


def fly(folder):
    """Makes the report of one episode of field20; returns its path."""
    run, page = folder / "run", folder / "run.html"
    evaluate = [ROOT / "devel/lib/marl_trainer/evaluate", "--policy", "encircle", "--scenario", "field20"]
    subprocess.run([*evaluate, "--episodes", "1", "--record", run], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([ROOT / "src/stg_monitor/scripts/report.py", run, "--out", page], check=True, stdout=subprocess.DEVNULL)
    return page


if __name__ == "__main__":
    main()
