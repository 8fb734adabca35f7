#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "comparison.hpp"
#include "moments.hpp"
#include "snapshot.hpp"
#include "stg_agent/estimation/target_filter.hpp"

namespace stg::agent {
namespace {

using dynamics::Detection;

constexpr int kMostComponents = 28;  ///< while a detection is used
constexpr int kKeptComponents = 12;  ///< after a detection
constexpr int kSnapshots = 24;
constexpr std::size_t kMostSightings = 512;
constexpr std::size_t kForgottenTogether = 32;  ///< sightings; so the others move less often

/// Two ranges give two places, mirrored at the line between the observers. The filter may choose
/// the wrong one when the target crosses this line, so the other one gets some weight each period.
constexpr TimeNs kMirrorPeriod = 5'000'000'000;
constexpr double kMirrorWeight = 0.03;
/// Three observers around the target can distinguish the two places, so less weight is enough. Some
/// is always needed, because AUVs that are close together may also surround a wrong place.
constexpr double kLeastMirrorWeight = 0.002;
constexpr TimeNs kAlone = 20'000'000'000;  ///< after the last sighting of a third observer
constexpr double kLeastSurround = 0.3;     ///< from this value on, less weight is enough

DriftModel DriftModelOf(const AgentModel& s) {
  return {s.navigation.current_std_mps, s.track.shear_std_mps * s.track.shear_std_mps,
          s.track.shear_memory_s, s.navigation.start_std_m * s.navigation.start_std_m};
}

/// Gaussian-sum filter of one target for measurements of all kinds, own and shared. The navigation
/// errors of the AUVs that share them are states. The sightings are in a list by time. If one
/// arrives late, the filter goes back to a snapshot before it and uses the list again from there.
/// So the result depends only on the set of sightings, not on when and in which order they arrive.
class MeasurementFilter : public TargetFilter {
 public:
  MeasurementFilter(const AgentModel& s, int self)
      : model_(s),
        self_(self),
        same_(std::max<TimeNs>(1, s.run.decision_period() / 16)),
        memory_(static_cast<TimeNs>(s.track.memory_s * 1e9)),
        spacing_(static_cast<TimeNs>(s.track.share_spacing_s * 1e9)),
        oldest_shared_(std::min(memory_, 127 * s.run.decision_period())),
        now_(model_.layout(), DriftModelOf(s), self, kMostComponents),
        view_(model_.layout().own_states(), model_.layout().own_states(), kKeptComponents) {
    snapshots_.reserve(kSnapshots);
    for (int k = 0; k < kSnapshots; ++k) {
      snapshots_.emplace_back(model_.layout(), DriftModelOf(s), self, kKeptComponents);
    }
    sightings_.reserve(kMostSightings + 1);
    if (!s.sensing.labelled) {
      comparison_.emplace(model_,
                          Snapshot(model_.layout(), DriftModelOf(s), self, kMostComponents));
    }
  }

  bool Takes(dynamics::MeasurementKind, bool) const override { return true; }
  bool Associates() const override { return true; }
  PacketLayout layout() const override { return PacketLayout::kMeasurements; }

  void Clear() override {
    if (comparison_) comparison_->Forget();
    sightings_.clear();
    played_ = 0;
    now_.Clear(-kAlone);
    first_ = 0;
    kept_ = 0;
    Keep();
    belief_ = TargetBelief();
    estimate_ = TargetEstimate();
  }

  void Start(const Vec3<double>& p_WT, double std_m, TimeNs stamp) override {
    if (comparison_) comparison_->Forget();
    now_.mixture.Clear();
    now_.observers.Clear();
    model_.Datum(p_WT, std_m, now_.mixture.Add(), now_.mixture.stride());
    now_.stamp = now_.information = stamp;
    now_.covers = stamp - 1;
    now_.observed = false;
    played_ = 0;
    first_ = kept_ = 0;
    Keep();
  }

  void Hear(const NeighbourState& packet) override {
    for (const Detection& d : packet.sightings) Insert({d, packet.source});
  }

  void Predict(TimeNs) override {}

  void Detect(const Detection& detection) override { Insert({detection, self_}); }

  DetectionFit Fit(const Detection& d, int source) override {
    if (!comparison_->IsOf(d, source)) {
      while (played_ < sightings_.size() && sightings_[played_].detection.stamp <= d.stamp) Play();
      const Snapshot* from = &now_;  // for a late detection, the last snapshot up to its time
      for (int k = kept_; from->covers > d.stamp && k > 0;) from = &Kept(--k);
      comparison_->Start(*from, d, source);
    }
    DetectionFit fit = comparison_->Fit(d);
    fit.started = now_.mixture.size() > 0;
    return fit;
  }

  void Assign(const Detection& d, int source, double rivals) override {
    Insert({d, source, rivals});
  }

  void Settle(TimeNs now, const OwnFrame& own) override {
    own_ = own;
    while (played_ < sightings_.size() && sightings_[played_].detection.stamp <= now) Play();
    Forget();
    Tell(now);
  }

  TargetEstimate estimate() const override { return estimate_; }
  TargetBelief belief() const override { return belief_; }

  void Tell(bool, NeighbourState* state) const override {
    state->sightings.clear();
    for (auto it = sightings_.rbegin(); it != sightings_.rend(); ++it) {
      const Detection& d = it->detection;
      if (state->sightings.size() == kSightings || state->generation - d.stamp > oldest_shared_)
        break;
      if (it->source != self_ || d.stamp > state->generation) continue;
      if (!state->sightings.empty() && state->sightings[0].stamp - d.stamp < spacing_) continue;
      state->sightings.push_back(d);
    }
    state->has_target = !state->sightings.empty();
  }

 private:
  Snapshot& Kept(int k) { return snapshots_[static_cast<std::size_t>((first_ + k) % kSnapshots)]; }

  void Keep() {
    if (kept_ == kSnapshots) {
      first_ = (first_ + 1) % kSnapshots;
      --kept_;
    }
    Kept(kept_++) = now_;
  }

  /// Removes sightings that no snapshot needs any more.
  void Forget() {
    std::size_t old = 0;
    while (old < played_ && sightings_[old].detection.stamp <= Kept(0).covers) ++old;
    if (old < kForgottenTogether && sightings_.size() < kMostSightings) return;
    sightings_.erase(sightings_.begin(), sightings_.begin() + static_cast<std::ptrdiff_t>(old));
    played_ -= old;
  }

  static bool Before(const Sighting& a, const Sighting& b) {
    if (a.detection.stamp != b.detection.stamp) return a.detection.stamp < b.detection.stamp;
    return a.source < b.source;
  }

  void Insert(const Sighting& s) {
    const TimeNs stamp = s.detection.stamp;
    if (stamp <= Kept(0).covers || stamp < belief_.stamp - memory_) return;
    const auto at = std::lower_bound(sightings_.begin(), sightings_.end(), s, Before);
    // Later packets of the source repeat the same sighting.
    for (auto it = at; it != sightings_.end() && it->detection.stamp - stamp < same_; ++it) {
      if (it->source == s.source) return;
    }
    for (auto it = at; it != sightings_.begin();) {
      --it;
      if (stamp - it->detection.stamp >= same_) break;
      if (it->source == s.source) return;
    }
    if (sightings_.size() == kMostSightings) return;
    if (comparison_) comparison_->Forget();
    const auto index = static_cast<std::size_t>(at - sightings_.begin());
    sightings_.insert(at, s);
    if (index < played_) Rewind(stamp);
  }

  /// Goes back to a snapshot before a time.
  void Rewind(TimeNs stamp) {
    while (kept_ > 1 && Kept(kept_ - 1).covers >= stamp) --kept_;
    now_ = Kept(kept_ - 1);
    played_ = 0;
    while (played_ < sightings_.size() && sightings_[played_].detection.stamp <= now_.covers) {
      ++played_;
    }
  }

  /// Uses the next sighting of the list.
  void Play() {
    const Sighting& next = sightings_[played_];
    const TimeNs stamp = next.detection.stamp;
    // A snapshot contains all sightings of its last instant.
    if (now_.covers < stamp && stamp - Kept(kept_ - 1).covers > memory_ / (kSnapshots - 1) &&
        now_.covers > Kept(kept_ - 1).covers) {
      Keep();
    }
    ++played_;
    Take(next);
    now_.covers = stamp;
  }

  void Take(const Sighting& s) {
    const Detection& d = s.detection;
    GaussianMixture& mixture = now_.mixture;
    const bool fresh = mixture.size() == 0;
    const double since_s = Seconds(d.stamp - now_.stamp);
    if (fresh) {
      model_.Seed(d, &mixture);
      now_.observers.Clear();
    } else {
      model_.Predict(since_s, &mixture);
      now_.observers.Predict(since_s, &mixture);
      if (mixture.size() > 1) model_.DoubtTheFast(since_s, &mixture);
    }
    now_.stamp = d.stamp;
    const int slot =
        now_.observers.Admit(s.source, d.stamp, d.p_WO_std_m, d.heading_std_rad, &mixture);
    if (!fresh) SplitFor(d, slot);
    const int ways = d.ambiguous ? 2 : 1;
    if (ways == 2) {
      if (mixture.size() > kMostComponents / 2) mixture.Reduce(kMostComponents / 2);
      for (int k = mixture.size() - 1; k >= 0; --k) mixture.Copy(k);
    }
    const int one_way = mixture.size() / ways;
    for (int k = 0; k < mixture.size(); ++k) {
      model_.Update(d, slot, k >= one_way, s.rivals, &mixture, k);
    }
    mixture.Normalise();
    mixture.Reduce(kKeptComponents);
    now_.surround.LookFrom(d.p_WO, since_s, mixture);
    if (now_.last.source != s.source) {
      if (now_.other.source >= 0 && now_.other.source != s.source) {
        now_.third = now_.other.detection.stamp;
      }
      now_.other = now_.last;
    }
    now_.last = s;
    GiveMirrorAChance();
    now_.observed = true;
    now_.information = d.stamp;
  }

  void GiveMirrorAChance() {
    const Sighting &a = now_.last, &b = now_.other;
    if (a.detection.kind != dynamics::MeasurementKind::kRange || b.source < 0 ||
        a.detection.stamp - b.detection.stamp > kMirrorPeriod ||
        a.detection.stamp - now_.mirrored < kMirrorPeriod || now_.mixture.full()) {
      return;
    }
    now_.mirrored = a.detection.stamp;
    const bool clear =
        a.detection.stamp - now_.third < kAlone && now_.surround.Share() > kLeastSurround;
    const double weight = clear ? kLeastMirrorWeight : kMirrorWeight;
    if (model_.AddMirror(a.detection.p_WO, b.detection.p_WO, weight, &now_.mixture)) {
      now_.mixture.Normalise();
      now_.mixture.Reduce(kKeptComponents);
    }
  }

  /// Splits components that are too wide for the linearisation of a detection, the heaviest first.
  void SplitFor(const Detection& d, int slot) {
    GaussianMixture& mixture = now_.mixture;
    std::array<double, kMostComponents> excess, variance;
    alignas(32) double Pa[kMostComponents][kMostStride];
    const auto measure = [&](int k) {
      const auto i = static_cast<std::size_t>(k);
      excess[i] = model_.Excess(d, slot, mixture, k, Pa[i], &variance[i]);
    };
    for (int k = 0; k < mixture.size(); ++k) measure(k);
    while (mixture.size() + 2 <= mixture.capacity()) {
      int worst = -1;
      double most = 0.0;
      for (int k = 0; k < mixture.size(); ++k) {
        const double e = excess[static_cast<std::size_t>(k)];
        const double matters = *mixture.at(k).weight * e;
        if (e > 1.0 && matters > most) {
          most = matters;
          worst = k;
        }
      }
      if (worst < 0) return;
      mixture.Split(worst, Pa[worst], variance[static_cast<std::size_t>(worst)]);
      measure(worst);
      measure(mixture.size() - 2);
      measure(mixture.size() - 1);
    }
  }

  /// Computes the estimate at a time.
  void Tell(TimeNs now) {
    belief_ = TargetBelief();
    estimate_ = TargetEstimate();
    belief_.stamp = estimate_.stamp = now;
    belief_.started = now_.mixture.size() > 0;
    if (!belief_.started) return;
    belief_.information = now_.information;
    belief_.observed = now_.observed;
    view_.Clear();
    for (int k = 0; k < now_.mixture.size(); ++k) view_.AddPart(now_.mixture, k);
    model_.Predict(Seconds(now - now_.stamp), &view_);
    const bool in_own_frame = model_.layout().relative();
    SetMoments(view_, model_.layout().per_observer > 0 && !in_own_frame, &belief_, &estimate_);
    if (in_own_frame) ToWorld();
  }

  /// Converts from the own frame to the world.
  void ToWorld() {
    PlaneError e;
    e.xx = e.yy = own_.position_std_m * own_.position_std_m;
    if (own_.error) e = *own_.error;
    belief_.p_WT = belief_.p_WT - Vec3<double>{e.x, e.y, 0.0};
    belief_.P_WT.xx += e.xx;
    belief_.P_WT.xy += e.xy;
    belief_.P_WT.yy += e.yy;
  }

  SightingModel model_;
  int self_;
  TimeNs same_;  // two sightings of one source that are closer than this are the same
  TimeNs memory_, spacing_, oldest_shared_;
  std::vector<Sighting> sightings_;  // by time, then by source
  std::size_t played_ = 0;           // number of sightings that are in now_
  Snapshot now_;
  std::vector<Snapshot> snapshots_;  // used as a ring
  int first_ = 0, kept_ = 0;
  std::optional<Comparison> comparison_;  // only with unlabelled detections
  OwnFrame own_;                          // at present
  GaussianMixture view_;                  // target and own errors at present
  TargetBelief belief_;
  TargetEstimate estimate_;
};

}  // namespace

FilterRegistry::Entry MeasurementFilterEntry() {
  return {"measurements", std::make_unique<MeasurementFilter, const AgentModel&, const int&>};
}

}  // namespace stg::agent
