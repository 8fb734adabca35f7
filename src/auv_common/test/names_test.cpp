#include "auv_common/names.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace stg {
namespace {

TEST(IsText, TakesUtf8OfEveryLength) {
  for (const char* text :
       {"", "medium-1", "\x20~", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf",
        "\xee\x80\x80", "\xef\xbf\xbf", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf", "a\xc3\xa9z"}) {
    EXPECT_TRUE(IsText(text)) << text;
  }
}

TEST(IsText, RefusesControlCharactersAndWhatUnicodeCallsIllFormed) {
  for (const char* text :
       {"\t", "a\n", "\x1b[2J", "\x7f", "\x80", "\xbf", "\xc0\xaf", "\xc1\xbf", "\xc2", "\xc2z",
        "\xe0\x9f\xbf", "\xe1\x80", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80",
        "\xf5\x80\x80\x80", "\xff", "ok\xf0\x90\x80"}) {
    EXPECT_FALSE(IsText(text)) << text;
  }
  EXPECT_FALSE(IsText(std::string(1, '\0')));
}

/// The distance by its definition, without a table and without an early end.
std::size_t SlowDistance(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const std::string c = a.substr(1), d = b.substr(1);
  if (a[0] == b[0]) return SlowDistance(c, d);
  return 1 + std::min({SlowDistance(c, b), SlowDistance(a, d), SlowDistance(c, d)});
}

TEST(EditDistance, IsLevenshteinsUpToWhatIsEnough) {
  EXPECT_EQ(EditDistance("kitten", "sitting", 100), 3U);
  EXPECT_EQ(EditDistance("Saturday", "Sunday", 100), 3U);
  const std::vector<std::string> words = {"",     "a",      "ab",     "ba",    "range",
                                          "rnge", "rangem", "nearer", "anger", "xxxxx"};
  for (const std::string& a : words) {
    for (const std::string& b : words) {
      const std::size_t whole = SlowDistance(a, b);
      for (std::size_t enough = 0; enough < 9; ++enough) {
        EXPECT_EQ(EditDistance(a, b, enough), std::min(whole, enough)) << a << " " << b;
      }
    }
  }
}

}  // namespace
}  // namespace stg
