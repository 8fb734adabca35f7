"""Recordings of ROS runs: turns messages of the graph, from a bag or live, into messages for the page.

It uses only the fields of ROS messages. Fields that a message does not have (an older bag) are left out.
"""

import json
import math
import subprocess

from stg_view.recording import FATES, Recording

NAN = math.nan
DELIVERED, DROPPED = 3, 4
NO_SEQUENCE = 4294967295
TERMS = ("r_track", "r_obs", "r_coord", "r_comm", "r_sem", "r_sep", "cost")
MOST_AUVS = 256
STEPS_LATE = 8  # steps by which a message in a bag may come after the state that it belongs to


def scene_of(scenario, tool=("rosrun", "stg_monitor", "view_scene")):
    """The static part of a resolved scenario, and a note if it is unknown."""
    try:
        done = subprocess.run(tool, input=scenario.encode(), capture_output=True, timeout=30, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return {}, f"The scenario's scene is not known: {error}"
    if done.returncode != 0:
        lines = done.stderr.decode("utf-8", "replace").strip().splitlines()
        return {}, f"The scenario's scene is not known: {lines[-1] if lines else 'no answer'}"
    scene = json.loads(done.stdout)
    return scene, ""


class Collector:
    """Puts the messages of a graph, one after the other, into a Recording.

    wait: number of steps for which a state waits for messages of the agents. Messages of different nodes come
    in any order; messages that belong together have the same stamp.
    """

    def __init__(self, recording, wait=0):
        self.recording, self.wait = recording, wait
        self.episode = None
        self.tasks, self.detections, self.reports, self.energy = {}, {}, {}, []  # newest messages of each
        self.ages = {}
        self.counts = ([], [])
        self.states = []
        self.scenario = ""
        self.seen_s = 1e-6  # largest time between a step and a detection that belongs to it

    def take(self, topic, m):
        """Takes one message. Messages of topics that are not shown are ignored."""
        if topic == "/swarm_state":
            self.take_state(m)
        elif topic == "/acoustic_channel/packets":
            for event in m.events:
                self.take_packet(event)
        elif topic.endswith("/task_state"):
            self.keep(self.tasks, _auv_of(topic), m)
        elif topic.endswith("/target_detection"):
            self.keep(self.detections, _auv_of(topic), m)
        elif topic == "/step_report":
            self.keep(self.reports, "report", m)
        elif topic == "/acoustic_channel/links":
            self.take_links(m)
        elif topic == "/episode_summary":
            names = [n for n in m.__slots__ if n not in ("header", "episode", "seed", "scenario")]
            self.recording.add("summary", episode=int(m.episode), metrics={n: getattr(m, n) for n in names})
        elif topic == "/scenario":
            self.scenario = m.data

    def keep(self, kept, key, m):
        """Stores a message together with the others that may still be needed."""
        messages = kept.setdefault(key, [])
        messages.append(m)
        del messages[: -2 * self.wait - 2]

    def take_links(self, m):
        """Stores the energies, and the age of the newest packets that each AUV has of the others."""
        self.energy = list(getattr(m, "energy", []))
        sums = {}
        for link in m.links:
            total, count = sums.get(link.destination, (0.0, 0))
            sums[link.destination] = (total + link.age, count + 1)
        self.ages = {i: total / count for i, (total, count) in sums.items()}

    def take_state(self, m):
        """A step has ended. A state that has waited long enough becomes a row."""
        while len(self.states) > (self.wait if m.episode == self.episode else 0):
            self.add_row(*self.states.pop(0))
        meta, n = self.recording.meta, len(m.poses)
        if n > MOST_AUVS:
            raise ValueError(f"{n} AUVs, more than {MOST_AUVS}")
        meta["agents"] = max(n, meta.get("agents", 0))
        meta["targets"] = max(len(m.target_positions), meta.get("targets", 0))
        if m.episode != self.episode:
            self.episode = m.episode
            self.tasks, self.detections, self.reports = {}, {}, {}
            self.counts = ([], [])
            seed = int(m.seed)
            self.recording.add("episode", episode=int(m.episode), seed=seed, start=m.header.stamp.to_sec())
        self.states.append((m, self.ages, self.energy))

    def finish(self):
        """Makes rows from the states that still wait."""
        while self.states:
            self.add_row(*self.states.pop(0))

    def add_row(self, m, ages, energy):
        """Makes a row from a state and the agents' messages about it."""
        n = len(m.poses)
        t = m.header.stamp.to_sec()
        targets = [(p.x, p.y, p.z) for p in m.target_positions]
        row = {"t": t, "position": [], "heading": [], "pitch": [], "phase": [], "distance": []}
        row.update(estimate=[], covariance=[], age=[], detected=[], range=[])
        for i, pose in enumerate(m.poses):
            self.add_vehicle(row, t, i, pose, targets)
        row["target"] = [x for p in targets for x in p]
        if len(targets) > 1:
            row["followed"] = [self.followed(i, t, len(targets)) for i in range(n)]
        row["neighbour_age"] = [ages.get(i, NAN) for i in range(n)]
        row["aground"] = self.touches(m, n)
        if len(m.fresh) == n:
            row["fresh"] = [int(x) for x in m.fresh]
        if len(energy) == n and any(energy):
            row["energy"] = energy
        report = _at(self.reports, "report", t)
        if report is not None:
            row["reward"] = report.reward
            terms = [getattr(report, name) for name in TERMS]
            if all(len(values) == n for values in terms):
                row["terms"] = [values[i] for i in range(n) for values in terms]
                self.recording.terms = [name.replace("r_", "") for name in TERMS]
        self.recording.steps.add(**row)

    def followed(self, i, t, targets):
        """The target that AUV i follows, from its message; older bags do not contain it."""
        chosen = getattr(_at(self.tasks, i, t), "target", i % targets)
        return chosen if chosen < targets else i % targets

    def touches(self, m, n):
        """Which AUVs touched the bottom (1) or an obstacle (2) in this step; older bags do not contain it."""
        counts = [list(getattr(m, name, ())) for name in ("groundings", "collisions")]
        before, self.counts = self.counts, counts
        found = [0] * n
        for kind, (now, was) in enumerate(zip(counts, before), start=1):
            for i in range(min(n, len(now), len(was))):
                if now[i] > was[i]:
                    found[i] = kind
        return found

    def add_vehicle(self, row, t, i, pose, targets):
        """Adds one AUV to a row."""
        p, q = pose.position, pose.orientation
        row["position"] += [p.x, p.y, p.z]
        row["heading"].append(math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z)))
        # Up is positive here, but negative about the body's y axis.
        row["pitch"].append(-math.asin(max(-1.0, min(1.0, 2 * (q.w * q.y - q.z * q.x)))))
        target = targets[self.followed(i, t, len(targets))] if targets else (NAN,) * 3
        row["distance"].append(math.dist(target, (p.x, p.y, p.z)))
        task, detection = _at(self.tasks, i, t), _at(self.detections, i, t)
        known = task is not None and task.target_known
        place = task.target_position if known else None
        row["phase"].append(task.phase if task is not None and task.phase < 4 else 255)
        row["estimate"] += [place.x, place.y, place.z] if known else [NAN] * 3
        row["covariance"] += list(task.target_covariance) if known else [NAN] * 6
        row["age"].append(task.target_age if known else NAN)
        seen = detection is not None and abs(detection.header.stamp.to_sec() - t) < self.seen_s
        row["detected"].append(int(seen))
        row["range"].append(detection.range if seen and detection.kind == 1 else NAN)

    def take_packet(self, e):
        """Adds one packet and receiver with a known fate."""
        if e.kind not in (DELIVERED, DROPPED):
            return
        fate = 0 if e.kind == DELIVERED else min(int(e.reason), len(FATES) - 1)
        stamp = lambda time: time.to_sec() if time.to_sec() > 0 else NAN
        left = e.sequence != NO_SEQUENCE
        transmit = stamp(e.transmit) if left else NAN
        # A packet that never left counts for all AUVs that it is addressed to.
        agents = self.recording.meta.get("agents", 0)
        receivers = [e.receiver] if e.receiver >= 0 else [e.destination] if e.destination >= 0 else [
            i for i in range(agents) if i != e.source
        ]  # fmt: skip
        for receiver in receivers:
            self.recording.packets.add(
                int(e.source), int(receiver), int(e.sequence) % (1 << 31) if left else -1, int(e.bytes),
                fate, stamp(e.offered), transmit, transmit + e.airtime, stamp(e.arrival), e.distance,
                e.sinr_db, e.loss_probability,
            )  # fmt: skip


def _at(kept, key, t):
    """The stored message whose stamp is nearest to a time; None if there is none."""
    return min(kept.get(key, ()), key=lambda m: abs(m.header.stamp.to_sec() - t), default=None)


def _auv_of(topic):
    """The number in /auv_<i>/...; raises ValueError if there is none."""
    return int(topic.split("/")[1].rpartition("_")[2])


TOPICS = ("/swarm_state", "/acoustic_channel/packets", "/acoustic_channel/links", "/step_report",
          "/episode_summary", "/scenario")  # fmt: skip
OF_AUV = ("task_state", "target_detection")


def read_bag(path, salvage, title):
    """The bytes of the recording of a bag. Raises BagError for damage, and LookupError if there is no run."""
    # Only this function needs ROS.
    from stg_view.bag_reading import BagError, messages, open_bag

    recording = Recording(title=title)
    collector, topic = Collector(recording, wait=STEPS_LATE), ""
    with open_bag(path, salvage) as bag:
        try:
            for topic, message in messages(bag, path):
                parts = topic.split("/")
                if topic in TOPICS or (len(parts) == 3 and parts[1].startswith("auv_") and parts[2] in OF_AUV):
                    collector.take(topic, message)
            collector.finish()
        except (AttributeError, TypeError, ValueError, LookupError, OverflowError) as error:
            raise BagError(f"{path}: {topic}: not of the form that this program records: {error}") from None
        except BagError as error:
            # The messages before the damage are complete.
            if not salvage or not recording.steps.rows:
                raise
            recording.notes.append(f"The bag is damaged; what is before the damage is shown ({error}).")
    if not recording.steps.rows and not recording.packets.rows:
        raise LookupError(f"{path}: holds neither /swarm_state nor /acoustic_channel/packets: not a recorded run")
    if collector.scenario:
        scene, note = scene_of(collector.scenario)
        known = {key: value for key, value in scene.items() if key not in recording.meta}
        recording.meta.update(known)
        if note:
            recording.notes.append(note)
    if "agents" not in recording.meta:
        nodes = 1 + max(max(row[0], row[1]) for row in recording.packets.rows)
        recording.meta.update(agents=min(nodes, MOST_AUVS), targets=0)
    return recording.encoded()
