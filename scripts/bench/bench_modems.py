#!/usr/bin/python3
"""Measures how fast emulated S2C modems answer and what they cost; prints one JSON object.

Needs a sourced workspace. Starts modems.launch with a number of modems in one water, asks them in turn
(AT?CLOCK; every 37th time a message to all), and measures the time from each question to its answer. Reply
times depend on the load of the machine, so `load` is reported, too; the processor time of the node hardly
depends on it.
"""

import argparse
import json
import os
import pathlib
import select
import signal
import socket
import subprocess
import tempfile
import time

EVERY = 37  # one message after this number of questions
TICKS = os.sysconf("SC_CLK_TCK")


def parse():
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--modems", type=int, default=16)
    parser.add_argument("--rate", type=float, default=160.0, help="commands a second to all modems together")
    parser.add_argument("--seconds", type=float, default=25.0)
    parser.add_argument("--port", type=int, default=9401, help="of the first modem")
    parser.add_argument("--master", type=int, default=11868, help="port of the ROS master")
    return parser.parse_args()


def write_config(path, modems, port):
    """Modems on a grid of 200 m."""
    lines = ["vehicles:"]
    for i in range(modems):
        place = f"[{200.0 * (i % 4)}, {200.0 * (i // 4)}, -20.0]"
        modem = f"{{protocol: s2c, tcp: {port + i}, interpreter: net}}"
        lines.append(f"  - {{name: m{i}, id: {i}, position_m: {place}, modem: {modem}}}")
    lines += ["channel:", "  model: physical", "  access: aloha", "  physical:"]
    lines += ["    modem: {profile: evologics_s2c, queue: fifo}", ""]
    path.write_text("\n".join(lines))


def connected(port, until):
    """A connection to a port, as soon as a program listens there."""
    while True:
        try:
            return socket.create_connection(("127.0.0.1", port))
        except OSError:
            if time.monotonic() > until:
                raise
            time.sleep(0.1)


def node_below(pid):
    """The process id of the node that roslaunch started."""
    for entry in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            name, _, rest = entry.read_text().rpartition(")")
        except OSError:  # the process has ended
            continue
        if name.endswith("(modems") and int(rest.split()[1]) == pid:
            return int(entry.parent.name)
    raise SystemExit("bench_modems.py: roslaunch started no node 'modems'")


def work_of(pid):
    """Processor time of a process [s]."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def answer_to(stream, begin):
    """Time from `begin` to an answer [s]; notifications before it do not count."""
    text = b""
    while True:
        if not select.select([stream], [], [], 5.0)[0]:
            raise SystemExit("bench_modems.py: no answer in 5 s")
        text += stream.recv(65536)
        now = time.monotonic()
        *lines, text = text.split(b"\r\n")
        if any(line.isdigit() or line.startswith((b"OK", b"BUSY")) for line in lines):
            return now - begin


def ask(streams, rate, seconds):
    """Reply times [s], with one question at a time."""
    times, begin = [], time.monotonic()
    for k in range(int(rate * seconds)):
        time.sleep(max(0.0, begin + k / rate - time.monotonic()))
        stream = streams[k % len(streams)]
        words = b"AT*SENDIM,8,255,noack,abcdefgh\n" if k % EVERY == EVERY - 1 else b"AT?CLOCK\n"
        start = time.monotonic()
        stream.sendall(words)
        times.append(answer_to(stream, start))
    return times, time.monotonic() - begin


def main():
    """Measures."""
    args = parse()
    with tempfile.TemporaryDirectory() as folder:
        config = pathlib.Path(folder) / "modems.yaml"
        write_config(config, args.modems, args.port)
        environment = {**os.environ, "ROS_MASTER_URI": f"http://127.0.0.1:{args.master}"}
        command = ["roslaunch", "-p", str(args.master), "acoustic_channel", "modems.launch", f"config:={config}"]
        with subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL) as launch:
            try:
                until = time.monotonic() + 60.0
                streams = [connected(args.port + i, until) for i in range(args.modems)]
                node = node_below(launch.pid)
                before = work_of(node)
                times, wall = ask(streams, args.rate, args.seconds)
                work = work_of(node) - before
            finally:
                launch.send_signal(signal.SIGINT)
    times.sort()
    result = {"modems": args.modems, "answers": len(times)}
    for name, part in (("median_ms", 0.5), ("p99_ms", 0.99), ("slowest_ms", 1.0)):
        result[name] = 1e3 * times[int(part * (len(times) - 1))]
    print(json.dumps({**result, "core_share": work / wall, "load": os.getloadavg()[0]}))


if __name__ == "__main__":
    main()
