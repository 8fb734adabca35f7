#pragma once

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/log/packet_log.hpp"

namespace stg::nodes {

/// The packet log of a node: a CSV file for each run, `packets.csv`, `packets.2.csv` and so on,
/// with vehicles by id and times of the clock.
class PacketFiles {
 public:
  /// @param path of the first file; empty: none. Throws UserError when it cannot be written, is
  ///        there and no file, or is the same file as `bag`, which is read.
  PacketFiles(std::string path, const std::vector<int>& ids, const std::string& bag);

  /// A run begins, whose times count from `start` [ns]. Its log, null without a file, is valid
  /// until the next.
  acoustics::PacketObserver* Begin(TimeNs start);
  /// What was written is in the file, or is lost.
  void Flush();
  /// The first file that does not hold all of its rows; empty: all do.
  const std::string& lost() const { return lost_; }

 private:
  void Open(int run);
  std::string Path(int run) const;

  std::string path_, lost_;
  std::vector<std::string> names_;
  int runs_ = 0;
  std::ofstream file_;
  std::unique_ptr<acoustics::PacketLog> log_;
};

}  // namespace stg::nodes
