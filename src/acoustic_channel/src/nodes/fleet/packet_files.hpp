#pragma once

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/log/packet_log.hpp"

namespace stg::nodes {

/// The packet log of a node: one CSV file per run, `packets.csv`, `packets.2.csv` and so on. It has
/// ids of vehicles and times of the clock.
class PacketFiles {
 public:
  /// @param path of the first file; empty: no log. Throws UserError if it cannot be written, if the
  /// path is not a regular file, or if it is the same file as `bag`, which is read.
  PacketFiles(std::string path, const std::vector<int>& ids, const std::string& bag);

  /// Begins a run. `start` is the time from which its times count [ns]. Returns its log, valid
  /// until the next run; null without a file.
  acoustics::PacketObserver* Begin(TimeNs start);
  /// Writes all rows to the file. A failure is stored in lost().
  void Flush();
  /// The first file with missing rows; empty: all rows were written.
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
