#pragma once

#include <nlohmann/json.hpp>

#include "acoustic_channel/channel_config.hpp"
#include "stg_env/task/judge_config.hpp"

namespace stg::env {

/// The fixed parts of a scenario's picture: region, bands, ranges, bottom and obstacles, as in the
/// message `meta` of a recording (docs/recording.md). Lengths [m], world ENU. Without the file of
/// the bathymetry, the bottom is left out.
nlohmann::json SceneOf(const task::JudgeConfig& judge, const acoustics::ChannelConfig& channel);

}  // namespace stg::env
