#pragma once

#include <cstdint>
#include <fstream>
#include <limits>
#include <string>

namespace stg {

/// Throws UserError unless path names a regular file (or a link to one) of at most `largest` bytes:
/// what is no file is not opened, because a pipe would wait for ever and a device never ends.
void RequireRegularFile(const std::string& path,
                        std::uintmax_t largest = std::numeric_limits<std::uintmax_t>::max());

/// Such a file as text, to be read from its first character: the byte-order mark that some editors
/// begin UTF-8 with is skipped. (The parsers of YAML and JSON skip it by themselves.) Throws
/// UserError, also when the file cannot be opened.
std::ifstream OpenText(const std::string& path,
                       std::uintmax_t largest = std::numeric_limits<std::uintmax_t>::max());

}  // namespace stg
