#include "acoustic_channel/nodes/channel_node.hpp"

#include <std_msgs/Header.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "acoustic_channel/nodes/conversions.hpp"
#include "acoustic_channel/nodes/topics.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kQueue = 50;

std::vector<int> IndicesOf(int agents) {
  std::vector<int> indices(static_cast<std::size_t>(agents));
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

}  // namespace

ChannelNode::ChannelNode(acoustics::LineOfSight line_of_sight)
    : ChannelNode([&line_of_sight](const acoustics::NetworkConfig& scenario) {
        return acoustics::MakeChannel(scenario.channel, scenario.run, std::move(line_of_sight));
      }) {}

ChannelNode::ChannelNode(const MakeChannel& make)
    : scenario_(LoadScenarioParameters<acoustics::NetworkConfig>()),
      channel_(make(scenario_)),
      period_(scenario_.run.decision_period()),
      timeout_s_(NumberParameter("timeout", 0.2, 0.001, 3600.0)),
      display_period_s_(1.0 / NumberParameter("display_rate", 20.0, 0.01, 1e6)),
      tracker_(period_, scenario_.run.time.episode_steps),
      barrier_(scenario_.run.agents, period_),
      auvs_(static_cast<std::size_t>(scenario_.run.agents)),
      positions_(static_cast<std::size_t>(channel_->bodies())),
      velocities_(positions_.size()),
      attitudes_(auvs_.size()),
      reports_(IndicesOf(scenario_.run.agents)),
      health_("acoustic channel", "simulation", [this](auto& status) { Report(status); }) {
  ros::NodeHandle node;
  done_ = node.advertise<std_msgs::Header>(topics::kChannelDone, kQueue, true);
  links_ = node.advertise<auv_msgs::LinkStates>(topics::kLinks, kQueue, true);
  packets_ = node.advertise<auv_msgs::PacketEvents>(topics::kPackets, kQueue);
  reports_.message().header.frame_id = frames::kWorld;
  for (int i = 0; i < scenario_.run.agents; ++i) {
    Auv& auv = auvs_[static_cast<std::size_t>(i)];
    auv.reception = node.advertise<auv_msgs::AcousticReception>(
        topics::AuvTopic(i, topics::kAcousticRx), kQueue, true);
    const boost::function<void(const auv_msgs::AcousticPacket::ConstPtr&)> on_transmission =
        [this, i](const auto& message) { OnTransmission(i, message); };
    auv.subscriber =
        node.subscribe<auv_msgs::AcousticPacket>(topics::AuvTopic(i, topics::kAcousticTx), kQueue,
                                                 on_transmission, ros::VoidConstPtr(), NoDelay());
  }
  swarm_ = node.subscribe(topics::kSwarmState, kQueue, &ChannelNode::OnSwarm, this, NoDelay());
}

void ChannelNode::Spin() {
  PollLoop([this] { return Work(); }, RealtimePriorityParameter());
}

double ChannelNode::Work() {
  CloseIfDue();
  PublishPackets(false);
  health_.Tick();
  const double wait_s = reports_.message().events.empty() ? 0.2 : display_period_s_;
  return std::clamp(barrier_.deadline_s() - WallSeconds(), 0.0, wait_s);
}

void ChannelNode::OnSwarm(const auv_msgs::SwarmState::ConstPtr& message) {
  if (message->header.frame_id != frames::kWorld) {
    refused_swarm_.Add(Refusals::kFrame);
    return;
  }
  const std::size_t targets = positions_.size() - auvs_.size();
  if (message->poses.size() != auvs_.size() || message->velocities.size() != auvs_.size() ||
      (targets > 0 && (message->target_positions.size() != targets ||
                       message->target_velocities.size() != targets))) {
    refused_swarm_.Add(Refusals::kMalformed);
    return;
  }
  const auto finite_pose = [](const auto& pose) { return FinitePose(pose); };
  const auto finite_vector = [](const auto& vector) { return FiniteVector(vector); };
  if (!std::all_of(message->poses.begin(), message->poses.end(), finite_pose) ||
      !std::all_of(message->velocities.begin(), message->velocities.end(), finite_vector) ||
      !std::all_of(message->target_positions.begin(), message->target_positions.end(),
                   finite_vector) ||
      !std::all_of(message->target_velocities.begin(), message->target_velocities.end(),
                   finite_vector)) {
    refused_swarm_.Add(Refusals::kNotFinite);
    return;
  }
  const TimeNs stamp = NsOf(message->header.stamp);
  using Verdict = StepTracker::Verdict;
  const Verdict verdict = tracker_.Hear({message->run, message->episode, message->step, stamp});
  if (verdict == Verdict::kRefused) {
    refused_swarm_.Add(Refusals::kStale);
    return;
  }
  if (verdict == Verdict::kNewRun) {
    // Transmissions stay, because those of this step may have arrived before it.
    barrier_.Restart();
  } else if (barrier_.open() && stamp > barrier_.stamp()) {
    // The world has continued without this channel.
    Close();
    ++incomplete_steps_;
  }
  // Nodes need time to start. The world waits for them with its first step.
  const bool at_start = message->episode == 0 && message->step == 0;
  const double deadline_s =
      at_start ? std::numeric_limits<double>::infinity() : WallSeconds() + timeout_s_;
  if (barrier_.Open(stamp, deadline_s) == StepBarrier::Opening::kRepeated) return;
  SetNodeTime(message->header.stamp);
  gave_up_ = false;
  if (verdict == Verdict::kNewRun || verdict == Verdict::kNewEpisode) {
    PublishPackets(true);
    channel_->Reset(message->seed, 0);
  }
  start_ = tracker_.start();
  step_ = message->step;
  for (std::size_t i = 0; i < auvs_.size(); ++i) {
    positions_[i] = VectorOf(message->poses[i].position);
    velocities_[i] = VectorOf(message->velocities[i]);
    attitudes_[i] = AttitudeOf(message->poses[i]);
  }
  for (std::size_t k = 0; k < targets; ++k) {
    positions_[auvs_.size() + k] = VectorOf(message->target_positions[k]);
    velocities_[auvs_.size() + k] = VectorOf(message->target_velocities[k]);
  }
  if (verdict == Verdict::kNewRun && message->step == 0) Greet();
  AskForTransmissions();
  CloseIfDue();
}

/// Sends an empty window before the run. A new subscriber of a latched topic gets only the last
/// message. An agent that has this window is connected and will receive all later ones.
void ChannelNode::Greet() {
  received_.clear();
  for (int i = 0; i < scenario_.run.agents; ++i) PublishWindow(i, 0);
}

/// Waits only for AUVs whose packet can leave in this step. Others may offer a packet, too.
void ChannelNode::AskForTransmissions() {
  const TimeNs stamp = barrier_.stamp();
  for (int i = 0; i < scenario_.run.agents; ++i) {
    const auto& early = auvs_[static_cast<std::size_t>(i)].transmission;
    if (early && NsOf(early->header.stamp) == stamp) barrier_.Hear(i, stamp);
    if (!channel_->Due(i, stamp - start_)) barrier_.Excuse(i);
  }
}

void ChannelNode::OnTransmission(int i, const auv_msgs::AcousticPacket::ConstPtr& message) {
  if (message->header.frame_id != frames::Body(i)) {
    refused_transmissions_.Add(Refusals::kFrame);
    return;
  }
  if (message->source != static_cast<std::uint32_t>(i) || !Sendable(*message)) {
    refused_transmissions_.Add(Refusals::kMalformed);
    return;
  }
  auto& kept = auvs_[static_cast<std::size_t>(i)].transmission;
  switch (barrier_.Hear(i, NsOf(message->header.stamp))) {
    case StepBarrier::Word::kCounts:
      kept = message;
      break;
    case StepBarrier::Word::kEarly:
      if (!kept || kept->header.stamp != message->header.stamp) kept = message;
      break;
    case StepBarrier::Word::kDuplicate:
      break;
    case StepBarrier::Word::kLate:
    case StepBarrier::Word::kForeign:
      refused_transmissions_.Add(Refusals::kStale);
      break;
  }
  CloseIfDue();
}

bool ChannelNode::Sendable(const auv_msgs::AcousticPacket& message) const {
  if (message.data.empty()) return true;  // no data in this step
  try {
    channel_->CheckOrThrow(TransmissionOf(message));
    return true;
  } catch (const UserError& error) {
    ROS_WARN_THROTTLE(5.0, "channel: %s", error.what());
    return false;
  }
}

acoustics::Transmission ChannelNode::TransmissionOf(const auv_msgs::AcousticPacket& message) const {
  acoustics::Transmission t;
  t.source = static_cast<int>(message.source);
  t.destination = message.destination;
  t.stamp = NsOf(message.header.stamp) - start_;
  t.generation = NsOf(message.generation) - start_;
  t.tag = message.sequence;
  t.payload = acoustics::ViewOf(message.data);
  return t;
}

void ChannelNode::CloseIfDue() {
  if (!barrier_.open()) return;
  if (!barrier_.GiveUp(WallSeconds()).empty()) gave_up_ = true;
  if (!barrier_.Complete()) return;
  if (gave_up_) ++incomplete_steps_;
  Close();
}

void ChannelNode::Close() {
  barrier_.Close();
  const TimeNs now = barrier_.stamp() - start_;
  offered_.clear();
  for (std::size_t i = 0; i < auvs_.size(); ++i) {
    const auto& m = auvs_[i].transmission;
    if (!barrier_.answered(static_cast<int>(i)) || m->data.empty()) continue;
    offered_.push_back(TransmissionOf(*m));
  }
  // Events are only recorded if there are subscribers.
  const bool watched = packets_.getNumSubscribers() > 0;
  reports_.Begin(start_);
  channel_->Observe(watched ? &reports_ : nullptr);
  channel_->SetAttitudes(attitudes_);
  channel_->Step(now, step_, positions_, velocities_, offered_);
  for (int i = 0; i < scenario_.run.agents; ++i) {
    received_.clear();
    channel_->Deliver(i, now + period_, &received_);
    PublishWindow(i, now + period_);
  }
  std_msgs::Header done;
  done.stamp = TimeOf(barrier_.stamp());
  done.frame_id = frames::kWorld;
  done_.publish(done);
  steps_.Add();
  reports_.message().header.stamp = done.stamp;
  // The final counts of an episode do not depend on the wall clock.
  const bool last = step_ + 1 == static_cast<std::uint32_t>(scenario_.run.time.episode_steps);
  PublishPackets(last);
  PublishLinks(now, last);
}

/// In lockstep, many steps pass between two messages for observers.
void ChannelNode::PublishPackets(bool now) {
  auv_msgs::PacketEvents& m = reports_.message();
  const double wall_s = WallSeconds();
  if (m.events.empty() || (!now && wall_s - packets_sent_s_ < display_period_s_)) return;
  packets_sent_s_ = wall_s;
  packets_.publish(m);
  reports_.Clear();
}

void ChannelNode::PublishWindow(int i, TimeNs until) {
  auv_msgs::AcousticReception& m = reception_message_;
  m.header.stamp = TimeOf(start_ + until);
  m.header.frame_id = frames::Body(i);
  m.packets.resize(received_.size());
  for (std::size_t k = 0; k < received_.size(); ++k) {
    SetReceivedPacket(received_[k], start_, &m.packets[k]);
  }
  auvs_[static_cast<std::size_t>(i)].reception.publish(m);
}

void ChannelNode::PublishLinks(TimeNs now, bool last) {
  const ros::WallTime wall = ros::WallTime::now();
  if (!last && (wall - links_sent_).toSec() < display_period_s_) return;
  links_sent_ = wall;
  auto& m = links_message_;
  m.header.stamp = TimeOf(barrier_.stamp());
  m.header.frame_id = frames::kWorld;
  m.links.clear();
  m.energy.clear();
  for (int i = 0; i < scenario_.run.agents; ++i) {
    m.energy.push_back(channel_->EnergyJ(i, now + period_));  // packets are counted until that time
    for (int j = 0; j < scenario_.run.agents; ++j) {
      if (i == j) continue;
      auv_msgs::LinkState& link = m.links.emplace_back();
      SetLinkState(channel_->Link(i, j, now), &link);
      link.source = static_cast<std::uint32_t>(i);
      link.destination = static_cast<std::uint32_t>(j);
    }
  }
  links_.publish(m);
}

void ChannelNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "running");
  const double rate = static_cast<double>(steps_.TakeRecent()) / health_.period_s();
  status.add("steps per second", rate);
  status.add("steps closed without an AUV", incomplete_steps_);
  refused_swarm_.Report(topics::kSwarmState, &status);
  refused_transmissions_.Report(topics::kAcousticTx, &status);
  if (steps_.total() == 0) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "no step closed yet");
    return;
  }
  const acoustics::ChannelTotals& totals = channel_->totals();
  status.add("packets delivered in this episode", totals.delivered);
  for (std::size_t k = 1; k < totals.drops.size(); ++k) {
    status.add(std::string("packets dropped: ") + ToString(static_cast<acoustics::DropReason>(k)),
               totals.drops[k]);
  }
  double largest = 0.0, sum = 0.0;
  int links = 0;
  for (int i = 0; i < scenario_.run.agents; ++i) {
    for (int j = 0; j < scenario_.run.agents; ++j) {
      if (i == j) continue;
      const double age = channel_->Link(i, j, std::max<TimeNs>(0, barrier_.stamp() - start_)).age_s;
      largest = std::max(largest, age);
      sum += age;
      ++links;
    }
  }
  status.add("age of information, mean [s]", links > 0 ? sum / links : 0.0);
  status.add("age of information, largest [s]", largest);
  for (int i = 0; i < scenario_.run.agents; ++i) {
    if (!barrier_.present(i)) {
      status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN,
                          "AUV " + std::to_string(i) + " does not transmit");
    }
  }
}

}  // namespace stg::nodes
