#!/usr/bin/python3
"""Serves the live view of a run to browsers on the loopback.

It only listens. Without a browser it keeps positions, at most rate_hz a second of wall time, and
packets; the rest is asked for and decoded only while there is one. A run in lockstep speaks much
more often than that: the server sleeps between two looks at what came, and of all but the packets
decodes the newest alone. A browser that comes late is sent all that was kept first. ssh -L 8300:127.0.0.1:8300 HOST brings the page to another machine.
"""

import stg_common.quiet_start  # first: until here Ctrl-C is blocked, see graph.launch
import asyncio
import re
import threading
import time

import auv_msgs.msg
import rospy
import std_msgs.msg
from aiohttp import WSMsgType, web
import stg_common.program
from stg_view.from_bag import Collector, scene_of
from stg_view.page import PageError, live_page
from stg_view.raw_packets import packets_message
from stg_view.recording import Recording, encode

NAP_S = 0.04  # between two looks at what came
EARLY = 0.8  # share of the pause after which a state is taken: what comes at the rate itself is not to be missed
MOST_KEPT = 24_000_000  # bytes of steps, and of packets, that a late browser is sent
AT_ONCE = 1 << 22  # bytes that are taken from a connection at once
HOST = "127.0.0.1"
# Only this machine's own pages may ask: another site in the same browser has its own origin and host.
OWN = re.compile(r"(127\.0\.0\.1|localhost|\[::1\])(:\d+)?$")


class Kept:
    """Messages for browsers that come late, in a bounded amount of memory."""

    def __init__(self):
        self.first, self.steps, self.packets = [], [], []
        self.bytes = {"steps": 0, "packets": 0}

    def add(self, kind, data):
        """Keeps a message."""
        if kind not in self.bytes:
            self.first.append(data)
            return
        kept = getattr(self, kind)
        kept.append(data)
        self.bytes[kind] += len(data)
        if self.bytes[kind] > MOST_KEPT:
            # Of steps every second one, of packets the newer half.
            setattr(self, kind, kept[::2] if kind == "steps" else kept[len(kept) // 2 :])
            self.bytes[kind] = sum(map(len, getattr(self, kind)))

    def all(self):
        """Everything, as one frame of a websocket."""
        return b"".join([*self.first, *self.steps, *self.packets])


class Ears:
    """Listens to the run, and makes messages for the page of what it hears."""

    def __init__(self, rate_hz, send, later):
        self.pause_s = 1.0 / rate_hz
        self.nap_s = min(NAP_S, 0.4 * self.pause_s)
        self.send, self.later = send, later
        self.kept = Kept()
        self.lock = threading.Lock()
        self.recording = Recording()
        self.collector = Collector(self.recording)
        self.before = 0.0
        self.raw = None
        self.known = {}
        self.more = []
        self.newest, self.shown = {}, 0.0
        self.packets, self.basket, self.awake = [], threading.Lock(), 0.0
        self.wanted = False
        self.asking = threading.Lock()
        # A name that is subscribed to as AnyMsg is decoded when it is wanted, not when it comes.
        self.always = [
            self.newest_of("/swarm_state", self.hear_state),
            rospy.Subscriber("/acoustic_channel/packets", rospy.AnyMsg, self.hear_packets, buff_size=AT_ONCE, tcp_nodelay=True),
            rospy.Subscriber("/episode_summary", auv_msgs.msg.EpisodeSummary, self.hear_summary, queue_size=200),
            rospy.Subscriber("/scenario", std_msgs.msg.String, self.hear_scenario, queue_size=200),
        ]

    def newest_of(self, topic, take):
        """Subscribes to the newest message that came while the subscriber slept, undecoded."""

        def hear(raw):
            take(raw)
            time.sleep(self.nap_s)

        return rospy.Subscriber(topic, rospy.AnyMsg, hear, queue_size=1, buff_size=AT_ONCE, tcp_nodelay=True)

    def tell(self, kind, data):
        """Keeps a message and sends it to the browsers."""
        self.kept.add(kind, data)
        self.send(data)

    def hear_state(self, raw):
        """Decodes one state now and then, by the wall clock: lockstep has many more."""
        now = time.monotonic()
        if now - self.before < EARLY * self.pause_s:
            self.raw = raw  # the last of a run is not to be missed
            return
        self.before = now
        self.raw = None
        self.take_state(raw)

    def take_state(self, raw):
        """Makes a step of a state as it came."""
        message = auv_msgs.msg.SwarmState().deserialize(raw._buff)
        t = message.header.stamp.to_sec()
        with self.lock:
            self.take_newest()
            # Detections since the step that was shown before count for this one.
            self.collector.seen_s = max(1e-6, t - self.shown)
            self.shown = t
            episode = self.collector.episode
            self.collector.take("/swarm_state", message)
            self.collector.finish()
            steps, self.recording.steps.rows = self.recording.steps.encoded(self.recording.terms), []
            parts, self.recording.parts = self.recording.parts, []
            meta = {key: self.recording.meta[key] for key in ("agents", "targets")}
            if meta != {key: self.known.get(key) for key in meta}:
                self.known.update(meta)
                self.tell("meta", encode("meta", meta=meta))
            if episode != self.collector.episode:
                for part in parts:
                    self.tell("episode", part)
            self.kept.add("steps", steps)
            self.send(encode("meta", meta={"sent_s": time.time()}) + steps)
        if self.wanted and not self.more:  # a browser that came before the run
            self.watch(True)

    def take_newest(self):
        """Decodes what the AUVs said last, where it was not decoded before."""
        newest, self.newest = self.newest, {}
        for topic, (kind, raw) in newest.items():
            self.collector.take(topic, kind().deserialize(raw._buff))

    def hear_packets(self, raw):
        """Sends every packet on, many at once."""
        with self.basket:
            self.packets.append(raw._buff)
            first = len(self.packets) == 1
        if first:
            self.later(0.5 * self.pause_s, self.tell_packets)
        now = time.monotonic()
        if now - self.awake > self.nap_s:
            time.sleep(self.nap_s)
            self.awake = time.monotonic()

    def tell_packets(self):
        """Tells of the packets that came since the last time."""
        with self.lock:
            with self.basket:
                raws, self.packets = self.packets, []
            message = packets_message(raws, self.known.get("agents", 0))
            if message:
                self.tell("packets", message)

    def hear_summary(self, message):
        """Metrics of a finished episode; and its last state and packets."""
        self.tell_packets()
        if self.raw is not None:
            raw, self.raw = self.raw, None
            self.take_state(raw)
        with self.lock:
            self.collector.take("/episode_summary", message)
            parts, self.recording.parts = self.recording.parts, []
            for part in parts:
                self.tell("summary", part)

    def hear_scenario(self, message):
        """What stands still."""
        scene, note = scene_of(message.data)
        with self.lock:
            self.tell("meta", encode("meta", meta=scene))
            if note:
                self.tell("note", encode("note", text=note))

    def watch(self, wanted):
        """Asks for what the AUVs believe while somebody looks, and no longer."""
        self.wanted = wanted
        with self.asking:
            if wanted and not self.more and self.known.get("agents"):
                self.ask()
            elif not wanted and self.more:
                for one in self.more:
                    one.unregister()
                self.more = []
                with self.lock:
                    self.newest = {}
                    self.collector.tasks, self.collector.detections = {}, {}

    def ask(self):
        """Subscribes to what is heard only while somebody looks."""

        def ear(topic, kind):
            def take(raw):
                self.newest[topic] = (kind, raw)

            self.more.append(self.newest_of(topic, take))

        for i in range(self.known["agents"]):
            ear(f"/auv_{i}/task_state", auv_msgs.msg.TaskState)
            ear(f"/auv_{i}/target_detection", auv_msgs.msg.TargetDetection)
        ear("/step_report", auv_msgs.msg.StepReport)
        ear("/acoustic_channel/links", auv_msgs.msg.LinkStates)


class Server:
    """The page and its websocket, in a thread of its own."""

    def __init__(self, port, rate_hz):
        self.loop = asyncio.new_event_loop()
        self.sockets = {}
        self.page = live_page("live run").encode()
        self.port = port
        self.ears = Ears(rate_hz, self.send, self.later)
        self.failure = None
        self.ready = threading.Event()
        threading.Thread(target=self.serve, daemon=True).start()
        self.ready.wait(10.0)

    def serve(self):
        """Runs the loop."""
        asyncio.set_event_loop(self.loop)
        app = web.Application(middlewares=[own_only])
        app.add_routes([web.get("/", self.get_page), web.get("/stream", self.get_stream), web.get("/alive", get_alive)])
        try:
            runner = web.AppRunner(app, access_log=None)
            self.loop.run_until_complete(runner.setup())
            self.loop.run_until_complete(web.TCPSite(runner, HOST, self.port).start())
        except OSError as error:
            self.failure = error
            self.ready.set()
            return
        self.ready.set()
        self.loop.run_forever()

    async def get_page(self, _request):
        """The page."""
        headers = {"Cache-Control": "no-store", "X-Frame-Options": "DENY"}
        return web.Response(body=self.page, content_type="text/html", charset="utf-8", headers=headers)

    async def get_stream(self, request):
        """A browser looks, until it leaves."""
        socket = web.WebSocketResponse(heartbeat=20.0, compress=False)
        await socket.prepare(request)
        queue = asyncio.Queue(400)
        with self.ears.lock:
            history = b"".join([encode("meta", meta={"sent_s": 0}), self.ears.kept.all()])
            self.sockets[socket] = queue
        self.loop.run_in_executor(None, self.ears.watch, True)
        writer = self.loop.create_task(write(socket, history, queue))
        try:
            async for message in socket:
                if message.type == WSMsgType.ERROR:
                    break
        finally:
            writer.cancel()
            self.sockets.pop(socket, None)
            if not self.sockets:
                self.loop.run_in_executor(None, self.ears.watch, False)
        return socket

    def later(self, seconds, action):
        """Has the loop do something; from any thread."""
        self.loop.call_soon_threadsafe(self.loop.call_later, seconds, action)

    def send(self, data):
        """Sends a message to all browsers; from any thread."""
        if self.sockets:
            self.loop.call_soon_threadsafe(self.put, data)

    def put(self, data):
        """A browser that does not keep up misses messages; the run never waits."""
        for queue in list(self.sockets.values()):
            if not queue.full():
                queue.put_nowait(data)


async def write(socket, history, queue):
    """Sends what was before, then what comes, in as few frames as it can."""
    await socket.send_bytes(history)
    while True:
        data = [await queue.get()]
        while not queue.empty():
            data.append(queue.get_nowait())
        await socket.send_bytes(b"".join(data))


async def get_alive(_request):
    """A page asks whether a new run is there."""
    return web.Response(text="yes")


@web.middleware
async def own_only(request, handler):
    """Refuses requests of other hosts' names and of other sites' pages."""
    origin = request.headers.get("Origin", "")
    if not OWN.match(request.headers.get("Host", "")) or (origin and not OWN.match(origin.partition("//")[2])):
        raise web.HTTPForbidden(text="This page is for this machine only.")
    return await handler(request)


def main():
    """Runs until ROS ends it."""
    # It counts by the wall clock alone: a run in lockstep sends /clock at every step.
    rospy.init_node("view_server", disable_signals=False, disable_rostime=True)
    port, rate_hz = rospy.get_param("~port", 8300), rospy.get_param("~rate_hz", 10.0)
    if not (isinstance(port, int) and 1 <= port <= 65535 and isinstance(rate_hz, (int, float)) and 0.1 <= rate_hz <= 100):
        raise PageError(f"port {port} or rate_hz {rate_hz} cannot be: a port is 1 to 65535, a rate 0.1 to 100")
    server = Server(port, float(rate_hz))
    if server.failure:
        raise PageError(f"port {port} of {HOST}: {server.failure.strerror}; choose another one with port:=")
    print(f"view: http://{HOST}:{port}", flush=True)
    rospy.spin()
    return 0


if __name__ == "__main__":
    stg_common.program.run_program("view_server", main, PageError)
