// A target filter of your own: it takes the target to be where an AUV saw it last. The longer ago
// that was, the less certain it is. See docs/how_to/in_this_repository.md.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "auv_common/config/loader.hpp"
#include "auv_common/plugin.hpp"
#include "stg_agent/agent/agent.hpp"
#include "stg_agent/estimation/target_filter.hpp"

namespace {

using namespace stg;
using namespace stg::agent;

struct LastSeenOptions {
  double speed_std_mps = 0.01;
};

void Describe(LastSeenOptions* o, config::Table* t) {
  t->Add("speed_std_mps", &o->speed_std_mps, config::Positive(100), "m/s",
         "standard deviation of each component of the target's velocity");
}

class LastSeen : public TargetFilter {
 public:
  LastSeen(const LastSeenOptions& options, const AgentModel& model)
      : vv_(options.speed_std_mps * options.speed_std_mps),
        floor_m_(model.track.measurement_std_m) {}

  bool Takes(dynamics::MeasurementKind kind, bool /*ambiguous*/) const override {
    return kind == dynamics::MeasurementKind::kPosition;
  }
  void Clear() override {
    last_ = Sight();
    now_ = 0;
  }
  void Start(const Vec3<double>& p_WT, double std_m, TimeNs stamp) override {
    last_ = {p_WT, std::max(std_m, floor_m_), stamp, true, false};
  }
  void Predict(TimeNs now) override { now_ = now; }
  void Fuse(const NeighbourState& s) override { See(s.p_WT, s.target_std, s.target_stamp); }
  void Detect(const dynamics::Detection& d) override { See(d.p_WT, d.std_m, d.stamp); }

  TargetEstimate estimate() const override {
    const double age_s = Seconds(now_ - last_.stamp);
    const double pp = last_.std_m * last_.std_m + vv_ * age_s * age_s;
    return {now_, last_.p_WT, {}, pp, vv_ * age_s, vv_};
  }
  TargetBelief belief() const override {
    const double pp = estimate().pp;
    const Covariance3 P_WT{pp, 0.0, 0.0, pp, 0.0, pp};
    const Sight& s = last_;
    return {now_, s.stamp, s.started, s.observed, s.p_WT, {}, P_WT};
  }
  void Tell(bool lost, NeighbourState* packet) const override {
    // The age field of a packet ends at 32 s. All AUVs know the cue, so only a sight is sent.
    packet->has_target = !lost && last_.observed && Seconds(now_ - last_.stamp) < 30.0;
    if (!packet->has_target) return;
    packet->target_stamp = last_.stamp;
    packet->p_WT = last_.p_WT;
    packet->target_std = last_.std_m;
  }

 private:
  struct Sight {
    Vec3<double> p_WT;
    double std_m = 0.0;  // of each component
    TimeNs stamp = 0;
    bool started = false, observed = false;
  };

  /// The newest sight of any AUV counts. So a sight that comes back in a packet has no effect.
  void See(const Vec3<double>& p_WT, double std_m, TimeNs stamp) {
    if (stamp > now_ || (last_.observed && stamp <= last_.stamp)) return;
    last_ = {p_WT, std::max(std_m, floor_m_), stamp, true, true};
  }

  double vv_;  // variance of each component of the velocity [m^2/s^2]
  double floor_m_;
  Sight last_;
  TimeNs now_ = 0;
};

std::unique_ptr<TargetFilter> MakeLastSeen(const LastSeenOptions& options, const AgentModel& model,
                                           const int& /*self*/) {
  return std::make_unique<LastSeen>(options, model);
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN { TargetFilters().Add("last_seen", MakeLastSeen); }

int main() {
  stg_plugin_register();

  AgentScenario config;
  config.run.agents = 1;
  config::Override(&config, {"track.filter=last_seen", "track.last_seen.speed_std_mps=0.02"});
  Agent agent(config.model(), 0);
  const Vec3<double> p_WT{0.1, 0.0, 0.0};
  dynamics::Cue cue;
  cue.p_WT = p_WT;
  agent.Reset(0, cue);

  // It sees the target once. Ten seconds later, the deviation has grown by 0.02 m/s.
  std::vector<float> observation(static_cast<std::size_t>(config.model().observation_size()));
  dynamics::NavState nav;
  agent.Detect({nav.stamp, 0, p_WT, 0.03});
  for (int k = 0; k * config.run.decision_dt_s() <= 10.0; ++k) {
    nav.stamp = k * config.run.decision_period();
    agent.Observe(nav, observation.data());
  }
  const double seen_m = Norm(agent.belief().p_WT - p_WT), std_m = agent.belief().position_std_m();
  std::printf("after %.0f s the deviation is %.3f m\n", Seconds(nav.stamp), std_m);
  return seen_m == 0.0 && std::abs(std_m - std::hypot(0.03, 0.2)) < 1e-9 ? 0 : 1;
}
