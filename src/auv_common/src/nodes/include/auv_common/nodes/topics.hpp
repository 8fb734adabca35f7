#pragma once

#include <string>

/// Topic names that several packages share. Each package has a header for its own topics.
namespace stg::topics {

/// Namespace of one AUV.
inline std::string Auv(int i) { return "/auv_" + std::to_string(i); }
inline std::string AuvTopic(int i, const char* name) { return Auv(i) + "/" + name; }

inline constexpr char kSwarmState[] = "/swarm_state";
inline constexpr char kChannelDone[] = "/acoustic_channel/done";

}  // namespace stg::topics

namespace stg::frames {

inline constexpr char kWorld[] = "world";
inline std::string Body(int i) { return "auv_" + std::to_string(i) + "/base_link"; }

}  // namespace stg::frames
