#pragma once

#include "auv_common/config/field.hpp"

namespace stg::task {

/// Lengths by which the critic's state is divided: those of the workspace and those of the band.
struct CriticConfig {
  double far_scale_m = 1.0;
  double near_scale_m = 0.05;
  double target_speed_gain = 20.0;  ///< the largest speed of an AUV over that of a target
};

/// Keys, units and ranges of the section `critic`, which a file may leave out.
void Describe(CriticConfig* c, config::Table* t);

}  // namespace stg::task
