#pragma once

#include <string>

namespace stg::learn {

/// Writes path + ".tmp", syncs it to disk and renames it: whatever happens meanwhile, a crash or a
/// full disk, leaves the old file or the new one. UserError "path: cannot write WHAT: reason".
void WriteDurably(const std::string& bytes, const std::string& path, const std::string& what);

}  // namespace stg::learn
