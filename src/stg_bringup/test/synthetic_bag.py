#!/usr/bin/python3
"""Writes a small bag with the topics of a run. Its contents follow from closed forms.

AUV i is `distance_at(t)` from the target in a fixed direction. Every fifth packet of each link is lost. Also
usable by hand: synthetic_bag.py FILE [SECONDS].
"""

import math
import sys

import auv_msgs.msg
import geometry_msgs.msg
import nav_msgs.msg
import rosbag
import rospy
import std_msgs.msg
import tf2_msgs.msg

AGENTS = 4
STEP_S = 0.1
SCENARIO = """name: synthetic
agents: 4
time: {tail_steps: 20}
vehicle: {radius_m: 0.011}
workspace: {half_extent_m: 1.0}
sensing: {range_m: 0.45}
reward: {band_m: [0.01, 0.015], desired_distance_m: 0.015}
"""
TASK = auv_msgs.msg.TaskState


def distance_at(t):
    """Distance [m] of every AUV to the target at time t [s]."""
    return 0.0145 + 0.45 * math.exp(-t / 3.0)


def target_at(t):
    """Position [m] of the target at time t [s]."""
    return (0.2 + 0.005 * t, -0.1 + 0.002 * t, 0.05)


def direction(i):
    """Unit vector from the target to AUV i."""
    angle, height = 2.0 * math.pi * i / AGENTS + 0.4, 0.3 - 0.2 * i
    flat = math.sqrt(1.0 - height * height)
    return (flat * math.cos(angle), flat * math.sin(angle), height)


def auv_at(i, t):
    """Position [m] of AUV i at time t [s]."""
    return tuple(p + distance_at(t) * u for p, u in zip(target_at(t), direction(i)))


def phase_at(t):
    """Phase of every AUV at time t [s]."""
    if t < 0.5:
        return TASK.SEARCH
    return TASK.APPROACH if distance_at(t) > 0.1 else TASK.STABLE


def odometry(frame, stamp, position, bow):
    """An Odometry at `position`, level. Its bow points along the horizontal part of `bow`."""
    message = nav_msgs.msg.Odometry()
    message.header.stamp, message.header.frame_id = stamp, "world"
    message.child_frame_id = frame
    message.pose.pose.position = geometry_msgs.msg.Point(*position)
    yaw = math.atan2(bow[1], bow[0])
    message.pose.pose.orientation.z = math.sin(0.5 * yaw)
    message.pose.pose.orientation.w = math.cos(0.5 * yaw)
    return message


def transform(odom):
    """The transform that belongs to an Odometry."""
    message = geometry_msgs.msg.TransformStamped(header=odom.header)
    message.child_frame_id = odom.child_frame_id
    position = odom.pose.pose.position
    message.transform.translation = geometry_msgs.msg.Vector3(position.x, position.y, position.z)
    message.transform.rotation = odom.pose.pose.orientation
    return message


def link_states(stamp, k):
    """All links at step k: each link has a packet every fifth step, and loses every fifth packet."""
    states = auv_msgs.msg.LinkStates()
    states.header.stamp, states.header.frame_id = stamp, "world"
    for source in range(AGENTS):
        for destination in range(AGENTS):
            if source == destination:
                continue
            sent = (k - source) // 5 + 1
            lost = (sent + destination) // 5
            link = auv_msgs.msg.LinkState(source=source, destination=destination)
            link.distance = math.dist(auv_at(source, k * STEP_S), auv_at(destination, k * STEP_S))
            link.quality = 0.9 * math.exp(-link.distance)
            link.loss_probability, link.delay = 0.2, link.distance / 1500.0
            link.age = STEP_S * ((k - source) % 5)
            link.delivered, link.dropped = max(sent - lost, 0), max(lost, 0)
            link.last_drop_reason = link.LOSS if lost > 0 else link.NONE
            states.links.append(link)
    return states


def task_state(stamp, k, i):
    """What AUV i believes at step k, which is the truth."""
    t = k * STEP_S
    task = TASK(step=k, phase=phase_at(t), quality=TASK.HIGH, role=i == 0, target_known=True)
    task.header.stamp, task.header.frame_id = stamp, "world"
    task.target_position = geometry_msgs.msg.Point(*target_at(t))
    task.target_std = 0.002
    task.target_distance = distance_at(t)
    task.tracking_error = abs(distance_at(t) - 0.015)
    task.confidence = max(0.0, 1.0 - distance_at(t) / 0.45)
    task.action = [0.1, 0.0, 0.0]
    task.policy_id = "synthetic"
    return task


def step_report(stamp, k, steps):
    """The rewards of step k."""
    report = auv_msgs.msg.StepReport(step=k, reward=0.5, truncated=k == steps - 1)
    report.header.stamp, report.header.frame_id = stamp, "world"
    report.agent_rewards = [0.5] * AGENTS
    report.distances = [distance_at((k + 1) * STEP_S)] * AGENTS
    return report


def write(path, seconds=20.0):
    """Writes the bag of one episode of `seconds`."""
    steps = int(round(seconds / STEP_S))
    with rosbag.Bag(path, "w", chunk_threshold=32 * 1024) as bag:
        start = rospy.Time(1, 0)
        bag.write("/scenario", std_msgs.msg.String(SCENARIO), start)
        for k in range(steps):
            stamp, t = start + rospy.Duration(nsecs=100_000_000 * k), k * STEP_S
            target = odometry("target_0", stamp, target_at(t), (1.0, 0.0))
            target.twist.twist.linear = geometry_msgs.msg.Vector3(0.005, 0.002, 0.0)
            bag.write("/target_0/odom", target, stamp)
            frames = [transform(target)]
            for i in range(AGENTS):
                bow = tuple(-u for u in direction(i))
                odom = odometry(f"auv_{i}/base_link", stamp, auv_at(i, t), bow)
                bag.write(f"/auv_{i}/odom", odom, stamp)
                bag.write(f"/auv_{i}/task_state", task_state(stamp, k, i), stamp)
                frames.append(transform(odom))
            bag.write("/tf", tf2_msgs.msg.TFMessage(frames), stamp)
            bag.write("/acoustic_channel/links", link_states(stamp, k), stamp)
            end = stamp + rospy.Duration(nsecs=100_000_000)
            bag.write("/step_report", step_report(end, k, steps), end)
        summary = auv_msgs.msg.EpisodeSummary(scenario="synthetic", steps=steps, complete=True)
        summary.header.stamp = end
        summary.episode_return = 0.5 * AGENTS * steps
        summary.field, summary.spread = True, 0.75
        bag.write("/episode_summary", summary, end)


if __name__ == "__main__":
    write(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 20.0)
