#pragma once

#include <nlohmann/json.hpp>

#include "acoustic_channel/channel_config.hpp"
#include "stg_env/task/judge_config.hpp"

namespace stg::env {

/// What stands still in a scenario and is drawn: its region, bands, ranges, bottom and obstacles,
/// as the message `meta` of a recording has them (docs/recording.md). Lengths [m], world ENU.
/// Without the bathymetry's file the bottom is left out.
nlohmann::json SceneOf(const task::JudgeConfig& judge, const acoustics::ChannelConfig& channel);

}  // namespace stg::env
