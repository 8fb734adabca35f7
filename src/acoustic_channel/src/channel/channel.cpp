#include "acoustic_channel/channel/channel.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "acoustic_channel/link/link_quality.hpp"
#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::acoustics {
namespace {

template <class T>
struct LinkValues {
  T loss, quality;
};

/// Eq. 5: no delay, no loss inside R_c.
class RangeModel {
 public:
  explicit RangeModel(const ChannelConfig& config) : range_m_(config.range_m) {}

  template <class T>
  T DelayS(const T& /*d*/) const {
    return T(0.0);
  }
  template <class T>
  LinkValues<T> At(const T& d, const T& /*age_s*/) const {
    return {T(0.0), RangeQuality(d, range_m_)};
  }
  bool Reaches(double d) const { return RangeQuality(d, range_m_) > 0.0; }
  bool ages() const { return false; }

 private:
  double range_m_;
};

/// Eq. 6: attenuation, random loss, propagation delay, freshness.
class ExtendedModel {
 public:
  explicit ExtendedModel(const ChannelConfig& config) : config_(config) {}

  template <class T>
  T DelayS(const T& d) const {
    return d / T(config_.sound_speed_mps);
  }
  template <class T>
  LinkValues<T> At(const T& d, const T& age_s) const {
    return {LossProbability(d, config_), ExtendedQuality(d, age_s, config_)};
  }
  bool Reaches(double d) const { return d <= config_.max_range_m; }
  bool ages() const { return true; }

 private:
  ChannelConfig config_;
};

/// A channel whose every link is independent of all others, so that a packet's fate is known
/// when it is sent. Cost: one model evaluation and one draw per packet and receiver.
template <class Model>
class IndependentLinks : public Channel {
 public:
  IndependentLinks(const ChannelConfig& config, int nodes)
      : agents_(nodes),
        padded_((nodes + kLanes - 1) / kLanes * kLanes),
        model_(config),
        table_(nodes),
        pending_(static_cast<std::size_t>(agents_)) {
    for (std::vector<double>* v : {&x_, &y_, &z_, &distance_, &loss_, &quality_, &delay_s_}) {
      v->assign(static_cast<std::size_t>(padded_), 0.0);
    }
    for (auto& queue : pending_) queue.reserve(static_cast<std::size_t>(agents_));
    ripe_.reserve(static_cast<std::size_t>(agents_));
  }

  void Reset(std::uint64_t seed, std::uint32_t episode) override {
    seed_ = seed;
    episode_ = episode;
    started_ = false;
    table_.Reset(0);
    for (auto& queue : pending_) queue.clear();
    for (std::vector<double>* v : {&x_, &y_, &z_}) std::fill(v->begin(), v->end(), 0.0);
  }

  void Step(TimeNs t, std::uint32_t step, const std::vector<Vec3<double>>& p_W,
            const std::vector<Transmission>& sent) override {
    assert(static_cast<int>(p_W.size()) == agents_);
    if (!started_) {
      table_.Reset(t);
      started_ = true;
    }
    Place(p_W);
    for (const Transmission& packet : sent) Send(t, step, packet);
  }

  void Deliver(int destination, TimeNs until, std::vector<Reception>* out) override {
    auto& queue = pending_[static_cast<std::size_t>(destination)];
    if (queue.empty()) return;
    ripe_.clear();
    for (std::size_t i = 0; i < queue.size(); ++i) {
      if (queue[i].arrival <= until) ripe_.push_back({queue[i].arrival, queue[i].source, i});
    }
    if (ripe_.size() > 1) std::sort(ripe_.begin(), ripe_.end());
    for (const Ripe& ripe : ripe_) {
      const Reception& r = queue[ripe.index];
      table_.Deliver(r.source, destination, r.generation, r.transmit, r.arrival);
      out->push_back(r);
    }
    if (ripe_.size() == queue.size()) {
      queue.clear();
    } else {
      queue.erase(std::remove_if(queue.begin(), queue.end(),
                                 [until](const Reception& r) { return r.arrival <= until; }),
                  queue.end());
    }
  }

  LinkStatistics Link(int source, int destination, TimeNs now) const override {
    assert(source >= 0 && source < agents_ && destination >= 0 && destination < agents_);
    if (source == destination) return {};
    LinkStatistics s = table_.At(source, destination, now);
    if (!started_) return s;
    const std::size_t i = static_cast<std::size_t>(source);
    const std::size_t j = static_cast<std::size_t>(destination);
    s.distance_m = Norm(Vec3<double>{x_[j] - x_[i], y_[j] - y_[i], z_[j] - z_[i]});
    const LinkValues<double> link = model_.At(s.distance_m, s.age_s);
    s.delay_s = model_.DelayS(s.distance_m);
    const bool reaches = model_.Reaches(s.distance_m);
    s.loss_probability = reaches ? link.loss : 1.0;
    // Without any information its freshness is none, whatever the age convention says.
    const bool informed = !model_.ages() || s.delivered > 0;
    s.quality = reaches && informed ? link.quality : 0.0;
    return s;
  }

  const ChannelTotals& totals() const override { return table_.totals(); }

 private:
  struct Ripe {
    TimeNs arrival;
    int source;
    std::size_t index;  ///< in order of sending
    bool operator<(const Ripe& o) const {
      if (arrival != o.arrival) return arrival < o.arrival;
      if (source != o.source) return source < o.source;
      return index < o.index;
    }
  };

  void Place(const std::vector<Vec3<double>>& p_W) {
    double finite = 0.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(agents_); ++i) {
      const Vec3<double>& p = p_W[i];
      finite += (p.x + p.y + p.z) * 0.0;
      x_[i] = p.x;
      y_[i] = p.y;
      z_[i] = p.z;
    }
    if (!(finite == 0.0)) throw std::invalid_argument("Channel::Step: non-finite position");
  }

  void Send(TimeNs t, std::uint32_t step, const Transmission& packet) {
    assert(packet.source >= 0 && packet.source < agents_);
    assert(packet.stamp == t && packet.generation <= t);
    Evaluate(packet.source, Seconds(t - packet.generation));
    for (int destination = 0; destination < agents_; ++destination) {
      if (destination == packet.source) continue;
      const auto j = static_cast<std::size_t>(destination);
      if (!model_.Reaches(distance_[j])) {
        table_.Drop(packet.source, destination, DropReason::kRange);
        continue;
      }
      if (loss_[j] > 0.0) {
        Random random(seed_, Stream::kChannel, episode_, step,
                      static_cast<std::uint32_t>(packet.source * agents_ + destination));
        if (random.Uniform() < loss_[j]) {
          table_.Drop(packet.source, destination, DropReason::kLoss);
          continue;
        }
      }
      Reception& r = pending_[j].emplace_back();
      r.source = packet.source;
      r.destination = destination;
      r.sequence = packet.sequence;
      r.generation = packet.generation;
      r.transmit = t;
      r.arrival = t + static_cast<TimeNs>(delay_s_[j] * 1e9 + 0.5);
      r.distance_m = distance_[j];
      r.travel_time_s = delay_s_[j];
      r.loss_probability = loss_[j];
      r.link_quality = quality_[j];
      r.data = packet.data;
    }
  }

  /// Links from `source` to everybody into the scratch arrays, for a payload of this age at
  /// transmission; quality is that at arrival.
  void Evaluate(int source, double age_s) {
    const auto s = static_cast<std::size_t>(source);
    const Vec3<Pack> origin = Broadcast({x_[s], y_[s], z_[s]});
    for (std::size_t j = 0; j < static_cast<std::size_t>(padded_);
         j += static_cast<std::size_t>(kLanes)) {
      const Vec3<Pack> p{Pack::load_unaligned(&x_[j]), Pack::load_unaligned(&y_[j]),
                         Pack::load_unaligned(&z_[j])};
      const Pack d = Norm(p - origin);
      const Pack delay_s = model_.DelayS(d);
      const LinkValues<Pack> link = model_.At(d, Pack(age_s) + delay_s);
      d.store_unaligned(&distance_[j]);
      link.loss.store_unaligned(&loss_[j]);
      link.quality.store_unaligned(&quality_[j]);
      delay_s.store_unaligned(&delay_s_[j]);
    }
  }

  const int agents_, padded_;
  const Model model_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  bool started_ = false;
  LinkTable table_;
  std::vector<double> x_, y_, z_;                            ///< positions, padded to whole packs
  std::vector<double> distance_, loss_, quality_, delay_s_;  ///< scratch of one sender
  std::vector<std::vector<Reception>> pending_;              ///< per destination, as sent
  std::vector<Ripe> ripe_;                                   ///< scratch of Deliver
};

}  // namespace

std::unique_ptr<Channel> MakeChannel(const ChannelConfig& config, int nodes) {
  switch (config.model) {
    case ChannelModel::kRange:
      return std::make_unique<IndependentLinks<RangeModel>>(config, nodes);
    case ChannelModel::kExtended:
      return std::make_unique<IndependentLinks<ExtendedModel>>(config, nodes);
    case ChannelModel::kPhysical:
      break;
  }
  throw UserError("channel.model: the physical model is not available yet; use range or extended");
}

}  // namespace stg::acoustics
