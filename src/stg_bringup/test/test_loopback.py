"""No program outside of this machine can reach a run that got no other address."""

import os
import pathlib
import socket
import struct
import tempfile
import time
import unittest
import xmlrpc.client

import rosgraph


from run_launcher import launch, process_of, stop

LISTENS = "0A"
ANOTHER = "127.0.0.2"  # an address of this machine, as an Ethernet would have one


def listening():
    """Returns {inode of a socket: (address, port)} of all TCP sockets that listen."""
    found = {}
    for version, family in (("tcp", socket.AF_INET), ("tcp6", socket.AF_INET6)):
        for line in pathlib.Path(f"/proc/net/{version}").read_text().splitlines()[1:]:
            words = line.split()
            if words[3] != LISTENS:
                continue
            host, port = words[1].split(":")
            numbers = [int(host[k:k + 8], 16) for k in range(0, len(host), 8)]
            address = socket.inet_ntop(family, b"".join(struct.pack("=I", n) for n in numbers))
            found[words[9]] = (address, int(port, 16))
    return found


def sockets_of(pid):
    """Returns the inodes of a process's sockets."""
    inodes = set()
    for file in pathlib.Path(f"/proc/{pid}/fd").iterdir():
        try:
            target = os.readlink(file)
        except OSError:  # it was closed meanwhile
            continue
        if target.startswith("socket:["):
            inodes.add(target[len("socket:["):-1])
    return inodes


def processes_of(master_uri):
    """Returns {process id: its first words} of all processes that run with the master."""
    found = {}
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if f"ROS_MASTER_URI={master_uri}".encode() in (folder / "environ").read_bytes():
                words = (folder / "cmdline").read_bytes().split(b"\0")[:3]
                found[int(folder.name)] = b" ".join(words).decode()
        except OSError:  # the process has ended
            pass
    return found


class Loopback(unittest.TestCase):
    """A run as a user starts it, with a recorder."""

    def start(self, *arguments):
        """Starts a run; returns (process, environment) when all nodes are there."""
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        process, environment = launch(pathlib.Path(temporary.name), "medium.launch", "agents:=1",
                                      "policy:=idle", "table:=false", *arguments)
        self.addCleanup(stop, process)
        for node in ("/rosout", "/metrics", "/auv_0/agent", "/auv_0/controller", "/world"):
            process_of(node, environment)
        return process, environment

    def test_every_socket_of_a_run_listens_on_the_loopback(self):
        _, environment = self.start("record:=true", "bag:=run.bag")
        process_of("/recorder", environment)
        sockets = listening()
        count = 0
        for pid, command in processes_of(environment["ROS_MASTER_URI"]).items():
            for inode in sockets_of(pid) & set(sockets):
                count += 1
                self.assertIn(sockets[inode][0], ("127.0.0.1", "::1"), command)
        self.assertGreater(count, 12, "XML-RPC and messages of seven nodes")

    def test_the_world_cannot_be_shut_down_over_another_address(self):
        _, environment = self.start()
        master = rosgraph.Master("/test_loopback", master_uri=environment["ROS_MASTER_URI"])
        port = int(master.lookupNode("/world").rsplit(":", 1)[1].strip("/"))
        with self.assertRaises(ConnectionRefusedError):
            socket.create_connection((ANOTHER, port), timeout=5.0).close()

    def test_a_world_that_somebody_shuts_down_is_no_success(self):
        process, environment = self.start()
        master = rosgraph.Master("/test_loopback", master_uri=environment["ROS_MASTER_URI"])
        time.sleep(1.0)  # the run goes on
        with xmlrpc.client.ServerProxy(master.lookupNode("/world")) as world:
            world.shutdown("/test_loopback", "because")
        output = process.communicate(timeout=60)[0]
        self.assertEqual(process.returncode, 1, output)
        self.assertIn("world: another node or program ended this one after 0 episodes", output)
        self.assertIn("stg: the run failed: /world died with exit status 4", output)


if __name__ == "__main__":
    unittest.main()
