#pragma once

#include <optional>
#include <string>
#include <utility>

namespace stg::nodes {

/// The wait for a node that is to hear a run from its first message on, such as a recorder.
///
/// A node subscribes to one topic after the other and connects to their publishers in the
/// background, on a busy machine for seconds; how many topics it will want, it alone knows. So it
/// is asked how many publishers it is connected to (getBusInfo of
/// https://wiki.ros.org/ROS/Slave_API), and is taken to have them all once that number, above zero,
/// has stood still for kSettled_s. A node that does not answer may be busy connecting: the wait
/// starts again.
///
/// Only to be asked while nothing depends on the asking thread: the master and the node are waited
/// for, the node kPatience_s at most. Not thread-safe.
class ConnectionWatch {
 public:
  static constexpr double kSettled_s = 1.5, kPatience_s = 0.2;

  /// @param node its full name, e.g. "/recorder"
  explicit ConnectionWatch(std::string node) : node_(std::move(node)) {}

  /// True once the node has all its connections; asks it anew, but not more often than every 0.1 s.
  /// @param now_s WallSeconds()
  bool Settled(double now_s);

  const std::string& node() const { return node_; }
  /// Publishers that it was connected to when it last answered; 0: it has not yet.
  int connections() const { return connections_; }

 private:
  std::optional<int> Ask() const;

  std::string node_;
  int connections_ = 0;
  double asked_s_ = -1.0, changed_s_ = 0.0;
};

}  // namespace stg::nodes
