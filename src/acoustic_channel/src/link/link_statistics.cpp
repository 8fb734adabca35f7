#include "acoustic_channel/link/link_statistics.hpp"

#include <algorithm>

namespace stg::acoustics {
namespace {

/// Integral of t - freshest over [from, to] [s^2].
double AgeArea(TimeNs freshest, TimeNs from, TimeNs to) {
  return Seconds(to - from) * 0.5 * (Seconds(from - freshest) + Seconds(to - freshest));
}

}  // namespace

const char* ToString(DropReason reason) {
  switch (reason) {
    case DropReason::kNone:
      return "none";
    case DropReason::kRange:
      return "range";
    case DropReason::kLoss:
      return "loss";
    case DropReason::kCollision:
      return "collision";
    case DropReason::kHalfDuplex:
      return "half_duplex";
    case DropReason::kFading:
      return "fading";
    case DropReason::kBurst:
      return "burst";
    case DropReason::kQueue:
      return "queue";
    case DropReason::kNotAcquired:
      return "not_acquired";
    case DropReason::kShadow:
      return "shadow";
    case DropReason::kLeft:
      return "left";
  }
  return "none";
}

LinkTable::LinkTable(int agents)
    : agents_(agents),
      entries_(static_cast<std::size_t>(agents) * static_cast<std::size_t>(agents)),
      drops_(entries_.size()) {
  Reset(0);
}

void LinkTable::Reset(TimeNs start) {
  start_ = start;
  totals_ = ChannelTotals{};
  Entry empty{};
  empty.freshest = start;
  empty.last_event = start;
  std::fill(entries_.begin(), entries_.end(), empty);
  std::fill(drops_.begin(), drops_.end(), DropCounts{});
}

void LinkTable::Drop(int source, int destination, DropReason reason) {
  const std::size_t link = Index(source, destination);
  entries_[link].last_drop = reason;
  ++drops_[link][static_cast<std::size_t>(reason)];
  ++totals_.dropped;
  ++totals_.drops[static_cast<std::size_t>(reason)];
}

void LinkTable::Deliver(int source, int destination, TimeNs generation, TimeNs transmit,
                        TimeNs arrival) {
  Entry& e = entries_[Index(source, destination)];
  const TimeNs at = std::max(arrival, e.last_event);
  e.integral_s2 += AgeArea(e.freshest, e.last_event, at);
  e.last_event = at;
  e.delay_sum_s += Seconds(arrival - transmit);
  ++e.delivered;
  ++totals_.delivered;
  // The first delivery replaces the assumed update at the start, even if its data is not newer.
  if (generation > e.freshest || e.resets == 0) {
    const double peak = Seconds(at - e.freshest);
    e.peak_sum_s += peak;
    e.max_peak_s = std::max(e.max_peak_s, peak);
    ++e.resets;
    e.freshest = generation;
  }
}

LinkStatistics LinkTable::At(int source, int destination, TimeNs now) const {
  const std::size_t link = Index(source, destination);
  const Entry& e = entries_[link];
  const TimeNs at = std::max(now, e.last_event);
  LinkStatistics s;
  s.age_s = Seconds(at - e.freshest);
  s.average_age_s =
      at > start_ ? (e.integral_s2 + AgeArea(e.freshest, e.last_event, at)) / Seconds(at - start_)
                  : s.age_s;
  s.max_age_s = std::max(e.max_peak_s, s.age_s);
  if (e.resets > 0) s.peak_age_s = e.peak_sum_s / static_cast<double>(e.resets);
  s.delivered = e.delivered;
  if (e.delivered > 0) s.mean_delay_s = e.delay_sum_s / static_cast<double>(e.delivered);
  s.last_drop = e.last_drop;
  s.drops = drops_[link];
  for (const std::uint64_t count : s.drops) s.dropped += count;
  return s;
}

}  // namespace stg::acoustics
