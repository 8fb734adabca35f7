#include "auv_common/names.hpp"

#include <gtest/gtest.h>

#include <string>

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

}  // namespace
}  // namespace stg
