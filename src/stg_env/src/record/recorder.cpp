#include "stg_env/record/recorder.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "acoustic_channel/channel/packet_observer.hpp"
#include "acoustic_channel/log/packet_log.hpp"
#include "auv_common/durable_file.hpp"
#include "auv_common/error.hpp"
#include "auv_dynamics/terrain/seascape.hpp"
#include "stg_agent/graph/task_view.hpp"
#include "stg_env/record/message.hpp"

namespace stg::env {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr int kRowsOfMessage = 512;
constexpr double kTouching_m = 1e-3;  // an AUV this close to bottom or obstacle touches it

/// Packets of one episode: the rows of the message `packets`, one for each packet and receiver.
class PacketRows : public acoustics::PacketObserver {
 public:
  PacketRows(int nodes, TimeNs offset, std::ostream* csv)
      : nodes_(nodes), offset_(offset), log_(csv, nodes, {}, offset) {}

  void OnDiscarded(const acoustics::PacketInfo& p, acoustics::DropReason reason,
                   TimeNs t) override {
    log_.OnDiscarded(p, reason, t);
    acoustics::PacketFate fate;
    fate.reason = reason;
    fate.distance_m = fate.sinr_db = kUnknown;
    for (int i = 0; i < nodes_; ++i) {
      fate.receiver = i;
      if (p.destination == i || (p.destination == acoustics::kToAll && i != p.source)) {
        Row(p, fate, false);
      }
    }
  }
  void OnFate(const acoustics::PacketInfo& p, const acoustics::PacketFate& fate) override {
    log_.OnFate(p, fate);
    Row(p, fate, true);
  }

  Message Take() {
    Message m("packets");
    m.Add("source", 1, source_);
    m.Add("receiver", 1, receiver_);
    m.Add("sequence", 1, sequence_);
    m.Add("bytes", 1, bytes_);
    m.Add("fate", 1, fate_);
    m.Add("offered", 1, offered_);
    m.Add("transmit", 1, transmit_);
    m.Add("transmit_end", 1, transmit_end_);
    m.Add("arrival", 1, arrival_);
    m.Add("distance", 1, distance_);
    m.Add("sinr", 1, sinr_);
    m.Add("probability", 1, probability_);
    return m;
  }

 private:
  void Row(const acoustics::PacketInfo& p, const acoustics::PacketFate& fate, bool left) {
    constexpr double kNever = std::numeric_limits<double>::quiet_NaN();
    source_.push_back(p.source);
    receiver_.push_back(fate.receiver);
    sequence_.push_back(left ? static_cast<std::int32_t>(p.sequence) : -1);
    bytes_.push_back(static_cast<std::int32_t>(p.bytes));
    fate_.push_back(static_cast<std::uint8_t>(fate.reason));
    offered_.push_back(Seconds(p.offered + offset_));
    transmit_.push_back(left ? Seconds(p.transmit + offset_) : kNever);
    transmit_end_.push_back(left ? Seconds(p.transmit_end + offset_) : kNever);
    arrival_.push_back(left ? Seconds(fate.arrival + offset_) : kNever);
    distance_.push_back(static_cast<float>(fate.distance_m));
    sinr_.push_back(static_cast<float>(fate.sinr_db));
    probability_.push_back(static_cast<float>(fate.loss_probability));
  }

  int nodes_;
  TimeNs offset_;
  acoustics::PacketLog log_;
  std::vector<std::int32_t> source_, receiver_, sequence_, bytes_;
  std::vector<std::uint8_t> fate_;
  std::vector<double> offered_, transmit_, transmit_end_, arrival_;
  std::vector<float> distance_, sinr_, probability_;
};

/// The rows of the message `steps`.
class StepRows {
 public:
  StepRows(task::JudgeConfig judge, bool acoustic) : s_(std::move(judge)), acoustic_(acoustic) {
    if (s_.world.sea.open) sea_.emplace(s_.world.sea, s_.world.workspace.half_extent_m);
  }

  int rows() const { return static_cast<int>(c_.t.size()); }

  void Add(const VectorEnv& env, int e, TimeNs offset, double reward) {
    const TimeNs now = env.time(e);
    c_.t.push_back(Seconds(now + offset));
    c_.reward.push_back(static_cast<float>(reward));
    for (int i = 0; i < s_.run.agents; ++i) {
      const dynamics::VehicleState<double> v = env.vehicle(e, i);
      const Vec3<double> rpy = RpyOf(v.trig);
      const agent::Knowledge<double> known = env.knowledge(e, i);
      Put(&c_.position, v.p_WB);
      // With the bow up, the pitch is negative: the body's y axis points to port.
      c_.heading.push_back(static_cast<float>(rpy.z));
      c_.pitch.push_back(static_cast<float>(-rpy.y));
      c_.phase.push_back(static_cast<std::uint8_t>(agent::PhaseOf(s_.agent.observation, known)));
      c_.distance.push_back(static_cast<float>(env.tracking(e, i).distance));
      dynamics::Detection detection;
      const bool detected = acoustic_ && env.Sense(e, i, env.followed(e, i), &detection);
      c_.detected.push_back(detected ? 1 : 0);
      c_.followed.push_back(static_cast<std::uint8_t>(env.followed(e, i)));
      const bool ranged = detected && detection.kind == dynamics::MeasurementKind::kRange;
      c_.range.push_back(ranged ? static_cast<float>(detection.range_m) : kUnknown);
      c_.aground.push_back(Touches(v.p_WB));
      if (acoustic_) {
        AddBelief(env, e, i, now);
      } else {
        Put(&c_.estimate, known.p_WB + known.r_BT_W);
        c_.covariance.insert(c_.covariance.end(), 6, 0.0F);
        c_.age.push_back(0.0F);
        c_.neighbour_age.push_back(kUnknown);
        c_.energy.push_back(kUnknown);
      }
      AddTerms(env.terms(e, i));
    }
    for (int k = 0; k < s_.world.target.count; ++k) Put(&c_.target, env.target(e, k).p_WT);
  }

  Message Take() {
    const int n = s_.run.agents;
    Message m("steps", {{"terms", kTerms}});
    m.Add("t", 1, c_.t);
    m.Add("reward", 1, c_.reward);
    m.Add("position", 3 * n, c_.position);
    m.Add("heading", n, c_.heading);
    m.Add("pitch", n, c_.pitch);
    m.Add("phase", n, c_.phase);
    m.Add("distance", n, c_.distance);
    m.Add("detected", n, c_.detected);
    if (s_.agent.task.free()) m.Add("followed", n, c_.followed);
    m.Add("range", n, c_.range);
    m.Add("aground", n, c_.aground);
    m.Add("estimate", 3 * n, c_.estimate);
    m.Add("covariance", 6 * n, c_.covariance);
    m.Add("age", n, c_.age);
    m.Add("neighbour_age", n, c_.neighbour_age);
    m.Add("energy", n, c_.energy);
    m.Add("terms", n * static_cast<int>(kTerms.size()), c_.terms);
    m.Add("target", 3 * s_.world.target.count, c_.target);
    c_ = Columns();
    return m;
  }

 private:
  struct Columns {
    std::vector<double> t;
    std::vector<float> reward, position, heading, pitch, distance, range, estimate, covariance, age,
        neighbour_age, energy, terms, target;
    std::vector<std::uint8_t> phase, detected, aground, followed;
  };

  static void Put(std::vector<float>* to, const Vec3<double>& v) {
    for (const double x : {v.x, v.y, v.z}) to->push_back(static_cast<float>(x));
  }

  /// 0: in free water; 1: on the bottom; 2: at an obstacle.
  std::uint8_t Touches(const Vec3<double>& p_W) const {
    if (!sea_) return 0;
    if (sea_->Altitude(p_W) < kTouching_m) return 1;
    return sea_->Clearance(p_W) < kTouching_m ? 2 : 0;
  }

  void AddBelief(const VectorEnv& env, int e, int i, TimeNs now) {
    const agent::AgentView view = env.agent(e, i);
    const agent::TargetBelief belief = view.belief();
    const agent::Covariance3& P = belief.P_WT;
    for (const double x : {belief.p_WT.x, belief.p_WT.y, belief.p_WT.z}) {
      c_.estimate.push_back(belief.started ? static_cast<float>(x) : kUnknown);
    }
    for (const double x : {P.xx, P.xy, P.xz, P.yy, P.yz, P.zz}) {
      c_.covariance.push_back(belief.started ? static_cast<float>(x) : kUnknown);
    }
    c_.age.push_back(belief.started ? static_cast<float>(Seconds(now - belief.information))
                                    : kUnknown);
    // Mean age of the newest packets of the others, from the network's links.
    double sum = 0.0;
    for (int j = 0; j < s_.run.agents; ++j) {
      if (j != i) sum += env.channel(e).Link(j, i, now).age_s;
    }
    c_.neighbour_age.push_back(s_.run.agents > 1 ? static_cast<float>(sum / (s_.run.agents - 1))
                                                 : kUnknown);
    c_.energy.push_back(static_cast<float>(env.channel(e).EnergyJ(i, now)));
  }

  void AddTerms(const task::RewardTerms<double>& r) {
    for (const double x : {r.track, r.observation, r.coordination, r.communication, r.semantic,
                           r.separation, r.cost}) {
      c_.terms.push_back(static_cast<float>(x));
    }
  }

  inline static const std::vector<std::string> kTerms = {
      "track", "observation", "coordination", "communication", "semantic", "separation", "cost"};

  const task::JudgeConfig s_;
  const bool acoustic_;
  std::optional<dynamics::Seascape> sea_;
  Columns c_;
};

/// Flies and records the episodes.
class Recorder {
 public:
  Recorder(const EnvFactory& make_env, const agent::Decider& controller, std::ostream* out,
           std::ostream* csv)
      : make_env_(make_env), controller_(controller), out_(out), csv_(csv) {}

  void Meta(nlohmann::json scene) {
    *out_ << kRecordingMagic;
    scene["source"] = "evaluate --record";
    scene["policy"] = controller_.name;
    *out_ << Message("meta", {{"meta", scene}}).Bytes();
  }

  /// Environments fly in blocks of kMixBlock, as in Evaluate, so that numbers are rounded equally.
  void Fly(int episode, std::uint64_t seed, int total) {
    VectorEnvOptions o;
    o.seed = seed;
    o.envs = kMixBlock;
    o.first_env = episode / kMixBlock * kMixBlock;
    o.total_envs = total;
    VectorEnv env = make_env_.Make(o);
    EnvMemory memory = env.MakeMemory();
    std::vector<double> actions(static_cast<std::size_t>(env.envs() * env.agents()) *
                                static_cast<std::size_t>(env.action_size()));
    const int e = episode % kMixBlock;
    const Scenario& s = env.scenario(e);
    env.Reset(memory.arrays());
    std::ostringstream own_log;
    PacketRows packets(s.run.agents, offset_, &own_log);
    const bool acoustic = s.mode == InformationMode::kAcoustic;
    if (acoustic) env.ObservePackets(e, &packets);
    *out_ << Message("episode", {{"episode", episode},
                                 {"seed", seed + static_cast<std::uint64_t>(episode)},
                                 {"start", Seconds(offset_)}})
                 .Bytes();
    StepRows steps(s.judge(), acoustic);
    double reward = 0.0;
    while (true) {
      steps.Add(env, e, offset_, reward);
      if (steps.rows() == kRowsOfMessage) *out_ << steps.Take().Bytes();
      // The last decision starts the next episode at once. Its packets do not belong to this
      // episode.
      const bool last = env.step(e) + 1 == s.run.time.episode_steps;
      const TimeNs now = env.time(e);
      if (acoustic && last) env.ObservePackets(e, nullptr);
      Decide(controller_, env, memory.observations.data(), actions.data());
      env.Step(actions.data(), memory.arrays());
      reward = static_cast<double>(memory.team_rewards[static_cast<std::size_t>(e)]);
      if (!last) continue;
      offset_ += now + s.run.decision_period();
      break;
    }
    if (steps.rows() > 0) *out_ << steps.Take().Bytes();
    *out_ << packets.Take().Bytes();
    const std::string log = own_log.str();
    *csv_ << (episode == 0 ? log : log.substr(log.find('\n') + 1));
    nlohmann::json metrics;
    for (const auto& [name, value] : env.metrics(e).Items()) metrics[name] = value;
    *out_ << Message("summary", {{"episode", episode}, {"metrics", metrics}}).Bytes();
  }

 private:
  const EnvFactory& make_env_;
  const agent::Decider& controller_;
  std::ostream *out_, *csv_;
  TimeNs offset_ = 0;
};

/// Closes the written file and replaces the old file by it.
void Finish(std::ofstream* out, DurableFile* file) {
  out->close();
  if (!*out) file->Fail("not all of it could be written; is the disk full?");
  file->Commit();
}

}  // namespace

void RecordEpisodes(const EnvFactory& make_env, const nlohmann::json& scene,
                    const agent::Decider& controller, std::uint64_t seed, int flown, int recorded,
                    const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw UserError(folder + ": cannot make the folder: " + error.message());
  DurableFile recording(folder + "/recording.stgv", "the recording");
  DurableFile log(folder + "/packets.csv", "the packet log");
  std::ofstream out(recording.temporary(), std::ios::binary);
  std::ofstream csv(log.temporary(), std::ios::binary);
  Recorder recorder(make_env, controller, &out, &csv);
  recorder.Meta(scene);
  const int total = (flown + kMixBlock - 1) / kMixBlock * kMixBlock;
  for (int e = 0; e < std::min(flown, recorded); ++e) recorder.Fly(e, seed, total);
  Finish(&out, &recording);
  Finish(&csv, &log);
}

}  // namespace stg::env
