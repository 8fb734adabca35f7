"""Checks before a run starts, and checks of its files after its end."""

import http.client
import os
import shlex
import socket
import tempfile
import threading
import time
import urllib.parse
import xmlrpc.client

import rosbag
import rospkg

PATIENCE_S = 3.0  # longest wait for an answer of a master or a node
RECORDER_STOPS_AT = 2**30  # free bytes; with less space, rosbag record ends its recording
WHOLE = (-(2**31), 2**31 - 1)  # numbers that fit into a parameter of ROS


class Refusal(Exception):
    """The reason why a run cannot start, or what is missing at its end, as a message for the user."""


class _Transport(xmlrpc.client.Transport):
    """Gives up on a server that does not answer."""

    def make_connection(self, host):
        return http.client.HTTPConnection(host, timeout=PATIENCE_S)


def _call(uri, name, *arguments):
    """Calls an XML-RPC method. Returns (code, message, value) as in ROS."""
    with xmlrpc.client.ServerProxy(uri, transport=_Transport()) as server:
        answer = getattr(server, name)("/stg", *arguments)
    if not (isinstance(answer, list) and len(answer) == 3):
        raise ValueError("ROS does not answer")
    return answer


def master_is_online(uri):
    """True if a ROS master listens at `uri`, False if no program does. Refuses any other program."""
    address = urllib.parse.urlparse(uri)
    try:
        if not address.hostname or not address.port:
            raise ValueError
    except ValueError:
        raise Refusal(f"ROS_MASTER_URI is '{uri}', but must be like http://127.0.0.1:11311") from None
    try:
        socket.create_connection((address.hostname, address.port), PATIENCE_S).close()
    except OSError:
        return False
    try:
        if _call(uri, "getPid")[0] == 1:
            return True
    except Exception:  # any other program may answer
        pass
    raise Refusal(
        f"{uri}: a program that is not a ROS master uses this port; end it, or choose a free port"
        " with ROS_MASTER_URI=http://127.0.0.1:PORT"
    )


def check_names_are_free(uri, names):
    """Refuses names of running nodes, because ROS would end these nodes."""
    for name in names:
        try:
            code, _, node = _call(uri, "lookupNode", name)
            if code == 1 and _call(node, "getPid")[0] == 1:
                break
        except Exception:  # registered, but the node is dead
            pass
    else:
        return
    raise Refusal(
        f"a node {name} runs already on the master at {uri}: end that run first, or give this one"
        " a master of its own with ROS_MASTER_URI=http://127.0.0.1:PORT"
    )


class Turn:
    """The turn to start on a master. A run that starts at the same time waits until the turn is released.

    Otherwise two runs that start masters on the same port, or nodes with the same name, would end each other.
    """

    PATIENCE_S = 30.0  # longer than any start; after this time the run starts as if it were alone
    KNOWN_S = 5.0  # time for the started nodes to register at the master

    def __init__(self, uri):
        # The name of a socket without a file disappears with its process in any case.
        self._name = f"\0stg-start-{urllib.parse.urlparse(uri).port}"
        self._socket = socket.socket(socket.AF_UNIX)

    def __enter__(self):
        end = time.monotonic() + self.PATIENCE_S
        while time.monotonic() < end:
            try:
                self._socket.bind(self._name)
                break
            except OSError:
                time.sleep(0.1)
        return self

    def __exit__(self, *_):
        self._socket.close()

    def give_up_when_known(self, uri, names):
        """Lets others start as soon as they can see at the master what was started."""

        def wait():
            end = time.monotonic() + self.KNOWN_S
            while time.monotonic() < end and not all(_is_known(uri, name) for name in names):
                time.sleep(0.1)
            self._socket.close()

        threading.Thread(target=wait, daemon=True).start()


def _is_known(uri, name):
    try:
        return _call(uri, "lookupNode", name)[0] == 1
    except Exception:  # the process has ended
        return False


def check_file_can_be_written(what, path):
    """Refuses a file whose folder is missing or cannot be written."""
    folder = os.path.dirname(path) or "."
    if os.path.isdir(path):
        raise Refusal(f"{what} '{path}' is a folder")
    if not os.path.isdir(folder):
        raise Refusal(f"{what} '{path}': there is no folder '{folder}'")
    if not os.access(path if os.path.exists(path) else folder, os.W_OK):
        raise Refusal(f"{what} '{path}' cannot be written")


def check_numbers(parameters):
    """Refuses whole numbers that do not fit into a parameter of ROS. `parameters` are {name: value}."""
    for name, value in sorted(parameters.items()):
        if isinstance(value, int) and not WHOLE[0] <= value <= WHOLE[1]:
            raise Refusal(f"{name.rsplit('/', 1)[1]}: {value} is more than {WHOLE[1]}")


def check_log_folder():
    """Refuses to start if no node could write its log, because roslaunch would then start none of them."""
    folder = rospkg.get_log_dir()
    try:
        os.makedirs(folder, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"x")
    except OSError as error:
        raise Refusal(
            f"log folder '{folder}': {error.strerror}; ROS_LOG_DIR=FOLDER chooses another"
        ) from None


def bag_of(node):
    """Returns the bag that a node records, or None."""
    if (node.package, node.type) != ("rosbag", "record"):
        return None
    for argument in shlex.split(node.args):
        if argument.startswith("--output-name="):
            return argument[len("--output-name=") :]
    return None


def check_bags_are_there(nodes):
    """Refuses to play bags that are not files."""
    for node in nodes:
        if (node.package, node.type) != ("rosbag", "play"):
            continue
        for word in shlex.split(node.args):
            if not word.startswith("-") and not os.path.isfile(word):
                raise Refusal(f"bag '{word}': no such file")


class Outputs:
    """The files that a run must write."""

    def __init__(self, nodes, parameters):
        bags = [bag_of(node) for node in nodes]
        self.bags = [bag for bag in bags if bag]
        self.summary = parameters.get("/metrics/summary_file", "")
        self.episodes = parameters.get("/world/episodes", 0)
        self.began = time.time()

    def check_before(self):
        """Refuses files that cannot be written, and warns about files that will be lost."""
        for bag in self.bags:
            check_file_can_be_written("bag", bag)
            if os.path.exists(bag):
                print(f"stg: bag '{bag}' exists already; the recording replaces it", flush=True)
            self._check_space(bag, "the recorder needs 1 GiB")
        if self.summary:
            check_file_can_be_written("summary_file", self.summary)

    def check_after(self):
        """Raises an error if files of the run are missing or cut off at its end."""
        for bag in self.bags:
            self._check_bag(bag)
        if self.summary:
            self._check_summary()

    def full_disks(self):
        """Returns a text for a recorder that ended early: the bags whose disks are full, if any."""
        full = [f"'{bag}'" for bag in self.bags if self._is_short(bag)]
        return f"; too little space is free on the disk of {', '.join(full)}" if full else ""

    @staticmethod
    def _is_short(bag):
        state = os.statvfs(os.path.dirname(bag) or ".")
        return state.f_bavail * state.f_frsize < RECORDER_STOPS_AT

    def _check_space(self, bag, why):
        if self._is_short(bag):
            raise Refusal(f"bag '{bag}': too little space is free on its disk; {why}")

    def _check_bag(self, bag):
        if not os.path.exists(bag) or os.path.getmtime(bag) < self.began - 2.0:
            rest = bag + ".active"
            left = f"; what was written is in '{rest}'" if os.path.exists(rest) else ""
            raise Refusal(f"bag '{bag}' was not written to its end{left}")
        try:
            with rosbag.Bag(bag) as opened:
                if opened.get_message_count() == 0:
                    raise Refusal(f"bag '{bag}' is empty")
        except (rosbag.ROSBagException, OSError, ValueError) as error:
            raise Refusal(f"bag '{bag}' is incomplete: {error}") from None
        self._check_space(bag, "the recorder may have stopped before the run's end")

    def _check_summary(self):
        if os.path.exists(self.summary) and not os.path.isfile(self.summary):
            return  # a device or a pipe cannot be read afterwards
        try:
            with open(self.summary, encoding="utf-8") as file:
                lines = sum(1 for line in file if line.strip())
        except (OSError, ValueError) as error:
            raise Refusal(f"summary_file '{self.summary}': {error}") from None
        written = max(lines - self.summary.endswith(".csv"), 0)
        if written < self.episodes:
            raise Refusal(
                f"summary_file '{self.summary}' holds {written} of {self.episodes} episodes"
            )
