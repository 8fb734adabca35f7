"""Valid and wrong calls to the services of a running graph.

The wrong calls are like those of a faulty or foreign program.
The connections speak the protocol of ROS themselves, because the client of rospy sends only what fits the
type of a service.
"""

import dataclasses
import io
import math
import pathlib
import random
import socket
import struct
import time
from urllib.parse import urlparse

import roslib.message
import rosservice
from auv_msgs.srv import LoadPolicyRequest, PauseRequest, PingRequest, ResetRequest
from roscpp.srv import GetLoggersRequest, SetLoggerLevelRequest

from stg_common.loading import load_program

ROOT = pathlib.Path(__file__).resolve().parents[2]
MUTATIONS = load_program(ROOT / "src" / "stg_bringup" / "test" / "mutations.py")
PATIENCE_S = 900.0  # wall time within which a service must answer
HUGE = 0x1FFFFFFF  # length of a request that never comes [bytes]
MOST_BYTES = 1 << 24  # of an answer
# Valid calls, calls with changed fields, calls with changed bytes, and connections that break the protocol.
KINDS = ("valid", "changed", "damaged", "broken")
SHARES = (0.5, 0.35, 0.145, 0.005)
POOL = 400  # different requests of each kind, service and client
CONTROLLERS = ("pursuit", "pursuit_separated", "pursuit:gain=4", "idle", "encircle")
LOGGERS = ("ros", "ros.roscpp", "ros.no_such_thing")
LEVELS = ("info", "warn", "error", "fatal")


class WrongAnswer(Exception):
    """A service answered with something that it must not answer."""


class Dropped(Exception):
    """The service has closed the connection."""


@dataclasses.dataclass
class Service:
    """A service of the graph."""

    name: str
    address: tuple  # host and port
    type_name: str
    checksum: str

    @property
    def types(self):
        """The class that holds the types of request and answer."""
        return roslib.message.get_service_class(self.type_name)


def services_of(master):
    """Returns all services of a graph."""
    found = []
    for name, _ in sorted(master.getSystemState()[2]):
        uri = master.lookupService(name)
        header = rosservice.get_service_headers(name, uri)
        place = urlparse(uri)
        found.append(Service(name, (place.hostname, place.port), header["type"], header["md5sum"]))
    return found


def bytes_of(message):
    """Returns a message as ROS sends it."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


class Connection:
    """A persistent connection to a service."""

    def __init__(self, service, checksum=None):
        fields = [f"{key}={value}".encode() for key, value in (
            ("callerid", "/call_services"), ("md5sum", checksum or service.checksum), ("persistent", "1"),
            ("service", service.name), ("type", service.type_name))]  # fmt: skip
        header = b"".join(struct.pack("<I", len(field)) + field for field in fields)
        self.socket = socket.create_connection(service.address, PATIENCE_S)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.send(header)
        self.header = self.block()

    def close(self):
        """Closes the connection, whatever is on its way."""
        self.socket.close()

    def send(self, request, length=None):
        """Sends a request, or one that claims another length."""
        try:
            self.socket.sendall(struct.pack("<I", len(request) if length is None else length) + request)
        except ConnectionError as error:
            raise Dropped from error

    def read(self, count):
        """Returns so many bytes."""
        data = b""
        while len(data) < count:
            try:
                piece = self.socket.recv(count - len(data))
            except ConnectionError as error:
                raise Dropped from error
            except TimeoutError as error:
                raise WrongAnswer(f"no answer within {PATIENCE_S:.0f} s") from error
            if not piece:
                raise Dropped
            data += piece
        return data

    def block(self):
        """Returns bytes after their number."""
        (count,) = struct.unpack("<I", self.read(4))
        if count > MOST_BYTES:
            raise WrongAnswer(f"an answer of {count} bytes")
        return self.read(count)

    def call(self, request):
        """Returns (taken, answer): the bytes of the answer, or of the reason of a refusal."""
        self.send(request)
        taken = self.read(1)
        if taken not in (b"\0", b"\1"):
            raise WrongAnswer(f"an answer that begins with {taken!r}")
        return taken == b"\1", self.block()


def valid_request(service, source, policies, vehicles):
    """Returns a request that the service must accept."""
    kind = service.types._request_class  # pylint: disable=protected-access
    if kind is ResetRequest:
        return ResetRequest(seed=source.getrandbits(64), use_seed=source.random() < 0.5)
    if kind is PauseRequest:
        return PauseRequest(pause=source.random() < 0.3)
    if kind is LoadPolicyRequest:
        return LoadPolicyRequest(path=source.choice((*policies, *CONTROLLERS)))
    if kind is PingRequest:
        pair = source.sample(sorted(vehicles), 2)
        return PingRequest(source=pair[0], destination=pair[1], timeout=source.choice((0.0, 0.5, 5.0)))
    if kind is SetLoggerLevelRequest:
        return SetLoggerLevelRequest(logger=source.choice(LOGGERS), level=source.choice(LEVELS))
    if kind is GetLoggersRequest:
        return GetLoggersRequest()
    raise SystemExit(f"call_services does not know what {service.type_name} of {service.name} means")


def damaged(data, source):
    """Returns other bytes: shorter, longer, or with some of them changed."""
    what = source.choice(("cut", "longer", "flipped", "count"))
    if what == "cut":
        return data[: source.randrange(len(data) + 1)]
    if what == "longer":
        return data + source.randbytes(source.choice((1, 4, 300, 70_000)))
    data = bytearray(data or b"\0")
    place = source.randrange(len(data))
    if what == "flipped":
        data[place] ^= 1 << source.randrange(8)
    else:
        # The number of characters of a text, for example, becomes large.
        data[place : place + 4] = struct.pack("<I", source.choice((0xFFFFFFFF, 0x0FFFFFFF, 1 << 20)))
    return bytes(data)


class Pool:
    """The requests of one client to one service. The same seed gives the same requests."""

    def __init__(self, service, seed, policies, vehicles):
        source = random.Random(f"{seed} {service.name}")
        self.service, self.source, self.vehicles = service, source, vehicles
        self.requests = {kind: [] for kind in KINDS}
        self.last_episode = 0
        for _ in range(POOL):
            valid = valid_request(service, source, policies, vehicles)
            self.requests["valid"].append((valid, bytes_of(valid)))
            other = MUTATIONS.mutated(valid, source) if valid.__slots__ else valid
            if hasattr(other, "timeout") and other.timeout > 5.0:
                other.timeout = 5.0 if math.isfinite(other.timeout) and other.timeout <= 3600.0 else math.nan
            self.requests["changed"].append((other, bytes_of(other)))
            self.requests["damaged"].append((None, damaged(bytes_of(valid), source)))

    def draw(self):
        """Returns (kind, request, its bytes)."""
        (kind,) = self.source.choices(KINDS, SHARES)
        return (kind, *self.source.choice(self.requests["valid" if kind == "broken" else kind]))

    def judge(self, kind, request, taken, data):
        """Checks an answer. Returns "done" or "refused"."""
        if not taken:
            if kind == "valid":
                raise WrongAnswer(f"{request} is refused without an answer: {data!r}")
            return "refused"
        answer = self.service.types._response_class()  # pylint: disable=protected-access
        answer.deserialize(data)
        if bytes_of(answer) != data:
            raise WrongAnswer(f"{data!r} is not an answer of this type")
        success = getattr(answer, "success", True)
        if not success and not answer.message:
            raise WrongAnswer(f"{request} is refused without a reason")
        if kind in ("valid", "changed"):
            self.check(kind, request, answer, success)
        return "done" if success else "refused"

    def check(self, kind, request, answer, success):
        """Checks what an answer to an intact request says."""
        if isinstance(request, PingRequest):
            self.check_ping(kind, request, answer)
        elif kind == "valid" and not success:
            raise WrongAnswer(f"{request} is refused: {answer.message}")
        if isinstance(request, ResetRequest):
            if not success or answer.episode < self.last_episode:
                raise WrongAnswer(f"episode {answer.episode} after {self.last_episode}")
            self.last_episode = answer.episode
        elif isinstance(request, LoadPolicyRequest) and not answer.policy_id:
            raise WrongAnswer(f"{request}: no policy is in use")
        elif isinstance(request, GetLoggersRequest) and "ros" not in {l.name for l in answer.loggers}:
            raise WrongAnswer("the logger 'ros' is missing")

    def check_ping(self, kind, request, answer):
        """Checks a range, or that the reason of its absence is clear."""
        if answer.success:
            ends = [self.vehicles[number] for number in (request.source, request.destination)]
            if abs(answer.range - math.dist(*ends)) > 1.0:
                raise WrongAnswer(f"{request}: a range of {answer.range} m")
        elif kind == "valid" and "there is no vehicle" in answer.message:
            raise WrongAnswer(f"{request}: {answer.message}")


class Client:
    """Calls all services, each over a connection of its own."""

    def __init__(self, services, seed, policies, vehicles):
        self.pools = [Pool(service, seed, policies, vehicles) for service in services]
        self.weights = [1.0 if "logger" in s.name else 12.0 for s in services]
        self.connections = [None] * len(services)
        self.source = random.Random(seed)

    def connect(self):
        """Opens all connections. Without it, one that opens at the first call looks like a lost file."""
        for index, pool in enumerate(self.pools):
            self.connections[index] = Connection(pool.service)

    def call(self):
        """Makes one call. Returns (index of the service, kind, outcome)."""
        (index,) = self.source.choices(range(len(self.pools)), self.weights)
        pool = self.pools[index]
        kind, request, data = pool.draw()
        began = time.monotonic()
        try:
            if kind == "broken":
                return index, kind, self.broken(pool, data)
            if self.connections[index] is None:
                self.connections[index] = Connection(pool.service)
            taken, answer = self.connections[index].call(data)
            return index, kind, pool.judge(kind, request, taken, answer)
        except Dropped as drop:
            self.connections[index] = None
            if kind in ("valid", "changed"):
                raise WrongAnswer(f"{pool.service.name}: connection lost at {request}") from drop
            return index, kind, "dropped"
        except (OSError, WrongAnswer) as error:
            self.connections[index] = None
            after = time.monotonic() - began
            raise WrongAnswer(f"{pool.service.name}: {kind}: {error} (after {after:.1f} s)") from error

    def broken(self, pool, data):
        """Breaks the protocol on a connection of its own. Returns the outcome."""
        what = self.source.choice(("type", "header", "length", "half", "unread"))
        if what == "header":
            with socket.create_connection(pool.service.address, PATIENCE_S) as stranger:
                stranger.sendall(self.source.randbytes(self.source.choice((3, 40, 5000))))
            return "left"
        connection = Connection(pool.service, "0" * 32 if what == "type" else None)
        try:
            if what == "type":
                if b"error=" not in connection.header:
                    raise WrongAnswer("a request of another type is accepted")
                return "refused"
            if what == "length":
                connection.send(data, HUGE)
            elif what == "half":
                connection.send(data[: len(data) // 2], len(data) + 1)
            else:
                connection.send(data)
            return "left"
        finally:
            connection.close()
