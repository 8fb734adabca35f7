#include "stg_agent/estimation/target_filter.hpp"

namespace stg::agent {
namespace {

/// Oldest target estimate to send: the packet's age field ends at 32.767 s.
constexpr TimeNs kOldestShared = 30'000'000'000;

/// TargetTrack: its inputs are positions, own ones and fused estimates of others.
class KalmanFilter : public TargetFilter {
 public:
  explicit KalmanFilter(const AgentModel& model) : track_(model) {}

  bool Takes(dynamics::MeasurementKind kind, bool ambiguous) const override {
    return kind == dynamics::MeasurementKind::kPosition ||
           (kind == dynamics::MeasurementKind::kRangeBearing && !ambiguous);
  }
  void Clear() override {
    track_.Clear();
    now_ = 0;
  }
  void Start(const Vec3<double>& p_WT, double std_m, TimeNs stamp) override {
    track_.Start(p_WT, std_m, stamp);
  }
  void Predict(TimeNs now) override {
    now_ = now;
    track_.Predict(now);
  }
  void Fuse(const NeighbourState& s) override {
    if (s.target_stamp <= now_) track_.Fuse({s.target_stamp, s.p_WT, s.v_WT, s.target_std});
  }
  void Detect(const dynamics::Detection& detection) override { track_.Detect(detection); }

  TargetEstimate estimate() const override { return track_.estimate(); }
  TargetBelief belief() const override {
    const TargetEstimate& e = track_.estimate();
    TargetBelief b;
    b.stamp = e.stamp;
    b.information = track_.information_stamp();
    b.started = track_.started();
    b.observed = track_.observed();
    b.p_WT = e.p_WT;
    b.v_WT = e.v_WT;
    b.P_WT = {e.pp, 0.0, 0.0, e.pp, 0.0, e.pp};
    return b;
  }

  void Tell(bool lost, NeighbourState* state) const override {
    // Only estimates from an observation are sent, because all AUVs know the cue already.
    state->has_target =
        !lost && track_.observed() && now_ - track_.information_stamp() <= kOldestShared;
    if (!state->has_target) return;
    const SharedEstimate& shared = track_.shareable();
    state->target_stamp = shared.stamp;
    state->p_WT = shared.p_WT;
    state->v_WT = shared.v_WT;
    state->target_std = shared.std_m;
  }

 private:
  TargetTrack track_;
  TimeNs now_ = 0;
};

std::unique_ptr<TargetFilter> MakeKalmanFilter(const AgentModel& model, const int&) {
  return std::make_unique<KalmanFilter>(model);
}

}  // namespace

FilterRegistry::Entry KalmanFilterEntry() { return {"kalman", MakeKalmanFilter}; }

}  // namespace stg::agent
