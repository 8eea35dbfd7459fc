#include "src/base/utf8.h"

#include <gtest/gtest.h>

namespace sightline::base {
namespace {

TEST(Utf8, EveryCodePointComesBack) {
  for (char32_t code = 0; code <= 0x10ffff; ++code) {
    std::string text;
    appendUtf8(text, code);
    const Utf8Character character = firstCharacter(text);
    if (code >= 0xd800 && code < 0xe000) {
      ASSERT_EQ(character.length, 0u) << "a surrogate: " << static_cast<std::uint32_t>(code);
      continue;
    }
    ASSERT_EQ(character.code, code);
    ASSERT_EQ(character.length, text.size());
    ASSERT_EQ(text.size(), code < 0x80 ? 1u : code < 0x800 ? 2u : code < 0x10000 ? 3u : 4u);
  }
}

// Unicode 15, table 3-7 and what lies just beside it.
TEST(Utf8, WhatIsNotWellFormedHasNoLength) {
  for (const char* text :
       {"\x80", "\xbf", "\xc0\x80", "\xc1\xbf", "\xc2", "\xc2\x41", "\xe0\x9f\xbf", "\xe2\x82",
        "\xed\xa0\x80", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff"}) {
    EXPECT_EQ(firstCharacter(text).length, 0u) << text;
  }
}

TEST(Utf8, BytesThatAreNoCharacterAreReplacedOneByOne) {
  EXPECT_EQ(decodeUtf8("a\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80"), U"a\u00e4\u20ac\U0001f600");
  EXPECT_EQ(decodeUtf8("x\xe2\x82y"), U"x\ufffd\ufffdy");
  EXPECT_EQ(decodeUtf8("\xff"), U"\ufffd");
  EXPECT_EQ(decodeUtf8(""), U"");
}

}  // namespace
}  // namespace sightline::base
