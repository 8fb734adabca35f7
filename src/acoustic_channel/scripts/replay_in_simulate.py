#!/usr/bin/python3
"""Replays what the hosts of emulated modems sent as traffic of `simulate`, and compares the fates.

Takes the file of modems.launch and the packet log of its run (packet_log:=FILE). All vehicles must be moored,
and messages must not ask for acknowledgements, because simulate has none. With the same seed, every packet
must have the same fate and the same times. With another seed (--seed), the shares must agree within chance.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import yaml


def parse(argv):
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("config", help="the file of modems.launch")
    parser.add_argument("log", help="the packet log of its run")
    parser.add_argument("--seed", type=int, help="of simulate (default: the file's)")
    parser.add_argument("--simulate", default="rosrun acoustic_channel simulate", help="the program")
    return parser.parse_args(argv)


def read(path):
    """{(source, sequence, receiver): row} of the data packets that left."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["kind"] == "data" and row["sequence"]]
    return {(row["source"], int(row["sequence"]), row["destination"]): row for row in rows}


def network(config, rows, seed):
    """The network file with the same nodes, and a packet at each time of the log."""
    nodes = []
    for index, vehicle in enumerate(config["vehicles"]):
        if "position_m" not in vehicle:
            raise SystemExit(f"vehicle {vehicle['name']} is not moored")
        nodes.append({"id": vehicle.get("id", index), "position_m": vehicle["position_m"]})
    packets = {(row["source"], row["sequence"]): row for row in rows.values()}
    flows = {}
    for row in packets.values():
        flow = (int(row["source"]), row["addressed"], int(row["bytes"]))
        flows.setdefault(flow, []).append(float(row["offered_s"]))
    traffic = []
    for (source, addressed, size), times in sorted(flows.items()):
        one = {"source": source, "kind": "at", "times_s": sorted(times), "bytes": size}
        traffic.append(one if addressed == "all" else {**one, "destination": int(addressed)})
    last = max(max(flow["times_s"]) for flow in traffic)
    return {"duration_s": last + 30.0, "seed": seed, "channel": config["channel"],
            "nodes": nodes, "traffic": traffic}  # fmt: skip


def summary(rows):
    """Number of messages, delivered share, and mean delay from offer to arrival [s]."""
    delivered = [row for row in rows.values() if row["fate"] == "delivered"]
    delays = [float(row["arrival_s"]) - float(row["offered_s"]) for row in delivered]
    return {
        "messages": len({key[:2] for key in rows}),
        "fates": len(rows),
        "delivered": len(delivered) / len(rows),
        "mean_delay_s": sum(delays) / max(1, len(delays)),
    }


def main(argv=None):
    """Prints both summaries and the number of equal fates."""
    args = parse(argv)
    config = yaml.safe_load(pathlib.Path(args.config).read_text(encoding="utf-8"))
    emulated = read(args.log)
    seed = config.get("seed", 0) if args.seed is None else args.seed
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "network.yaml"
        file.write_text(yaml.safe_dump(network(config, emulated, seed)), encoding="utf-8")
        command = [*args.simulate.split(), str(file), "--out", folder, "--quiet"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        simulated = read(pathlib.Path(folder) / "packets.csv")
    both = [(row, simulated[key]) for key, row in emulated.items() if key in simulated]
    result = {
        "emulated": summary(emulated),
        "simulated": summary(simulated),
        "equal_fates": sum(a["fate"] == b["fate"] for a, b in both),
        "largest_difference_of_arrivals_s": max(
            abs(float(a["arrival_s"]) - float(b["arrival_s"]))
            for a, b in both
            if a["arrival_s"] and b["arrival_s"]
        ),
    }
    print(json.dumps(result, indent=1))
    return 0 if args.seed is not None or result["equal_fates"] == len(emulated) else 1


if __name__ == "__main__":
    sys.exit(main())
