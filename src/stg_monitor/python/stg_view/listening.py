"""Listens to a run and makes messages for the page; used by view_server.py.

A run in lockstep makes many more steps than a page can draw, and other nodes need the processor. So the graph
sends few messages to displays, and this module decodes a message only when it is shown, not when it arrives.
"""

import collections
import math
import struct
import threading
import time

import auv_msgs.msg
import rospy
import std_msgs.msg
from stg_view.from_bag import Collector, scene_of
from stg_view.raw_packets import packets_message
from stg_view.recording import Recording, encode

# Share of the pause after which a step is shown; below 1, so that steps at the rate itself are not missed.
EARLY = 0.8
MOST_KEPT = 24_000_000  # bytes of steps, and of packets, that a late browser gets
MOST_DETECTIONS = 256  # waiting messages of detections
AT_ONCE = 1 << 16  # bytes that are read from a connection at once; the kernel provides the memory anew for each larger read
UNSEEN_S = 2.0  # packets of this time are collected while no browser is connected
UNSEEN_SHARE = 0.002  # largest share of one processor for making steps while no browser is connected


class Kept:
    """Messages for browsers that connect late, in a bounded amount of memory."""

    def __init__(self):
        self.first, self.steps, self.packets = [], [], []
        self.bytes = {"steps": 0, "packets": 0}

    def add(self, kind, data):
        """Stores a message."""
        if kind not in self.bytes:
            self.first.append(data)
            return
        kept = getattr(self, kind)
        kept.append(data)
        self.bytes[kind] += len(data)
        if self.bytes[kind] > MOST_KEPT:
            # Keeps every second step, or the newer half of the packets.
            setattr(self, kind, kept[::2] if kind == "steps" else kept[len(kept) // 2 :])
            self.bytes[kind] = sum(map(len, getattr(self, kind)))

    def all(self):
        """All messages, as one frame of a websocket."""
        return b"".join([*self.first, *self.steps, *self.packets])


class Listener:
    """Listens to the run, and makes messages for the page.

    rate_hz: largest rate of steps on the page. send: sends the bytes of a message to the browsers. later:
    calls an action after some seconds. has_browser: returns whether a browser is connected.
    unseen_share: largest share of one processor for making steps while no browser is connected.
    """

    def __init__(self, rate_hz, send, later, has_browser, unseen_share=UNSEEN_SHARE):
        self.pause_s, self.unseen_share = 1.0 / rate_hz, unseen_share
        self.send, self.later, self.has_browser = send, later, has_browser
        self.kept = Kept()
        self.lock = threading.Lock()
        self.recording = Recording()
        self.collector = Collector(self.recording)
        self.collector.seen_s = math.inf  # it only gets new detections
        self.before, self.work_s = 0.0, 0.0  # when the last step was made, and its processor time
        self.raw, self.awaited = None, False
        self.known = {}
        self.detections = collections.deque(maxlen=MOST_DETECTIONS)
        self.packets, self.collecting, self.basket = [], False, threading.Lock()
        self.subscribers = []
        self.subscribe()

    def subscribe(self):
        """Begins to listen."""
        # A subscription with AnyMsg gets undecoded messages.
        options = {"buff_size": AT_ONCE, "tcp_nodelay": True}
        self.subscribers = [
            rospy.Subscriber("/swarm_display", rospy.AnyMsg, self.hear_display, **options),
            rospy.Subscriber("/swarm_detections", rospy.AnyMsg, self.detections.append, **options),
            rospy.Subscriber("/acoustic_channel/packets", rospy.AnyMsg, self.hear_packets, **options),
            rospy.Subscriber("/episode_summary", auv_msgs.msg.EpisodeSummary, self.hear_summary, queue_size=200),
            rospy.Subscriber("/scenario", std_msgs.msg.String, self.hear_scenario, queue_size=200),
        ]

    def unsubscribe(self):
        """Stops listening; the run then makes nothing for the view."""
        for subscriber in self.subscribers:
            subscriber.unregister()
        self.subscribers = []

    def tell(self, kind, data):
        """Stores a message and sends it to the browsers."""
        self.kept.add(kind, data)
        self.send(data)

    def history(self):
        """Everything that a new browser needs. The caller holds the lock."""
        if not self.has_browser():  # otherwise the packets are sent soon, to the new browser as well
            self.tell_packets()
        return self.kept.all()

    def hear_display(self, raw):
        """Shows a step, if the previous one was long enough ago."""
        with self.lock:
            if self.is_due():
                self.take_step(raw)
                return
            self.raw = raw
            self.await_due()

    def pause(self):
        """Shortest time between two steps [s]. Without a browser, making steps may cost little."""
        return self.pause_s if self.has_browser() else max(self.pause_s, self.work_s / self.unseen_share)

    def is_due(self):
        """True if the previous step was long enough ago."""
        return time.monotonic() - self.before >= EARLY * self.pause()

    def await_due(self):
        """Shows a step that came too early after the pause, if no other one comes. The run may pause there."""
        if not self.awaited:
            self.awaited = True
            self.later(self.pause(), self.take_newest)

    def take_newest(self):
        """Shows the step that came too early."""
        with self.lock:
            self.awaited = False
            if self.raw is not None and self.is_due():
                self.take_step(self.raw)
            elif self.raw is not None:
                self.await_due()

    def take_step(self, raw):
        """Makes a step from a message for displays. The caller holds the lock."""
        self.before, self.raw = time.monotonic(), None
        begin = time.thread_time()
        self.make_step(raw)
        self.work_s = time.thread_time() - begin

    def make_step(self, raw):
        """The same, without a look at the clock."""
        message = auv_msgs.msg.SwarmDisplay().deserialize(raw._buff)
        collector, episode = self.collector, self.collector.episode
        collector.take("/swarm_state", message.state)
        collector.detections = {}
        self.take_detections(stamp_of(raw))
        for i, task in zip(message.agents, message.tasks):
            collector.take(f"/auv_{i}/task_state", task)
        if message.report.agent_rewards:
            collector.take("/step_report", message.report)
        if message.links.links:
            collector.take("/acoustic_channel/links", message.links)
        collector.finish()
        steps, self.recording.steps.rows = self.recording.steps.encoded(self.recording.terms), []
        parts, self.recording.parts = self.recording.parts, []
        meta = {key: self.recording.meta[key] for key in ("agents", "targets")}
        if meta != {key: self.known.get(key) for key in meta}:
            self.known.update(meta)
            self.tell("meta", encode("meta", meta=meta))
        if episode != collector.episode:
            for part in parts:
                self.tell("episode", part)
        self.kept.add("steps", steps)
        self.send(encode("meta", meta={"sent_s": time.time()}) + steps)

    def take_detections(self, stamp):
        """Takes the newest detection of each AUV that no step has shown and that is not later than this step."""
        raws, seen = [], set()
        while self.detections and stamp_of(self.detections[0]) <= stamp:
            raws.append(self.detections.popleft())
        while raws and len(seen) < self.known.get("agents", math.inf):
            message = auv_msgs.msg.SwarmDetections().deserialize(raws.pop()._buff)
            for i, detection in zip(message.agents, message.detections):
                if i not in seen:
                    self.collector.take(f"/auv_{i}/target_detection", detection)
            seen.update(message.agents)

    def hear_packets(self, raw):
        """Collects packets; they are sent soon."""
        with self.basket:
            self.packets.append(raw._buff)
            first, self.collecting = not self.collecting, True
        if first:
            self.later(self.pause_s if self.has_browser() else UNSEEN_S, self.tell_collected)

    def tell_collected(self):
        """Sends the packets since the last call."""
        with self.basket:
            self.collecting = False
        with self.lock:
            self.tell_packets()

    def tell_packets(self):
        """The same; the caller holds the lock."""
        with self.basket:
            raws, self.packets = self.packets, []
        message = packets_message(raws, self.known.get("agents", 0))
        if message:
            self.tell("packets", message)

    def hear_summary(self, message):
        """Sends the metrics of a finished episode, after its last step and packets."""
        with self.lock:
            self.tell_packets()
            if self.raw is not None:
                self.take_step(self.raw)
            self.collector.take("/episode_summary", message)
            parts, self.recording.parts = self.recording.parts, []
            for part in parts:
                self.tell("summary", part)

    def hear_scenario(self, message):
        """Sends the static part of the scene."""
        scene, note = scene_of(message.data)
        with self.lock:
            self.tell("meta", encode("meta", meta=scene))
            if note:
                self.tell("note", encode("note", text=note))


def stamp_of(raw):
    """The stamp of an undecoded message that begins with a header: (s, ns)."""
    return struct.unpack_from("<II", raw._buff, 4)
