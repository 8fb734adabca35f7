#include "auv_dynamics/playback/recorded_motion.hpp"
#include "target.hpp"

/// A table of recorded vehicle motions. It is only read, because a simulated day takes too long.
bool stg::fuzz::RunMotions(const std::string& bytes) {
  return LoadAsFile(bytes, [](const std::string& path) {
    for (const dynamics::RecordedMotion& motion : dynamics::LoadMotions(path)) {
      Require(!motion.rows.empty(), "a motion without rows");
      double before = -1.0;
      for (const dynamics::MotionRow& row : motion.rows) {
        Require(row.time_s > before, "times that do not increase");
        before = row.time_s;
      }
    }
  });
}
