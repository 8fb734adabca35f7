#pragma once

#include <optional>
#include <string>
#include <utility>

namespace stg::nodes {

/// Waits for a node that must receive a run from its first message on, such as a recorder.
///
/// A node subscribes to one topic after the other and connects to the publishers in the background.
/// On a busy machine this takes seconds, and only the node knows how many topics it needs. So this
/// class asks it for its number of connected publishers (getBusInfo of
/// https://wiki.ros.org/ROS/Slave_API). The node is taken to have all connections once this number
/// is above zero and has not changed for kSettled_s. A node that does not answer may be busy
/// connecting; the wait then starts again.
///
/// Use it only while nothing else depends on the calling thread, because each question waits for
/// the master, and for the node up to kPatience_s. Not thread-safe.
class ConnectionWatch {
 public:
  static constexpr double kSettled_s = 1.5, kPatience_s = 0.2;

  /// @param node full name, e.g. "/recorder"
  explicit ConnectionWatch(std::string node) : node_(std::move(node)) {}

  /// True once the node has all its connections. Asks the node again, at most every 0.1 s.
  /// @param now_s WallSeconds()
  bool Settled(double now_s);

  const std::string& node() const { return node_; }
  /// Number of connected publishers in the last answer; 0: no answer yet.
  int connections() const { return connections_; }

 private:
  std::optional<int> Ask() const;

  std::string node_;
  int connections_ = 0;
  double asked_s_ = -1.0, changed_s_ = 0.0;
};

}  // namespace stg::nodes
