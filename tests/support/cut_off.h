#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace sightline::test {

// Bytes that end anywhere before their end, and those that something follows, must be refused, with an error
// that says what to do. read(bytes) returns a Result.
template <typename Read>
void expectCutOffIsRefused(std::span<const std::byte> bytes, const std::string& advice, Read&& read) {
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 7) {
    const auto result = read(bytes.first(size));
    ASSERT_FALSE(result) << size;
    EXPECT_NE(result.error().message.find(advice), std::string::npos) << result.error().message;
  }
  std::vector<std::byte> longer(bytes.begin(), bytes.end());
  longer.resize(bytes.size() + 16);
  EXPECT_FALSE(read(std::span<const std::byte>(longer)));
}

}  // namespace sightline::test
