#include "packet_files.hpp"

#include <ros/console.h>

#include <filesystem>
#include <utility>

#include "auv_common/error.hpp"
#include "auv_common/regular_file.hpp"

namespace stg::nodes {

PacketFiles::PacketFiles(std::string path, const std::vector<int>& ids, const std::string& bag)
    : path_(std::move(path)) {
  for (const int id : ids) names_.push_back(std::to_string(id));
  if (path_.empty()) return;
  std::error_code ignored;  // the path may not exist yet
  if (!bag.empty() && std::filesystem::equivalent(path_, bag, ignored)) {
    throw UserError("parameter packet_log: " + path_ +
                    " is the bag of the parameter bag; name another file");
  }
  Open(1);
}

std::string PacketFiles::Path(int run) const {
  if (run == 1) return path_;
  const std::size_t slash = path_.find_last_of('/');
  const std::size_t dot = path_.find_last_of('.');
  const bool has_ending = dot != std::string::npos && (slash == std::string::npos || dot > slash);
  const std::size_t end = has_ending ? dot : path_.size();
  return path_.substr(0, end) + "." + std::to_string(run) + path_.substr(end);
}

void PacketFiles::Open(int run) {
  // Opening a pipe without a reader would wait forever.
  if (std::filesystem::exists(Path(run))) {
    try {
      RequireRegularFile(Path(run));
    } catch (const UserError& error) {
      throw UserError(std::string("parameter packet_log: ") + error.what());
    }
  }
  file_ = std::ofstream(Path(run));
  if (!file_) throw UserError("parameter packet_log: cannot write " + Path(run));
}

acoustics::PacketObserver* PacketFiles::Begin(TimeNs start) {
  if (path_.empty()) return nullptr;
  Flush();
  log_.reset();
  if (++runs_ > 1) Open(runs_);
  log_ = std::make_unique<acoustics::PacketLog>(&file_, static_cast<int>(names_.size()), names_,
                                                start);
  return log_.get();
}

void PacketFiles::Flush() {
  if (!log_) return;
  file_.flush();
  if (file_) return;
  ROS_ERROR_THROTTLE(10.0, "%s: cannot be written", Path(runs_).c_str());
  if (lost_.empty()) lost_ = Path(runs_);
}

}  // namespace stg::nodes
