#include "auv_common/step/step_barrier.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace stg {
namespace {

/// Distance of any two points in time. A signed difference could overflow.
std::uint64_t Distance(TimeNs a, TimeNs b) {
  const auto low = static_cast<std::uint64_t>(std::min(a, b));
  const auto high = static_cast<std::uint64_t>(std::max(a, b));
  return high - low;
}

}  // namespace

StepBarrier::StepBarrier(int parties, TimeNs period) : recent_(std::max(kRecent, 3 * period)) {
  assert(parties >= 0 && period >= 0);
  parties_.resize(static_cast<std::size_t>(parties));
  given_up_.reserve(parties_.size());
}

StepBarrier::Opening StepBarrier::Open(TimeNs stamp, double deadline_s) {
  assert(!std::isnan(deadline_s));
  if (has_stamp_ && stamp == stamp_) return Opening::kRepeated;
  const bool replaced = open_;
  open_ = has_stamp_ = true;
  stamp_ = stamp;
  deadline_s_ = deadline_s;
  for (Party& party : parties_) {
    party.answered = party.excused = false;
    // A party that still owes an answer keeps its earlier deadline.
    party.deadline_s = party.owes ? std::min(party.deadline_s, deadline_s) : deadline_s;
    party.owed = party.owes;
    party.owes = true;
  }
  return replaced ? Opening::kReplaced : Opening::kOpened;
}

StepBarrier::Word StepBarrier::Hear(int index, TimeNs stamp) {
  Party& party = At(index);
  if (has_stamp_ && Distance(stamp, stamp_) >= static_cast<std::uint64_t>(recent_)) {
    return Word::kForeign;
  }
  party.present = true;
  party.owes = party.owed = false;
  party.deadline_s = deadline_s_;
  if (!has_stamp_ || stamp > stamp_) return Word::kEarly;
  if (stamp < stamp_) return Word::kLate;
  if (party.answered) return Word::kDuplicate;
  if (!open_) return Word::kLate;
  party.answered = true;
  return Word::kCounts;
}

void StepBarrier::Excuse(int index) {
  assert(open_);
  Party& party = At(index);
  party.excused = true;
  party.owes = party.owes && party.owed;
}

const std::vector<int>& StepBarrier::GiveUp(double now_s) {
  assert(!std::isnan(now_s));
  given_up_.clear();
  for (int i = 0; i < parties(); ++i) {
    Party& party = At(i);
    if (!WaitsFor(party) || now_s < party.deadline_s) continue;
    party.present = false;
    ++party.losses;
    given_up_.push_back(i);
  }
  return given_up_;
}

bool StepBarrier::Complete(int first, int last) const {
  assert(0 <= first && first <= last && last <= parties());
  if (!open_) return false;
  return std::none_of(parties_.begin() + first, parties_.begin() + last,
                      [this](const Party& party) { return WaitsFor(party); });
}

void StepBarrier::Close() {
  assert(open_);
  open_ = false;
  started_ = true;
  for (Party& party : parties_) {
    if (!party.answered && !party.excused) ++party.misses;
  }
}

void StepBarrier::Extend(double deadline_s) {
  assert(!std::isnan(deadline_s));
  deadline_s_ = deadline_s;
  for (Party& party : parties_) party.deadline_s = deadline_s;
}

void StepBarrier::Restart() {
  open_ = started_ = has_stamp_ = false;
  for (Party& party : parties_) {
    party.present = true;
    party.answered = party.excused = party.owes = party.owed = false;
  }
}

double StepBarrier::deadline_s() const {
  double earliest_s = std::numeric_limits<double>::infinity();
  for (const Party& party : parties_) {
    if (WaitsFor(party)) earliest_s = std::min(earliest_s, party.deadline_s);
  }
  return earliest_s;
}

StepBarrier::Party& StepBarrier::At(int party) {
  assert(party >= 0 && party < parties());
  return parties_[static_cast<std::size_t>(party)];
}

const StepBarrier::Party& StepBarrier::At(int party) const {
  assert(party >= 0 && party < parties());
  return parties_[static_cast<std::size_t>(party)];
}

bool StepBarrier::WaitsFor(const Party& party) const {
  return open_ && party.present && !party.answered && !party.excused;
}

}  // namespace stg
