#!/usr/bin/python3
"""Runs the same networks in `simulate` and in ns-3's UAN module and prints both as a table.

Needs libns3-dev and a compiler; nothing else in the repository needs them. Both simulations have the same
positions, the same packets at the same times, the same modem (WHOI Micromodem PSK at rate 3) and the same
water (Thorp, spreading 1.5, 1500 m/s, Wenz noise), and use ALOHA.
"""

import argparse
import json
import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
LIBRARIES = [f"-lns3-{name}" for name in ("uan", "mobility", "network", "energy", "core")]
BYTES = 256
AIRTIME_S = 3.07 / 2  # duration of one of the two frames of a packet
RATE_BPS = round(8 * BYTES / AIRTIME_S)
KHZ, BAND_HZ, LEVEL_DB, ACQUISITION_DB = 25, 5000, 185, -10
# ns-3 has one threshold for the ratio of signal to noise and interference. In this model, half of the frames
# are lost at -1.5 dB, and the receiver is 3 dB worse; other packets of the same kind count times bandwidth
# over bit rate.
NOISE_DB = 1.5
INTERFERENCE_DB = NOISE_DB + 10 * math.log10(BAND_HZ / (8 * 512 / 3.07))
STEADY = "propagation: {shadowing_db: 0.0, rician_k: 1.0e+9}"


def build(folder):
    """Compiles the program that uses ns-3."""
    program = folder / "uan_network"
    source = HERE / "uan_network.cpp"
    command = ["g++", "-std=c++17", "-O1", str(source), "-o", str(program), *LIBRARIES]
    if subprocess.run(command, check=False).returncode != 0:
        sys.exit("compare: ns-3's UAN module cannot be built on: apt-get install libns3-dev")
    return program


def poisson(rng, sources, load, packets):
    """Times and sources of about `packets` packets at this load of airtime."""
    duration = packets * AIRTIME_S / load
    calls, t = [], 0.0
    while True:
        t += rng.expovariate(load / AIRTIME_S)
        if t > duration - 60.0:
            return calls, duration
        calls.append((round(t, 6), rng.choice(sources)))


def run_ns3(program, folder, places, calls, duration, threshold):
    """Packets sent, and delivered by (source, receiver)."""
    (folder / "nodes").write_text("".join(f"{x} {y} {z}\n" for x, y, z in places))
    (folder / "packets").write_text("".join(f"{t:.6f} {source} {BYTES}\n" for t, source in calls))
    options = [duration, RATE_BPS, KHZ, BAND_HZ, LEVEL_DB, ACQUISITION_DB, threshold]
    command = [str(program), str(folder / "nodes"), str(folder / "packets"), *map(str, options)]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split("\n")
    counts = {}
    for line in lines[1:]:
        if line:
            source, receiver, count = map(int, line.split())
            counts[source, receiver] = count
    return int(lines[0]), counts


def run_ours(program, folder, places, calls, duration, fading):
    """Packets sent, and delivered by (source, receiver)."""
    water = "" if fading else f"    {STEADY}\n"
    text = (
        f"duration_s: {duration}\nseed: 1\nstep_s: 10.0\nchannel:\n  model: physical\n"
        "  access: aloha\n  physical:\n    modem: {profile: micromodem_psk_r3}\n"
        f"    water: {{sound_speed: profile}}\n{water}nodes:\n"
    )
    for i, place in enumerate(places):
        text += f"  - {{id: {i}, position_m: {list(map(float, place))}}}\n"
    text += "traffic:\n"
    for source in sorted({source for _, source in calls}):
        times = [t for t, of in calls if of == source]
        text += f"  - {{source: {source}, kind: at, bytes: {BYTES}, times_s: {times}}}\n"
    (folder / "network.yaml").write_text(text)
    command = [program, str(folder / "network.yaml"), "--out", str(folder), "--quiet"]
    command.append("--summary-only")
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    summary = json.loads(out.strip().split("\n")[-1])
    counts = {(e["source"], e["destination"]): e["delivered"] for e in summary["links"]}
    return summary["transmitted"], counts


class Comparison:
    """Runs networks and prints a row for each of them."""

    def __init__(self, simulate, folder):
        self.simulate = simulate
        self.folder = folder
        self.program = build(folder)

    def row(self, name, places, calls, duration, pairs, threshold, value):
        """value(sent, delivered) is the compared number; `pairs` are the links that count."""
        results = [run_ns3(self.program, self.folder, places, calls, duration, threshold)]
        for fading in (False, True):
            results.append(
                run_ours(self.simulate, self.folder, places, calls, duration, fading)
            )
        cells = [value(sent, sum(counts[p] for p in pairs)) for sent, counts in results]
        print(f"| {name} | " + " | ".join(f"{c:.3f}" for c in cells) + " |", flush=True)


def compare(comparison):
    """Compares all networks."""
    rng = random.Random(1)
    print("| | ns-3 | ours, steady | ours, fading |\n|---|---|---|---|")
    around = [(0.0, 0.0, -20.0)]
    for i in range(20):
        angle = 2 * math.pi * i / 20
        around.append((round(1000 * math.cos(angle), 6), round(1000 * math.sin(angle), 6), -20.0))
    to_hub = [(i, 0) for i in range(1, 21)]
    for load in (0.1, 0.25, 0.5, 1.0, 2.0):
        calls, duration = poisson(rng, list(range(1, 21)), load, 8000)
        comparison.row(
            f"ring around a hub, load {load}: throughput", around, calls, duration, to_hub,
            INTERFERENCE_DB, lambda sent, got, d=duration: got * AIRTIME_S / d,
        )  # fmt: skip
    places = [
        (round(rng.uniform(0, 2000), 1), round(rng.uniform(0, 2000), 1), -20.0) for _ in range(12)
    ]
    pairs = [(i, j) for i in range(12) for j in range(12) if i != j]
    for load in (0.2, 0.5):
        calls, duration = poisson(rng, list(range(12)), load, 4000)
        comparison.row(
            f"12 nodes in 2 km x 2 km, everybody to all, load {load}: delivery ratio", places,
            calls, duration, pairs, INTERFERENCE_DB, lambda sent, got: got / (11 * sent),
        )  # fmt: skip
    calls = [(round(5.0 * k + 1.0, 6), 0) for k in range(1000)]
    for km in (6.0, 7.0, 7.8, 8.1, 8.4, 9.0):
        comparison.row(
            f"one sender, {km} km: delivery ratio", [(0.0, 0.0, -20.0), (1e3 * km, 0.0, -20.0)],
            calls, 5100.0, [(0, 1)], NOISE_DB, lambda sent, got: got / sent,
        )  # fmt: skip


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--simulate", default=shutil.which("simulate"), help="the program")
    arguments = parser.parse_args()
    if not arguments.simulate:
        parser.error("--simulate: say where it is, for instance devel/lib/acoustic_channel/simulate")
    with tempfile.TemporaryDirectory() as folder:
        compare(Comparison(arguments.simulate, pathlib.Path(folder)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
