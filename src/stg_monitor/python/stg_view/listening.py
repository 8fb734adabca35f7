"""Listens to a run and makes messages for the page of what it hears; used by view_server.py.

A run in lockstep speaks much more often than a page is drawn: a subscriber sleeps between two looks at
what came, and of all but the packets only what is shown is decoded. A step shows a state, and what the
AUVs said at the same time.
"""

import collections
import functools
import struct
import threading
import time

import auv_msgs.msg
import rospy
import std_msgs.msg
from stg_view.from_bag import Collector, scene_of
from stg_view.raw_packets import packets_message
from stg_view.recording import Recording, encode

DISPLAY_HZ = 20.0  # of the states that a world sends to displays
NAP_S = 0.04  # between two looks at what came
EARLY = 0.8  # share of the pause after which a state is taken: what comes at the rate itself is not to be missed
MOST_KEPT = 24_000_000  # bytes of steps, and of packets, that a late browser is sent
AT_ONCE = 1 << 22  # bytes that are taken from a connection at once
ANSWER_S = 0.06  # for which a state waits for what the AUVs say of it
MOST_ANSWERS = 32  # of one topic that are kept undecoded: what lockstep makes in one nap


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
        self.answers, self.decoded, self.shown = {}, {}, 0.0
        self.waiting = None  # a state that not all AUVs have answered yet
        self.packets, self.basket, self.awake = [], threading.Lock(), 0.0
        self.wanted = False
        self.asking = threading.Lock()
        # A name that is subscribed to as AnyMsg is decoded when it is wanted, not when it comes.
        self.every = self.newest_of("/swarm_state", self.hear_state)
        if rate_hz <= DISPLAY_HZ:
            self.display = self.newest_of("/swarm_state_display", self.hear_display)
        self.always = [
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

    def many_of(self, topic, take):
        """The same, of the last messages instead of the newest one."""
        awake = time.monotonic()

        def hear(raw):
            nonlocal awake
            take(raw)
            if time.monotonic() - awake > self.nap_s:
                time.sleep(self.nap_s)
                awake = time.monotonic()

        return rospy.Subscriber(topic, rospy.AnyMsg, hear, queue_size=MOST_ANSWERS, buff_size=AT_ONCE, tcp_nodelay=True)

    def hear_answer(self, kept, raw):
        """Keeps a message; the last one that a state waited for ends its wait."""
        kept.append(raw)
        state = self.waiting
        if state is not None and stamp_of(raw) == stamp_of(state) and self.is_answered(state):
            self.take_waiting(state)

    def tell(self, kind, data):
        """Keeps a message and sends it to the browsers."""
        self.kept.add(kind, data)
        self.send(data)

    def hear_display(self, raw):
        """A world sends few states to displays, which are enough; a bag that is played has no such topic."""
        if self.every is not None:
            self.every.unregister()
            self.every = None
        self.hear_state(raw)

    def hear_state(self, raw):
        """Decodes one state now and then, by the wall clock: lockstep has many more."""
        now = time.monotonic()
        if now - self.before < EARLY * self.pause_s:
            self.raw = raw  # the last of a run is not to be missed
            return
        self.before = now
        self.raw = None
        self.take_waiting()
        self.waiting = raw
        if not self.more or self.is_answered(raw):
            self.take_waiting(raw)
        else:
            self.later(ANSWER_S, functools.partial(self.take_waiting, raw))

    def is_answered(self, state):
        """Whether all AUVs have said what they believe at the time of a state."""
        stamp = stamp_of(state)
        tasks = [kept for kind, kept in self.answers.values() if kind is auv_msgs.msg.TaskState]
        return all(any(stamp_of(raw) == stamp for raw in list(kept)) for kept in tasks)

    def take_waiting(self, state=None):
        """Makes a step of the state that waits; of a given one, unless another has taken its place."""
        with self.lock:
            raw = self.waiting
            if raw is None or (state is not None and raw is not state):
                return
            self.waiting = None
        self.take_state(raw)

    def take_state(self, raw):
        """Makes a step of a state as it came."""
        message = auv_msgs.msg.SwarmState().deserialize(raw._buff)
        t = message.header.stamp.to_sec()
        with self.lock:
            # Detections since the step that was shown before count for this one.
            self.collector.seen_s = max(1e-6, t - self.shown)
            self.shown = t
            episode = self.collector.episode
            self.collector.take("/swarm_state", message)
            self.take_answers(stamp_of(raw), message.episode)
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

    def take_answers(self, stamp, episode):
        """Decodes the newest message of each topic that is not later than a state, nor of another episode."""
        for topic, (kind, kept) in list(self.answers.items()):
            raw = next((r for r in reversed(list(kept)) if stamp_of(r) <= stamp), None)
            if raw is not None and raw is not self.decoded.get(topic):
                self.decoded[topic] = raw
                message = kind().deserialize(raw._buff)
                if getattr(message, "episode", episode) == episode:
                    self.collector.take(topic, message)

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
        self.take_waiting()
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
                    self.answers, self.decoded = {}, {}
                    self.collector.tasks, self.collector.detections = {}, {}

    def ask(self):
        """Subscribes to what is heard only while somebody looks."""

        def ear(topic, kind):
            kept = collections.deque(maxlen=MOST_ANSWERS)
            self.answers[topic] = (kind, kept)
            self.more.append(self.many_of(topic, functools.partial(self.hear_answer, kept)))

        for i in range(self.known["agents"]):
            ear(f"/auv_{i}/task_state", auv_msgs.msg.TaskState)
            ear(f"/auv_{i}/target_detection", auv_msgs.msg.TargetDetection)
        ear("/step_report", auv_msgs.msg.StepReport)
        ear("/acoustic_channel/links", auv_msgs.msg.LinkStates)


def stamp_of(raw):
    """The stamp of an undecoded message that begins with a header: (s, ns)."""
    return struct.unpack_from("<II", raw._buff, 4)
