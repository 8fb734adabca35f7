#include <cmath>
#include <utility>

#include "acoustic_channel/nodes/topics.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/conversions.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "fleet_node.hpp"

/// What comes in from vehicles: taken, doubted or refused.
namespace stg::nodes {
namespace {

constexpr std::size_t kMostDoubtful = 10'000;
/// A clock that is on its way is here after this wall time.
constexpr double kDoubt_s = 0.5;

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

/// In the order in which they came in.
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
  const Vehicle& v = vehicles_[static_cast<std::size_t>(vehicle)];
  if (!frame_.empty() && message->header.frame_id != frame_) {
    last_refusal_ = v.odom + ": frame '" + message->header.frame_id + "' instead of " + frame_;
    return refused_odometry_.Add(Refusals::kFrame);
  }
  // An orientation matters only where the twist is told in it.
  const bool finite =
      (twist_ == TwistFrame::kBody ? FinitePose(pose) : FiniteVector(pose.position)) &&
      (twist_ == TwistFrame::kNone || FiniteVector(twist.linear));
  if (!finite) {
    last_refusal_ = v.odom + ": not finite, or an orientation that is no rotation";
    return refused_odometry_.Add(Refusals::kNotFinite);
  }
  Judge(NsOf(message->header.stamp), [this, vehicle, message](bool timely) {
    if (timely) return Place(vehicle, *message);
    refused_odometry_.Add(Refusals::kStale);
    last_refusal_ = vehicles_[static_cast<std::size_t>(vehicle)].odom + ": stamp " +
                    std::to_string(message->header.stamp.toSec()) + " s, the clock says " +
                    std::to_string(Seconds(now_)) + " s";
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
  if (fleet_.Move(vehicle, NsOf(message.header.stamp), motion) ==
      acoustics::FleetChannel::Word::kLate) {
    refused_odometry_.Add(Refusals::kStale);
    last_refusal_ = vehicles_[static_cast<std::size_t>(vehicle)].odom + ": too late for its stamp";
    return;
  }
  ++odometry_;
  ++frames_[message.header.frame_id];
}

void FleetNode::OnPacket(int vehicle, const auv_msgs::AcousticPacket::ConstPtr& message) {
  const bool now = message->header.stamp.isZero();
  const TimeNs stamp = now ? Clock() : NsOf(message->header.stamp);
  Judge(stamp, [this, vehicle, message, stamp](bool timely) {
    if (timely) return Offer(vehicle, *message, stamp);
    refused_packets_.Add(Refusals::kStale);
    Refuse(vehicle, *message,
           "stamp " + std::to_string(Seconds(stamp)) + " s, the clock says " +
               std::to_string(Seconds(now_)) + " s");
  });
}

void FleetNode::Offer(int vehicle, const auv_msgs::AcousticPacket& message, TimeNs stamp) {
  acoustics::Transmission packet;
  packet.source = vehicle;
  packet.destination = message.destination == acoustics::kToAll
                           ? acoustics::kToAll
                           : IndexOf(vehicles_, message.destination);
  packet.stamp = stamp;
  packet.generation = message.generation.isZero() ? stamp : NsOf(message.generation);
  packet.tag = message.sequence;
  packet.payload = acoustics::ViewOf(message.data);
  if (packet.destination == kNobody) {
    refused_packets_.Add(Refusals::kMalformed);
    return Refuse(vehicle, message,
                  "destination " + std::to_string(message.destination) + " does not exist");
  }
  try {
    if (fleet_.Offer(packet) == acoustics::FleetChannel::Word::kLate) {
      ++members_[static_cast<std::size_t>(vehicle)].late;
    }
    ++packets_;
  } catch (const UserError& error) {
    refused_packets_.Add(Refusals::kMalformed);
    Refuse(vehicle, message, error.what());
  }
}

void FleetNode::Refuse(int vehicle, const auv_msgs::AcousticPacket& message,
                       const std::string& why) {
  auv_msgs::TransmitStatus status = StatusOf(vehicle, now_);
  status.destination = message.destination;
  status.sequence = message.sequence;
  status.status = auv_msgs::TransmitStatus::REFUSED;
  status.text = why;
  PublishStatus(vehicle, status);
  last_refusal_ =
      vehicles_[static_cast<std::size_t>(vehicle)].Topic(topics::kAcousticTx) + ": " + why;
}

void FleetNode::AskPings() {
  for (const PingDesk::Question& q : pings_.TakeQuestions()) {
    const int source = IndexOf(vehicles_, q.source);
    const int destination = IndexOf(vehicles_, q.destination);
    if (source == kNobody || destination == kNobody || source == destination) {
      pings_.Refuse(q.tag, "there is no vehicle " + std::to_string(q.source) +
                               " that could ask a vehicle " + std::to_string(q.destination));
    } else if (!fleet_.heard_of(source) || !fleet_.heard_of(destination)) {
      pings_.Refuse(q.tag, "no odometry yet of one of the two");
    } else {
      fleet_.Ping(source, destination, static_cast<TimeNs>(std::llround(q.timeout_s * 1e9)), q.tag);
    }
  }
}

}  // namespace stg::nodes
