#pragma once

#include <cstddef>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"
#include "acoustic_channel/water/sound_speed.hpp"
#include "auv_dynamics/measurements.hpp"
#include "stg_agent/agent_config.hpp"
#include "stg_agent/localization/localizer.hpp"
#include "stg_agent/localization/own_way.hpp"

namespace stg::agent {

/// Keeps answers to an AUV's own pings of targets until the next decision, when they become
/// detections. A ping happens between two decisions, and the AUV's position at that time is known
/// at the second one.
class PingAnswers {
 public:
  explicit PingAnswers(const AgentModel& model);

  void Clear();
  /// Takes an answer; an implausible one is dropped.
  void Keep(const acoustics::Reception& reception);
  /// Takes the position at a decision, and calls detect(const Detection&) for each answer, oldest
  /// first.
  template <class Detect>
  void Give(TimeNs now, const OwnReckoning& own, double heading_std_rad, Detect&& detect) {
    if (!pings_) return;
    way_.Add(now, own);
    dynamics::Detection detection;
    for (const Answer& answer : answers_) {
      if (Read(answer, own, heading_std_rad, &detection)) detect(detection);
    }
    answers_.clear();
  }

 private:
  struct Answer {
    int target = 0;
    TimeNs at = 0;
    double travel_time_s = 0.0;
  };
  bool Read(const Answer& answer, const OwnReckoning& own, double heading_std_rad,
            dynamics::Detection* detection) const;

  bool pings_;
  int first_target_, targets_;
  double reach_m_;
  dynamics::RelativeOptions options_;
  acoustics::SoundSpeedProfile sound_;
  double surface_z_m_;
  OwnWay way_;
  std::vector<Answer> answers_;
};

}  // namespace stg::agent
