#include "acoustic_channel/offline/traffic.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "auv_common/numbers/random.hpp"

namespace stg::acoustics {
namespace {

/// Later times never happen; this is three centuries.
constexpr double kEndOfTimeS = 9e9;

TimeNs Nanoseconds(double s) { return std::llround(s * 1e9); }

}  // namespace

Traffic::Traffic(std::vector<TrafficSpec> flows, std::uint64_t seed) : seed_(seed) {
  for (TrafficSpec& spec : flows) flows_.push_back({std::move(spec)});
  for (std::size_t i = 0; i < flows_.size(); ++i) {
    Schedule(i);
    if (!flows_[i].over) heap_.push_back(i);
  }
  const auto later = [this](std::size_t a, std::size_t b) {
    return std::make_tuple(flows_[a].next, a) > std::make_tuple(flows_[b].next, b);
  };
  std::make_heap(heap_.begin(), heap_.end(), later);
}

void Traffic::Schedule(std::size_t index) {
  Flow& flow = flows_[index];
  const std::uint32_t k = flow.next_index++;
  double next_s = 0.0;
  switch (flow.spec.kind) {
    case TrafficSpec::Kind::kPoisson: {
      Random random(seed_, Stream::kTraffic, 0, k, static_cast<std::uint32_t>(index));
      next_s = Seconds(flow.next) - std::log(1.0 - random.Uniform()) / flow.spec.rate_hz;
      break;
    }
    case TrafficSpec::Kind::kPeriodic:
      next_s = flow.spec.offset_s + k * flow.spec.period_s;
      break;
    case TrafficSpec::Kind::kAt:
      next_s = k < flow.spec.times_s.size() ? flow.spec.times_s[k] : kEndOfTimeS;
      break;
  }
  flow.over = next_s >= kEndOfTimeS;
  if (!flow.over) flow.next = Nanoseconds(next_s);
}

void Traffic::Take(TimeNs t, std::vector<Offer>* offers) {
  const auto later = [this](std::size_t a, std::size_t b) {
    return std::make_tuple(flows_[a].next, a) > std::make_tuple(flows_[b].next, b);
  };
  while (!heap_.empty() && flows_[heap_.front()].next <= t) {
    std::pop_heap(heap_.begin(), heap_.end(), later);
    const std::size_t index = heap_.back();
    const Flow& flow = flows_[index];
    offers->push_back({flow.next, flow.spec.source, flow.spec.destination, flow.spec.bytes});
    Schedule(index);
    if (flow.over) {
      heap_.pop_back();
    } else {
      std::push_heap(heap_.begin(), heap_.end(), later);
    }
  }
}

}  // namespace stg::acoustics
