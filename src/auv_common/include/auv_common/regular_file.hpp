#pragma once

#include <cstdint>
#include <fstream>
#include <limits>
#include <string>

namespace stg {

/// Throws UserError unless the path is a regular file, or a link to one, of at most `largest`
/// bytes. It does not open anything else, because a pipe would wait forever and a device never
/// ends.
void RequireRegularFile(const std::string& path,
                        std::uintmax_t largest = std::numeric_limits<std::uintmax_t>::max());

/// Opens a regular file as text and skips the byte-order mark that some editors write at the start
/// of UTF-8. (The parsers of YAML and JSON skip it by themselves.) Throws UserError as
/// RequireRegularFile does, and if the file cannot be opened.
std::ifstream OpenText(const std::string& path,
                       std::uintmax_t largest = std::numeric_limits<std::uintmax_t>::max());

}  // namespace stg
