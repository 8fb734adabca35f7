#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "auv_common/time.hpp"

namespace stg::learn {

/// Episodes of one source while they are recorded. Number and start time identify an episode, so
/// two runs in one bag do not mix. Episode has a member `heard`, the number of the source's last
/// message about it.
template <class Episode>
class OpenEpisodes {
 public:
  /// The episode. If there is none, `make` makes it. Null: it has been taken already.
  template <class Make>
  Episode* At(std::uint32_t number, TimeNs start, const Make& make) {
    const Key key{start, number};
    if (taken_.count(key) > 0) {
      ++late_;
      return nullptr;
    }
    auto place = episodes_.find(key);
    if (place == episodes_.end()) place = episodes_.emplace(key, make()).first;
    place->second.heard = ++heard_;
    return &place->second;
  }

  /// Takes the complete episodes, oldest first. Of the others it takes all except the two with the
  /// latest messages, whatever their stamps are, because no more messages are expected for them.
  /// Later messages about a taken episode are ignored.
  template <class Complete>
  std::vector<Episode> TakeDone(const Complete& complete) {
    std::vector<std::uint64_t> heard;
    for (const auto& [key, e] : episodes_) {
      if (!complete(e)) heard.push_back(e.heard);
    }
    std::sort(heard.rbegin(), heard.rend());
    const std::uint64_t open_since = heard.size() > kOpen ? heard[kOpen - 1] : 0;
    std::vector<Episode> done;
    for (auto it = episodes_.begin(); it != episodes_.end();) {
      if (it->second.heard < open_since || complete(it->second)) {
        done.push_back(std::move(it->second));
        Forget(it->first);
        it = episodes_.erase(it);
      } else {
        ++it;
      }
    }
    return done;
  }

  /// Takes all episodes, because the source has ended.
  std::vector<Episode> TakeAll() {
    std::vector<Episode> all;
    for (auto& [key, episode] : episodes_) all.push_back(std::move(episode));
    episodes_.clear();
    return all;
  }

  /// Number of messages about episodes that had been taken already.
  std::uint64_t late() const { return late_; }

 private:
  using Key = std::pair<TimeNs, std::uint32_t>;
  static constexpr std::size_t kOpen = 2;
  static constexpr std::size_t kRemembered = 1000;  ///< number of taken episodes

  void Forget(const Key& key) {
    taken_.insert(key);
    taken_in_order_.push_back(key);
    if (taken_in_order_.size() <= kRemembered) return;
    taken_.erase(taken_in_order_.front());
    taken_in_order_.pop_front();
  }

  std::map<Key, Episode> episodes_;
  std::set<Key> taken_;
  std::deque<Key> taken_in_order_;  // the same keys in order, to forget the oldest ones
  std::uint64_t heard_ = 0, late_ = 0;
};

}  // namespace stg::learn
