#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "auv_common/error.hpp"

/// Names that people write in files and on command lines.
namespace stg {

/// A letter, then letters, digits, `_` or `-`; 64 characters at most.
bool IsName(const std::string& text);

/// UTF-8 without control characters: safe in a terminal, a log or a JSON file.
bool IsText(const std::string& text);

/// Levenshtein distance: the smallest number of insertions, deletions and replacements of one
/// character. Returns `enough` if the distance is at least that; this saves time.
std::size_t EditDistance(const std::string& a, const std::string& b, std::size_t enough);

/// The name that was probably meant, or "" when none is near.
std::string NearestName(const std::string& text, const std::vector<std::string>& names);

/// "a | b | c".
std::string JoinNames(const std::vector<std::string>& names);

/// The names that are not in the second list.
std::vector<std::string> Without(std::vector<std::string> names,
                                 const std::vector<std::string>& others);

/// The error to throw for a name that is not in `names`. `kind` says in one or two words what the
/// name is for. The message lists the names and suggests the nearest one.
UserError UnknownName(const std::string& kind, const std::string& name,
                      const std::vector<std::string>& names);

}  // namespace stg
