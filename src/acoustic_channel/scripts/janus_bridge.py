#!/usr/bin/env python3
"""Joins the sound of the public tools janus-tx and janus-rx to an emulated JANUS modem.

Here a janus-rx decodes the sound of the host's janus-tx, and the packets go through the simulated water. A
janus-tx plays the packets that the modem receives from the water to the host's janus-rx. Each of the host's
two tools gets a named pipe (--stream-driver raw), or a TCP port if its version supports this:

  janus_bridge.py --modem 127.0.0.1:9203 --from-host tx.pipe --to-host rx.pipe --tools DIR \\
                  --pset-file parameter_sets.csv
  janus-tx --stream-driver raw --stream-driver-args tx.pipe --pset-file ... --packet-cargo hello
  janus-rx --stream-driver raw --stream-driver-args rx.pipe --pset-file ... --verbose 1

The sound of a packet begins when the packet has ended in the water, so the host gets it too late by the
length of the packet. Cargo must be text without commas.
"""

import argparse
import os
import pathlib
import queue
import re
import socket
import stat
import subprocess
import sys
import tempfile
import threading
import time

CHUNK_S = 0.05
SAMPLE_BYTES = 2
FIELDS = {"station": "StationIdentifier", "set": "ParameterSetIdentifier",
          "destination": "DestinationIdentifier", "ack": "AckRequest"}  # fmt: skip


def parse(argv):
    """Reads the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--modem", required=True, metavar="HOST:PORT", help="address of the emulated modem")
    for name, what in (("from", "its janus-tx writes"), ("to", "its janus-rx reads")):
        parser.add_argument(
            f"--{name}-host",
            required=True,
            metavar="PIPE|tcp:PORT",
            help=f"sound of the host, which {what}",
        )
    parser.add_argument("--tools", default="", help="folder of janus-tx and janus-rx (the PATH)")
    parser.add_argument("--pset-file", required=True, help="file of parameter sets for these tools")
    parser.add_argument("--pset-id", default="1")
    parser.add_argument("--stream-fs", type=int, default=44100, help="sample rate [Hz]")
    return parser.parse_args(argv)


def open_sound(place, mode):
    """A stream of samples: a named pipe, which is made if necessary, or the next client of a port."""
    if place.startswith("tcp:"):
        with socket.create_server(("127.0.0.1", int(place[4:]))) as server:
            return server.accept()[0].makefile(mode)
    path = pathlib.Path(place)
    if not path.exists():
        os.mkfifo(path, 0o600)
    if not stat.S_ISFIFO(path.stat().st_mode):
        raise SystemExit(f"janus_bridge: {path} is not a named pipe")
    return open(path, mode, buffering=0)


def crc16(data):
    """The checksum after the cargo of class 16, type 1."""
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc


class Tools:
    """The two public programs; they work on files of raw samples."""

    def __init__(self, args):
        self._folder = pathlib.Path(args.tools) if args.tools else pathlib.Path()
        self._args = args
        path = os.environ.get("LD_LIBRARY_PATH", "")
        self._environment = dict(os.environ, LD_LIBRARY_PATH=f"{self._folder}:{path}")

    def _run(self, name, samples, *options):
        common = ["--pset-file", self._args.pset_file, "--pset-id", self._args.pset_id,
                  "--stream-driver", "raw", "--stream-driver-args", samples,
                  "--stream-fs", str(self._args.stream_fs), "--verbose", "1"]  # fmt: skip
        tool = str(self._folder / name) if self._args.tools else name
        done = subprocess.run(
            [tool, *common, *options],
            capture_output=True,
            text=True,
            errors="replace",
            env=self._environment,
            timeout=120,
            check=False,
        )
        return done.stdout + done.stderr

    def decode(self, sound):
        """Words of the command tx for each packet in the samples."""
        with tempfile.NamedTemporaryFile(suffix=".raw") as file:
            file.write(sound + bytes(self._args.stream_fs * SAMPLE_BYTES))
            file.flush()
            text = self._run("janus-rx", file.name)
        commands = []
        for part in re.split(r"Bytes \(hex\)", text)[1:]:
            packet = re.sub(r"[^0-9A-F]", "", part.splitlines()[0])
            cargo = re.search(r"Cargo \(hex\)\s*:([ 0-9A-F]*)", part)
            command = f"tx packet={packet}"
            digits = cargo.group(1).replace(" ", "") if cargo else ""
            addressed = packet[2:4] == "10" and int(packet[4:6], 16) >> 2 == 1
            if addressed:  # janus-rx shows zeros for the checksum; the modem computes it again
                digits = digits[:-4]
            commands.append(f"{command} cargo={digits}" if digits else command)
        return commands

    def encode(self, words):
        """Samples of a packet that the modem received."""
        options = []
        for name in ("class", "type"):
            options += [f"--packet-{'class-id' if name == 'class' else 'app-type'}", words[name]]
        for name in ("mobility", "tx-rx", "forward"):
            options += [f"--packet-{name}", words[name]]
        for name, option in (("reserve", "reserv-time"), ("repeat", "repeat-int")):
            if name in words:
                options += [f"--packet-{option}", words[name]]
        if "cargo" in words:
            cargo = bytes.fromhex(words["cargo"]).rstrip(b"\0")
            fields = [f"{FIELDS[name]}={words[name]}".encode() for name in FIELDS if name in words]
            if "destination" in words:  # janus-tx does not compute the checksum
                fields.append(b"PayloadSize=%d" % len(cargo))
                cargo += crc16(cargo).to_bytes(2, "big")
            options += ["--packet-app-fields", b",".join([*fields, b"Payload=" + cargo])]
        else:
            options += ["--packet-app-data", words["data"]]
        with tempfile.NamedTemporaryFile(suffix=".raw") as file:
            text = self._run("janus-tx", file.name, *options)
            sound = pathlib.Path(file.name).read_bytes()
        if not sound:
            print(f"janus_bridge: janus-tx made no sound: {text.strip()[-200:]}", file=sys.stderr)
        return sound


def hear_host(args, tools, modem):
    """Sends packets from the host's sound into the water, forever."""
    while True:
        with open_sound(args.from_host, "rb") as stream:
            sound = stream.read()
        for command in tools.decode(sound):
            print(f"janus_bridge: {command}", flush=True)
            modem.sendall(command.encode() + b"\n")


def hear_water(tools, modem, sounds):
    """Turns packets from the water into samples, until the modem disconnects."""
    for line in modem.makefile("r", errors="replace"):
        print(f"janus_bridge: {line.strip()}", flush=True)
        words = dict(word.split("=", 1) for word in line.split()[1:] if "=" in word)
        if line.startswith("rx "):
            sounds.put(tools.encode(words))
    raise SystemExit("janus_bridge: the modem has disconnected")


def play(args, sounds):
    """Plays samples to the host in real time, and zeros if there is no packet."""
    silence = bytes(int(args.stream_fs * CHUNK_S) * SAMPLE_BYTES)
    while True:
        try:
            with open_sound(args.to_host, "wb") as stream:
                due = time.monotonic()
                while True:
                    sound = silence if sounds.empty() else sounds.get()
                    stream.write(sound)
                    stream.flush()
                    length_s = len(sound) / SAMPLE_BYTES / args.stream_fs
                    due = max(due + length_s, time.monotonic())
                    time.sleep(max(0.0, due - time.monotonic() - CHUNK_S))
        except BrokenPipeError:
            continue


def main(argv=None):
    """Connects host and modem until it is stopped."""
    args = parse(argv)
    host, port = args.modem.rsplit(":", 1)
    tools, sounds = Tools(args), queue.Queue()
    with socket.create_connection((host, int(port))) as modem:
        for target, values in ((hear_host, (args, tools, modem)), (play, (args, sounds))):
            threading.Thread(target=target, args=values, daemon=True).start()
        hear_water(tools, modem, sounds)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(130)
