#include "swarm_frames.hpp"

#include <algorithm>

namespace stg::nodes {
namespace {

/// Memory for a run whose frames never get complete.
constexpr std::size_t kMaxFrames = 5000;

template <class Messages>
bool All(const Messages& messages) {
  return std::all_of(messages.begin(), messages.end(), [](const auto& m) { return m != nullptr; });
}

}  // namespace

bool SwarmFrame::Complete() const { return truth && All(tasks) && All(wrenches); }

SwarmFrames::SwarmFrames(int agents) : agents_(static_cast<std::size_t>(agents)) {}

SwarmFrame* SwarmFrames::At(const ros::Time& stamp) {
  const bool clock_went_back = taken_ - stamp > ros::Duration(60.0);
  if (clock_went_back) {  // the world was started anew
    frames_.clear();
    taken_ = ros::Time();
  }
  if (stamp <= taken_) return nullptr;
  const auto found = frames_.find(stamp);
  if (found != frames_.end()) return &found->second;
  if (frames_.size() >= kMaxFrames) frames_.erase(frames_.begin());
  SwarmFrame frame;
  frame.tasks.resize(agents_);
  frame.wrenches.resize(agents_);
  frame.opened = ros::WallTime::now();
  return &frames_.emplace(stamp, std::move(frame)).first->second;
}

bool SwarmFrames::Take(double patience_s, SwarmFrame* frame) {
  if (frames_.empty()) return false;
  const auto oldest = frames_.begin();
  const bool old =
      frames_.size() > 1 && (ros::WallTime::now() - oldest->second.opened).toSec() > patience_s;
  if (!oldest->second.Complete() && !old) return false;
  *frame = std::move(oldest->second);
  taken_ = oldest->first;
  frames_.erase(oldest);
  return true;
}

}  // namespace stg::nodes
