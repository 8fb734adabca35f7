#!/usr/bin/python3
"""An agent in Python that flies one AUV of a graph whose other AUVs fly themselves:

roslaunch stg_bringup medium.launch external:=[2]
rosrun stg_python agent.py __ns:=auv_2 _id:=2 _policy:=FILE.onnx
"""

import argparse
import queue
import sys

import rospy
from auv_msgs.msg import AcousticPacket, AcousticReception, SensorFrame, TaskState
from geometry_msgs.msg import Point, Twist, TwistStamped, Vector3
from std_msgs.msg import Header

import stg


def xyz(v):
    """The numbers of a geometry message."""
    return v.x, v.y, v.z


def main():
    """Decides for each step, once its sensor frame and the modem's window before it have come."""
    shape = argparse.RawDescriptionHelpFormatter
    argparse.ArgumentParser(description=__doc__, formatter_class=shape).parse_args(rospy.myargv()[1:])
    rospy.init_node("agent")
    me, graph = rospy.get_param("~id"), rospy.get_param
    changes = [f"agents={graph('/agents')}", *graph("/overrides", []), "mode=acoustic"]
    changes += [f'plugins=["{library}"]' for library in graph("/plugins", [])]
    scenario = stg.load_scenario(graph("/scenario"), graph("/condition"), changes)
    mind, policy = stg.Agent(scenario, me), stg.load_policy(graph("~policy"))
    policy.require_fits(scenario)
    topics = (("cmd_vel", TwistStamped), ("acoustic/tx", AcousticPacket), ("task_state", TaskState))
    command, offer, report = (
        rospy.Publisher(f"/auv_{me}/{name}", kind, queue_size=50, tcp_nodelay=True, latch=True)
        for name, kind in topics
    )
    heard = queue.Queue()
    for name, kind in (("sensor_frame", SensorFrame), ("acoustic/rx", AcousticReception)):
        rospy.Subscriber(f"/auv_{me}/{name}", kind, heard.put, tcp_nodelay=True)
    frame, packets, window, start, sent = None, [], -1, None, 0
    while not rospy.is_shutdown():
        try:
            message = heard.get(timeout=0.2)
        except queue.Empty:
            continue
        if isinstance(message, SensorFrame):
            frame = message
        else:
            window = message.header.stamp.to_nsec()
            packets += [(window, packet) for packet in message.packets]
        # No window ends at step 0. Only before the run's first step the modem sends one.
        awaited = frame is not None and (frame.step > 0 or frame.episode == 0)
        if frame is None or (awaited and window < frame.header.stamp.to_nsec()):
            continue

        now = frame.header.stamp.to_nsec()
        begun = now - frame.step * round(1e9 * scenario.decision_dt_s)
        if begun != start:  # an episode begins, and its clock starts at 0
            start, sent = begun, 0
            cue = xyz(frame.cue_position) if frame.cue_valid else None
            mind.reset(frame.seed, frame.episode, cue, frame.cue_std)
        for end, packet in packets:
            if start < end <= now:
                mind.receive(packet.data, packet.arrival.to_nsec() - start)
        packets = [(end, packet) for end, packet in packets if end > now]
        for d in frame.detections:
            mind.detect(now - start, xyz(d.position), d.variance.x**0.5, d.target)
        q, twist = frame.pose.orientation, frame.twist
        observation = mind.observe(
            now - start, xyz(frame.pose.position), (q.w, *xyz(q)), xyz(twist.linear), xyz(twist.angular)
        )
        done = mind.act(policy.mean(observation))

        stamp = frame.header.stamp
        world, body = Header(stamp=stamp, frame_id="world"), Header(stamp=stamp, frame_id=f"auv_{me}/base_link")
        command.publish(TwistStamped(world, Twist(linear=Vector3(*done["cmd_vel"]))))
        if mind.packet_due(now - start):
            offer.publish(AcousticPacket(body, me, -1, sent, stamp, mind.make_packet()))
            sent += 1
        track = mind.track
        report.publish(TaskState(
            header=world, episode=frame.episode, step=frame.step, policy_id=policy.metadata["id"],
            target_position=Point(*track["p_WT"]), target_velocity=Vector3(*track["v_WT"]), **mind.task(),
        ))  # fmt: skip
        frame = None


if __name__ == "__main__":
    try:
        main()
    except stg.UserError as error:
        print(f"agent: {error}", file=sys.stderr)
        sys.exit(2)  # this ends the run, as a node of the suite does
