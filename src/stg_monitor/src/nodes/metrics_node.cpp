#include "metrics_node.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <nlohmann/json.hpp>

#include "acoustic_channel/nodes/topics.hpp"
#include "auv_common/names.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "stg_agent/nodes/topics.hpp"

namespace stg::nodes {
namespace {

/// Largest number of waiting messages per topic. In lockstep no node waits for this node, and a
/// lost message makes an episode incomplete. The number is for ten seconds of the fastest run, and
/// it bounds the memory in a flood of messages.
constexpr std::uint32_t kQueue = 50000;
/// Bounds the memory in a run whose frames never become complete.
constexpr std::size_t kMaxFrames = 5000;
/// Largest number of steps by which an agent's message may arrive before the world's: the capacity
/// of sockets and queues.
constexpr TimeNs kLargestLead = 1000;

/// A text as one field of a CSV file.
std::string Quoted(std::string text) {
  for (std::size_t k = 0; (k = text.find('"', k)) != std::string::npos; k += 2)
    text.insert(k, "\"");
  return '"' + text + '"';
}

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

}  // namespace

MetricsNode::MetricsNode()
    : scenario_(LoadScenarioParameters<Scenario>(config::Scope::kWhole)),
      period_(scenario_.run.decision_period()),
      patience_s_(NumberParameter("patience", 1.0, 0.0, 3600.0)),
      show_table_(FlagParameter("table", true)),
      tracker_(period_, scenario_.run.time.episode_steps),
      frames_(kMaxFrames, SwarmFrame(scenario_.run.agents)),
      judge_(scenario_.judge()),
      table_(scenario_.run, scenario_.agent.observation.link_available,
             IntegerParameter("episodes", 0, 0, 1'000'000'000)),
      display_(NumberParameter("display_rate", 20.0, 0.01, 1e6),
               static_cast<std::uint32_t>(scenario_.run.time.episode_steps)),
      file_name_(TextParameter("summary_file", "")),
      health_("metrics", "simulation", [this](auto& status) { Report(status); }) {
  if (!file_name_.empty() && !std::ofstream(file_name_, std::ios::app)) {
    throw UserError("summary_file: cannot write '" + file_name_ + "'");
  }
  step_report_ = ros::NodeHandle().advertise<auv_msgs::StepReport>(topics::kStepReport, 1000, true);
  Subscribe();
}

MetricsNode::~MetricsNode() {
  if (show_table_) table_.PrintRun(episodes_);
}

void MetricsNode::Subscribe() {
  ros::NodeHandle node;
  // Puts each message of a topic into its slot in the frame with the same stamp.
  const auto into_frames = [&](const std::string& topic, auto slot, auto usable) {
    using Slot = std::remove_reference_t<decltype(slot(std::declval<SwarmFrame&>()))>;
    using Message = std::remove_const_t<typename Slot::element_type>;
    const boost::function<void(const boost::shared_ptr<const Message>&)> callback =
        [this, slot, usable](const boost::shared_ptr<const Message>& m) {
          if (!usable(*m)) return;
          if (SwarmFrame* frame = frames_.At(NsOf(m->header.stamp), WallSeconds())) {
            Slot& place = slot(*frame);
            if (!place) place = m;
          }
        };
    subscribers_.push_back(
        node.subscribe<Message>(topic, kQueue, callback, ros::VoidConstPtr(), NoDelay()));
  };
  into_frames(
      topics::kSwarmState, [](SwarmFrame & f) -> auto& { return f.truth; },
      [this](const auto& m) {
        const bool usable = Usable(m);
        if (!usable) refused_swarm_.Add(Refusals::kNotFinite);
        return usable && Follow(m);
      });
  for (int i = 0; i < scenario_.run.agents; ++i) {
    const auto u = static_cast<std::size_t>(i);
    into_frames(
        topics::AuvTopic(i, topics::kTaskState),
        [u](SwarmFrame & f) -> auto& { return f.tasks[u]; },
        [this](const auto& m) {
          if (!Usable(m)) {
            refused_tasks_.Add(Refusals::kNotFinite);
          } else if (!IsText(m.policy_id)) {
            refused_tasks_.Add(Refusals::kMalformed);
          } else if (!Near(NsOf(m.header.stamp))) {
            refused_tasks_.Add(Refusals::kStale);
          } else {
            return true;
          }
          return false;
        });
  }
  subscribers_.push_back(
      node.subscribe(topics::kLinks, 10, &MetricsNode::OnLinks, this, NoDelay()));
}

bool MetricsNode::Follow(const auv_msgs::SwarmState& m) {
  const TimeNs stamp = NsOf(m.header.stamp);
  const bool in_run = tracker_.started();  // if not, earlier messages of agents belong to this run
  switch (tracker_.Hear({m.run, m.episode, m.step, stamp})) {
    case StepTracker::Verdict::kRefused:
      refused_swarm_.Add(Refusals::kStale);
      return false;
    case StepTracker::Verdict::kNewRun:
      if (in_run) {
        frames_.Clear();
        display_.Clear();
        links_.clear();
      }
      break;
    case StepTracker::Verdict::kRepeated:
      frames_.Reach(stamp);
      return true;
    case StepTracker::Verdict::kNext:
    case StepTracker::Verdict::kNewEpisode:
      break;
  }
  frames_.Reach(stamp);
  display_.Choose(m, WallSeconds());
  return true;
}

bool MetricsNode::Near(TimeNs stamp) const {
  // Before the run is known, a message may be of any step of it.
  if (!tracker_.started()) return stamp <= StepTracker::kLatest;
  const TimeNs ahead = stamp - tracker_.place().stamp;
  return ahead % period_ == 0 && ahead <= kLargestLead * period_;
}

bool MetricsNode::Usable(const auv_msgs::TaskState& m) const {
  return Finite(m.graph_summary[1]) && std::all_of(m.action.begin(), m.action.end(), Finite) &&
         FiniteVector(m.target_position) && FiniteVector(m.target_offset) && Finite(m.target_age) &&
         std::all_of(m.target_covariance.begin(), m.target_covariance.end(), FiniteSquare) &&
         std::all_of(m.beliefs.begin(), m.beliefs.end(),
                     [](const auto& p) { return FiniteVector(p); });
}

bool MetricsNode::Usable(const auv_msgs::SwarmState& m) const {
  const auto n = static_cast<std::size_t>(scenario_.run.agents);
  const auto targets = static_cast<std::size_t>(scenario_.world.target.count);
  const auto finite = [](const auto& v) { return FiniteVector(v); };
  const auto& p = m.target_positions;
  const auto& v = m.target_velocities;
  const auto finite_pose = [](const geometry_msgs::Pose& pose) { return FinitePose(pose); };
  const auto finite_twist = [](const geometry_msgs::Twist& twist) { return FiniteTwist(twist); };
  const auto finite_wrench = [](const geometry_msgs::Wrench& w) {
    return FiniteVector(w.force) && FiniteVector(w.torque);
  };
  const bool efforts = m.efforts.empty() || m.efforts.size() == n * dynamics::kWrenchSize;
  return efforts && std::all_of(m.efforts.begin(), m.efforts.end(), Finite) &&
         m.poses.size() == n && m.twists.size() == n && m.velocities.size() == n &&
         m.wrenches.size() == n && m.fresh.size() == n && p.size() == targets &&
         v.size() == targets && std::all_of(m.wrenches.begin(), m.wrenches.end(), finite_wrench) &&
         std::all_of(m.poses.begin(), m.poses.end(), finite_pose) &&
         std::all_of(m.twists.begin(), m.twists.end(), finite_twist) &&
         std::all_of(m.velocities.begin(), m.velocities.end(), finite) &&
         std::all_of(p.begin(), p.end(), finite) && std::all_of(v.begin(), v.end(), finite);
}

void MetricsNode::Spin() {
  PollLoop([this] { return Work(); });
  if (lost_summaries_ > 0) {
    throw LostOutput("summary_file: " + std::to_string(lost_summaries_) +
                     " episodes could not be written to '" + file_name_ + "'");
  }
}

double MetricsNode::Work() {
  JudgeFrames();
  SendOverdue();
  if (show_table_) table_.Tick(judge_, now_s_);
  health_.Tick();
  return 0.1;
}

void MetricsNode::OnLinks(const auv_msgs::LinkStates::ConstPtr& message) {
  table_.SetLinks(*message);
  newest_links_ = message;
  const TimeNs end = NsOf(message->header.stamp) + period_;
  // Not stored in a frame: the wait for this frame would begin before the world has come to its
  // step.
  if (Near(end) && links_.size() < kMaxFrames) links_[end] = message;
}

/// Takes the newest links up to a step, and forgets older ones.
auv_msgs::LinkStates::ConstPtr MetricsNode::TakeLinks(TimeNs stamp) {
  const auto later = links_.upper_bound(stamp);
  if (later == links_.begin()) return nullptr;
  auv_msgs::LinkStates::ConstPtr newest = std::prev(later)->second;
  links_.erase(links_.begin(), later);
  return newest;
}

/// The last frame of an episode waits for the channel's counts up to its step. The wait is short,
/// because there may be no channel.
bool MetricsNode::AwaitsLinks(const SwarmFrame& frame) {
  const bool last =
      frame.truth->step >= static_cast<std::uint32_t>(scenario_.run.time.episode_steps);
  const TimeNs stamp = NsOf(frame.truth->header.stamp);
  if (!last || !scenario_.world.sea.open || links_.count(stamp) > 0) return false;
  if (awaited_ != stamp) {
    awaited_ = stamp;
    awaited_since_s_ = WallSeconds();
  }
  return WallSeconds() - awaited_since_s_ <= patience_s_;
}

void MetricsNode::JudgeFrames() {
  SwarmFrame frame(scenario_.run.agents);
  const auto complete = [this](const SwarmFrame& f) { return f.Complete() && !AwaitsLinks(f); };
  while (frames_.Take(WallSeconds(), patience_s_, complete, &frame)) {
    frame.links = TakeLinks(frames_.taken());
    if (!frame.Complete()) {
      ++incomplete_frames_;
    } else if (!summary_) {
      // This also tells the world that no summary of this run will be lost.
      summary_ =
          ros::NodeHandle().advertise<auv_msgs::EpisodeSummary>(topics::kEpisodeSummary, 10, true);
    }
    for (int i = 0; i < scenario_.run.agents; ++i) {
      const auto& task = frame.tasks[static_cast<std::size_t>(i)];
      if (task) table_.SetPhase(i, task->phase);
    }
    if (frame.truth && !file_name_.empty() && !file_.is_open()) OpenSummary(frame.truth->episode);
    if (frame.truth) SetNodeTime(frame.truth->header.stamp);
    if (frame.truth) now_s_ = Seconds(period_) * frame.truth->step;
    const EpisodeJudge::Verdict verdict = judge_.Judge(frame);
    display_.Send(frame, verdict.has_report ? &verdict.report : nullptr, newest_links_.get());
    Publish(verdict);
  }
}

/// A display gets a step earlier than the metrics do.
void MetricsNode::SendOverdue() {
  const TimeNs stamp = display_.Overdue(WallSeconds());
  const SwarmFrame* frame = stamp < 0 ? nullptr : frames_.Open(stamp);
  if (frame != nullptr) display_.Send(*frame, nullptr, newest_links_.get());
}

void MetricsNode::Publish(const EpisodeJudge::Verdict& verdict) {
  if (verdict.has_report) {
    step_report_.publish(verdict.report);
    reports_.Add();
  }
  if (!verdict.has_summary) return;
  if (verdict.summary.complete) episodes_.push_back(verdict.metrics);
  if (show_table_) table_.PrintEpisode(verdict.summary, verdict.metrics);
  if (file_.is_open()) WriteSummary(verdict);
  if (!file_name_.empty() && !file_) LoseSummary();
  if (summary_) summary_.publish(verdict.summary);
}

/// Reports that the summary file cannot be written. The run continues, and its end reports the
/// loss.
void MetricsNode::LoseSummary() {
  if (lost_summaries_++ == 0) {
    ROS_ERROR("summary_file: cannot write '%s': %s", file_name_.c_str(), std::strerror(errno));
  }
  file_.clear();
}

/// A run begins with episode 0 and an empty file. With another episode, this node has been
/// restarted during a run.
void MetricsNode::OpenSummary(std::uint32_t episode) {
  file_.open(file_name_, episode == 0 ? std::ios::trunc : std::ios::app | std::ios::ate);
}

/// Writes one line per episode: CSV with a header, or a JSON object if the file name does not end
/// in .csv.
void MetricsNode::WriteSummary(const EpisodeJudge::Verdict& verdict) {
  const auto& s = verdict.summary;
  const auto items = verdict.metrics.Items();
  file_.precision(17);
  if (EndsWith(file_name_, ".csv")) {
    if (file_.tellp() == 0) {
      file_ << "episode,seed,scenario,policy,steps,complete,deadline_misses,channel_misses";
      for (const auto& item : items) file_ << "," << item.first;
      file_ << "\n";
    }
    file_ << s.episode << "," << s.seed << "," << Quoted(s.scenario) << "," << Quoted(s.policy_id)
          << "," << s.steps << "," << (s.complete ? 1 : 0) << "," << s.deadline_misses << ","
          << s.channel_misses;
    for (const auto& item : items) file_ << "," << item.second;
    file_ << std::endl;
    return;
  }
  nlohmann::ordered_json line{{"episode", s.episode},
                              {"seed", s.seed},
                              {"scenario", s.scenario},
                              {"policy", s.policy_id},
                              {"steps", s.steps},
                              {"complete", bool(s.complete)},
                              {"deadline_misses", s.deadline_misses},
                              {"channel_misses", s.channel_misses}};
  for (const auto& item : items) line[item.first] = item.second;
  // Text from a topic may not be UTF-8.
  file_ << line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
}

void MetricsNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "running");
  const double rate = static_cast<double>(reports_.TakeRecent()) / health_.period_s();
  status.add("steps judged", reports_.total());
  status.add("steps per second", rate);
  status.add("steps with a message missing", incomplete_frames_);
  refused_swarm_.Report(topics::kSwarmState, &status);
  refused_tasks_.Report(topics::kTaskState, &status);
  status.add("messages too late", frames_.late());
  status.add("steps without room", frames_.crowded());
  status.add("episodes complete", episodes_.size());
  status.add("episodes not written to the summary file", lost_summaries_);
  if (reports_.total() == 0) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "nothing to judge yet");
  }
}

}  // namespace stg::nodes
