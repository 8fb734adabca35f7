"""Made-up runs for the tests of the view: AUVs circle a target and take turns with packets."""

import math

from stg_view.recording import Recording

HOSTILE = "</script><img src=x onerror=\"document.title='owned'\"><b>&amp;\u202e'\"` ${1}"
LOSS, COLLISION = 2, 3


def made_up(agents=4, half=1.0, steps=60, every=2, bottom=False, name="auv_{}", lost_at=None):
    """A Recording of AUVs that circle a target. every: steps between two packets, 0: there are none. lost_at:
    (row, AUV); from this row on the AUV has lost the target."""
    names = [name.replace("{}", str(i)) for i in range(agents)]
    recording = Recording(
        title="made up", scenario="circles", agents=agents, targets=1, names=names, half_extent_m=half,
        open=bottom, band_m=[0.1 * half, 0.2 * half], sensing_range_m=0.4 * half, radius_m=1e-4 * half,
        lost_distance_m=0.6 * half, decision_s=1.0,
    )  # fmt: skip
    if bottom:
        side = 17
        heights = [-half * (0.2 + 0.1 * math.sin(0.3 * k)) for k in range(side * side)]
        recording.meta["bottom"] = {"nodes": side, "half_extent_m": half, "heights_m": heights}
    recording.add("episode", episode=0, seed=7, start=0.0)
    for k in range(steps):
        add_step(recording, agents, half, k, lost_at)
        if every and k % every == 0 and agents > 1:
            add_packet(recording, agents, k // every % agents, k // every // agents, float(k))
    recording.add("summary", episode=0, metrics={"return": 1.5, "lost_rate": 0.0, "note": names[0]})
    return recording


def add_step(recording, agents, half, k, lost_at=None):
    """Adds one decision."""
    row = {"t": float(k), "position": [], "heading": [], "phase": [], "distance": [], "detected": []}
    row.update(estimate=[], covariance=[], age=[], neighbour_age=[], energy=[])
    target = [0.001 * half * k, 0.0, -0.3 * half]
    for i in range(agents):
        angle, radius = 0.05 * k + 2 * math.pi * i / agents, 0.15 * half
        gone = lost_at is not None and i == lost_at[1] and k >= lost_at[0]
        if gone:
            radius = 0.8 * half
        p = [target[0] + radius * math.cos(angle), radius * math.sin(angle), -0.3 * half]
        row["position"] += p
        row["heading"].append(angle + math.pi / 2)
        row["phase"].append(3 if gone else 2)
        row["distance"].append(math.dist(p, target))
        row["detected"].append(0 if gone else 1)
        row["estimate"] += [target[0] + 0.01 * half, target[1], target[2]]
        row["covariance"] += [1e-4 * half**2, 0, 0, 1e-4 * half**2, 0, 1e-4 * half**2]
        row["age"].append(0.5)
        row["neighbour_age"].append(1.0)
        row["energy"].append(0.1 * k)
    recording.steps.add(**row, target=target, reward=0.1)


def add_packet(recording, agents, source, sequence, t):
    """Adds one packet. Every third receiver has a loss, and every fifth a collision."""
    for receiver in range(agents):
        if receiver != source:
            draw = source + receiver + sequence
            fate = LOSS if draw % 3 == 0 else COLLISION if draw % 5 == 0 else 0
            recording.packets.add(source, receiver, sequence, 32, fate, t, t, t + 0.3, t + 0.4, 10.0, 12.0, 0.1)
