#pragma once

namespace stg {

/// Headers and libraries fit together within a minor version. The file VERSION has the full
/// version.
inline constexpr char kMinorVersion[] = "1.0";

}  // namespace stg
