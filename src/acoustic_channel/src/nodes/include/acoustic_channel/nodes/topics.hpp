#pragma once

/// Names of the acoustic channel's topics.
namespace stg::topics {

// Of each AUV, below Auv(i).
inline constexpr char kAcousticTx[] = "acoustic/tx";
inline constexpr char kAcousticRx[] = "acoustic/rx";

inline constexpr char kLinks[] = "/acoustic_channel/links";

}  // namespace stg::topics
