#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "auv_common/error.hpp"

/// Names that people write in files and on command lines.
namespace stg {

/// A letter, then letters, digits, `_` or `-`; 64 characters at most.
bool IsName(const std::string& text);

/// UTF-8 without control characters: what may go into a terminal, a log or a JSON file.
bool IsText(const std::string& text);

/// Levenshtein distance: the fewest insertions, deletions and replacements of one character; or
/// `enough` where it is that or more, which is found out sooner.
std::size_t EditDistance(const std::string& a, const std::string& b, std::size_t enough);

/// The name that was probably meant, or "" when none is near.
std::string NearestName(const std::string& text, const std::vector<std::string>& names);

/// "a | b | c".
std::string JoinNames(const std::vector<std::string>& names);

/// What to throw for a name that is none of `names`; `kind` says what is named, in a word or two.
/// The message lists the names and suggests one where one is near.
UserError UnknownName(const std::string& kind, const std::string& name,
                      const std::vector<std::string>& names);

}  // namespace stg
