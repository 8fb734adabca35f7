#!/usr/bin/python3
"""Measures the page of the view in Debian's Chromium, and what it costs a run; prints one JSON object.

Parts: page (a report: size, seconds to open, frames a second while it plays, memory), live (twenty AUVs
at 10 Hz: lag and frames a second), lockstep (what a run in lockstep loses to the view). The last two
need a sourced workspace. Figures depend on what else the machine does: `load` is given
with them, and the work (seconds of processor time of all processes of the browser), which depends less on it.
In lockstep, the view starts and ends many times during one run, because two runs differ by more than it costs.
"""

import argparse
import contextlib
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
    server = [sys.executable, ROOT / "src/stg_monitor/scripts/view_server.py", f"_port:={PORT}", f"_rate_hz:={RATE_HZ}"]
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


def look(stop):
    """Reads the stream of a live page, like a browser on another machine, until `stop` is set."""
    import asyncio

    import aiohttp

    async def read():
        async with aiohttp.ClientSession() as session:
            while not stop.is_set():
                try:
                    async with session.ws_connect(f"http://127.0.0.1:{PORT}/stream", max_msg_size=0) as stream:
                        while not stop.is_set():
                            await asyncio.wait_for(stream.receive_bytes(), 1.0)
                except (OSError, TypeError, aiohttp.ClientError, asyncio.TimeoutError):
                    await asyncio.sleep(0.1)  # the server is not there yet, or not any more

    asyncio.run(read())


def episodes_of(times, begin, end):
    """Episodes a second between two times, from the times at which episodes ended [s]."""
    inside = [t for t in times if begin <= t <= end]
    return (len(inside) - 1) / (inside[-1] - inside[0]) if len(inside) > 1 else 0.0


class Run:
    """A run in lockstep without an end, and the times at which its episodes end."""

    def __init__(self):
        self.environment = {**os.environ, "ROS_MASTER_URI": f"http://127.0.0.1:{MASTER_PORT}"}
        os.environ["ROS_MASTER_URI"] = self.environment["ROS_MASTER_URI"]
        launch = [sys.executable, ROOT / "scripts/run/launch.py", "stg_bringup", "medium.launch"]
        command = [*launch, "episodes:=1000000", "real_time_factor:=0", "table:=false", "gui:=false"]
        self.launch = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT, env=self.environment)
        wait_for(MASTER_PORT)
        import auv_msgs.msg
        import rospy

        # A node in Python that reads every message of /clock would take processor time from the run.
        rospy.init_node("bench_view", disable_signals=True, disable_rostime=True)
        self.times = []
        rospy.Subscriber("/episode_summary", auv_msgs.msg.EpisodeSummary, lambda _: self.times.append(time.monotonic()))

    def rate(self, kind, seconds):
        """Episodes a second during a window: plain, viewed (with the server), watched (with a browser, too)."""
        import multiprocessing

        stop, server, eye = multiprocessing.Event(), None, None
        if kind != "plain":
            server = subprocess.Popen(
                [sys.executable, ROOT / "src/stg_monitor/scripts/view_server.py", f"_port:={PORT}", "__name:=view_server"],
                stdout=subprocess.DEVNULL, env=self.environment,
            )  # fmt: skip
            wait_for(PORT)
        if kind == "watched":
            eye = multiprocessing.Process(target=look, args=(stop,), daemon=True)
            eye.start()
        time.sleep(SETTLED_S)
        begin = time.monotonic()
        time.sleep(seconds)
        rate = episodes_of(self.times, begin, time.monotonic())
        stop.set()
        if eye is not None:
            eye.join()
        if server is not None:
            server.terminate()
            server.wait()
        return rate

    def end(self):
        """Ends the run."""
        self.launch.terminate()
        self.launch.wait()


def measure_lockstep(rounds, seconds):
    """The view comes and goes during one run: windows without it, with it, and with a browser, in turns."""
    run, rates = Run(), {kind: [] for kind in ("plain", "viewed", "watched")}
    try:
        while not run.times:
            time.sleep(0.1)
        for k in range(rounds):
            for kind in (list(rates), list(rates)[::-1])[k % 2]:
                rates[kind].append(run.rate(kind, seconds))
    finally:
        run.end()

    def slower(kind):
        """Median over the rounds, and its standard error by the median absolute deviation."""
        losses = [1 - rate / plain for rate, plain in zip(rates[kind], rates["plain"])]
        middle = statistics.median(losses)
        return middle, 1.86 * statistics.median(abs(loss - middle) for loss in losses) / len(losses) ** 0.5

    return {"episodes_per_s": rates, "slower_with_view": slower("viewed"), "slower_when_watched": slower("watched")}


def main():
    """Measures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", help="page, live, lockstep (default: page)")
    parser.add_argument("--page", type=pathlib.Path, help="a report (default: one of field20 is flown and made)")
    parser.add_argument("--seconds", type=float, default=10.0, help="of each measurement (default: 10)")
    parser.add_argument("--rounds", type=int, default=8, help="windows of each kind in lockstep (default: 8)")
    parser.add_argument("--publish", type=float, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.publish:
        publish(options.publish)
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
