#pragma once

/// Names of the acoustic channel's topics.
namespace stg::topics {

// For each AUV, relative to Auv(i), or for each vehicle of a fleet, relative to its name.
inline constexpr char kAcousticTx[] = "acoustic/tx";
inline constexpr char kAcousticRx[] = "acoustic/rx";
inline constexpr char kAcousticStatus[] = "acoustic/status";
inline constexpr char kAcousticPing[] = "acoustic/ping";

inline constexpr char kLinks[] = "/acoustic_channel/links";
inline constexpr char kPackets[] = "/acoustic_channel/packets";
inline constexpr char kPing[] = "/acoustic_channel/ping";

}  // namespace stg::topics
