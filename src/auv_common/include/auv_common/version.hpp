#pragma once

namespace stg {

/// Headers and libraries belong together within a minor version; the file VERSION has all of it.
inline constexpr char kMinorVersion[] = "1.0";

}  // namespace stg
