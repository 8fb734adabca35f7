#include <cmath>
#include <utility>

#include "acoustic_channel/nodes/topics.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/conversions.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "fleet_node.hpp"

/// Messages from vehicles: accepted, kept for later judgement, or refused.
namespace stg::nodes {
namespace {

constexpr std::size_t kMostDoubtful = 10'000;
/// Most frames that diagnostics list, and most characters of each.
constexpr std::size_t kMostFrames = 8, kFrameText = 64;
/// A message of the clock that is on its way arrives within this wall time.
constexpr double kDoubt_s = 0.5;

using Word = acoustics::FleetChannel::Word;

}  // namespace

TimeNs FleetNode::Clock() const { return bag_.empty() ? NsOf(ros::Time::now()) : now_; }

bool FleetNode::Timely(TimeNs stamp) const {
  const TimeNs now = Clock();
  return now > 0 && std::abs(stamp - now) <= tolerance_;
}

void FleetNode::Judge(TimeNs stamp, std::function<void(bool)> decide) {
  if (Timely(stamp)) return decide(true);
  if (!bag_.empty() || doubtful_.size() >= kMostDoubtful) return decide(false);
  doubtful_.push_back({stamp, WallSeconds(), std::move(decide)});
}

/// Judges the doubtful messages again, in the order of their arrival.
void FleetNode::JudgeAgain() {
  const double wall_s = WallSeconds();
  for (std::size_t left = doubtful_.size(); left > 0; --left) {
    Doubtful d = std::move(doubtful_.front());
    doubtful_.pop_front();
    const bool timely = Timely(d.stamp);
    if (timely || wall_s - d.since_s > kDoubt_s) {
      d.decide(timely);
    } else {
      doubtful_.push_back(std::move(d));
    }
  }
}

void FleetNode::OnOdometry(int vehicle, const nav_msgs::Odometry::ConstPtr& message) {
  const auto& pose = message->pose.pose;
  const auto& twist = message->twist.twist;
  if (!frame_.empty() && message->header.frame_id != frame_) {
    return RefuseOdometry(
        vehicle, Refusals::kFrame,
        "frame '" + message->header.frame_id.substr(0, kFrameText) + "' instead of " + frame_);
  }
  // The orientation is only needed if the twist is in the body frame.
  const bool placed = twist_ == TwistFrame::kBody ? FinitePose(pose) : FiniteVector(pose.position);
  if (!placed || (twist_ != TwistFrame::kNone && !FiniteVector(twist.linear))) {
    return RefuseOdometry(vehicle, Refusals::kNotFinite,
                          "a number is not finite, or the orientation is not a rotation");
  }
  const TimeNs stamp = NsOf(message->header.stamp);
  Judge(stamp, [this, vehicle, message, stamp](bool timely) {
    if (timely) return Place(vehicle, *message);
    RefuseOdometry(vehicle, Refusals::kStale, FarFromTheClock(stamp));
  });
}

void FleetNode::Place(int vehicle, const nav_msgs::Odometry& message) {
  acoustics::Motion motion;
  motion.p_W = VectorOf(message.pose.pose.position);
  if (twist_ == TwistFrame::kBody) {
    motion.v_W = WorldVelocity(message.pose.pose, message.twist.twist);
  } else if (twist_ == TwistFrame::kWorld) {
    motion.v_W = VectorOf(message.twist.twist.linear);
  }
  if (fleet_.Move(vehicle, NsOf(message.header.stamp), motion) == Word::kLate) {
    return RefuseOdometry(vehicle, Refusals::kStale,
                          "the message arrived after the time of its stamp");
  }
  ++odometry_;
  if (frames_.size() < kMostFrames) frames_.insert(message.header.frame_id.substr(0, kFrameText));
}

void FleetNode::OnPacket(int vehicle, const auv_msgs::AcousticPacket::ConstPtr& message) {
  const bool now = message->header.stamp.isZero();
  const TimeNs stamp = now ? Clock() : NsOf(message->header.stamp);
  Judge(stamp, [this, vehicle, message, stamp](bool timely) {
    if (timely) return Offer(vehicle, *message, stamp);
    RefusePacket(vehicle, *message, Refusals::kStale, FarFromTheClock(stamp));
  });
}

void FleetNode::Offer(int vehicle, const auv_msgs::AcousticPacket& message, TimeNs stamp) {
  const auto refuse = [&](const std::string& why) {
    RefusePacket(vehicle, message, Refusals::kMalformed, why);
  };
  acoustics::Transmission packet;
  packet.source = vehicle;
  packet.destination = message.destination == acoustics::kToAll
                           ? acoustics::kToAll
                           : IndexOf(vehicles_, message.destination);
  packet.stamp = stamp;
  packet.generation = message.generation.isZero() ? stamp : NsOf(message.generation);
  packet.tag = message.sequence;
  packet.payload = acoustics::ViewOf(message.data);
  if (packet.destination == kNoVehicle) {
    return refuse("destination " + std::to_string(message.destination) + " does not exist");
  }
  if (packet.destination == vehicle) return refuse("the destination of the packet is its sender");
  try {
    if (fleet_.Offer(packet) == Word::kLate) ++members_[static_cast<std::size_t>(vehicle)].late;
    ++packets_;
  } catch (const UserError& error) {
    refuse(error.what());
  }
}

std::string FleetNode::FarFromTheClock(TimeNs stamp) const {
  return "stamp " + std::to_string(Seconds(stamp)) + " s, but the clock is at " +
         std::to_string(Seconds(Clock())) + " s";
}

void FleetNode::RefuseOdometry(int vehicle, Refusals::Reason reason, const std::string& why) {
  refused_odometry_.Add(reason);
  last_refusal_ = vehicles_[static_cast<std::size_t>(vehicle)].odom + ": " + why;
}

void FleetNode::RefusePacket(int vehicle, const auv_msgs::AcousticPacket& message,
                             Refusals::Reason reason, const std::string& why) {
  auv_msgs::TransmitStatus status = StatusOf(vehicle, Clock());
  status.destination = message.destination;
  status.sequence = message.sequence;
  RefusePacket(vehicle, &status, reason, why);
}

void FleetNode::RefusePacket(int vehicle, auv_msgs::TransmitStatus* status, Refusals::Reason reason,
                             const std::string& why) {
  refused_packets_.Add(reason);
  const FleetVehicle& v = vehicles_[static_cast<std::size_t>(vehicle)];
  last_refusal_ = v.Topic(topics::kAcousticTx) + ": " + why;
  status->status = auv_msgs::TransmitStatus::REFUSED;
  status->text = why;
  PublishStatus(vehicle, *status);
}

void FleetNode::AskPings() {
  for (const PingDesk::Question& q : pings_.TakeQuestions()) {
    const int source = IndexOf(vehicles_, q.source);
    const int destination = IndexOf(vehicles_, q.destination);
    if (source == kNoVehicle || destination == kNoVehicle) {
      const auto missing = source == kNoVehicle ? q.source : q.destination;
      pings_.Refuse(q.tag, "there is no vehicle " + std::to_string(missing));
    } else if (source == destination) {
      pings_.Refuse(q.tag, "vehicle " + std::to_string(q.source) + " cannot ping itself");
    } else if (!fleet_.heard_of(source) || !fleet_.heard_of(destination)) {
      pings_.Refuse(q.tag, "one of the two vehicles has sent no odometry yet");
    } else {
      fleet_.Ping(source, destination, static_cast<TimeNs>(std::llround(q.timeout_s * 1e9)), q.tag);
    }
  }
}

}  // namespace stg::nodes
