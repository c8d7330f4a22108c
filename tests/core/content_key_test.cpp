#include "poecal/core/content_key.hpp"

#include <cstdint>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include "core/build_key.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

/// A piece as it enters the hash: its bytes, then how many they were.
std::string piece(const std::string& bytes) {
  const std::uint64_t size = bytes.size();
  return bytes + std::string(reinterpret_cast<const char*>(&size), sizeof size);
}

TEST(ContentKey, IsTheHashOfAllPiecesInOneGo) {
  const std::string all = piece(POECAL_VERSION) + piece(std::string(buildKey())) + piece("one") + piece("") + piece(std::string(1000, 'x'));
  const XXH128_hash_t hash = XXH3_128bits(all.data(), all.size());
  EXPECT_EQ(ContentKey().add("one").add("").add(std::string(1000, 'x')).text(), fmt::format("{:016x}{:016x}", hash.high64, hash.low64));
}

TEST(ContentKey, ABuildHasAKey) {
  EXPECT_EQ(buildKey().size(), 64u);
  EXPECT_EQ(buildKey().find_first_not_of("0123456789abcdef"), std::string_view::npos);
}

TEST(ContentKey, AChecksumIsOfTheBytesAlone) {
  // XXH3's own value for nothing, of its specification.
  EXPECT_EQ(checksum(""), "99aa06d3014798d86001c324468d497f");
  EXPECT_NE(checksum("a"), checksum("b"));
}

TEST(ContentKey, WherePiecesEndCounts) {
  const std::set<std::string> keys{ContentKey().text(),
                                   ContentKey().add("").text(),
                                   ContentKey().add("abc").text(),
                                   ContentKey().add("ab").add("c").text(),
                                   ContentKey().add("a").add("bc").text(),
                                   ContentKey().add("c").add("ab").text()};
  EXPECT_EQ(keys.size(), 6u);
}

TEST(ContentKey, AFileIsItsNameAndItsBytes) {
  const test::TempFolder folder;
  const std::string bytes(200'001, 'b');  // more than is read at a time
  const std::string key = ContentKey().addFile(folder.write("a", bytes)).text();
  EXPECT_EQ(key, ContentKey().add("a").add(bytes).text());
  EXPECT_EQ(key, ContentKey().addFile(folder.write("elsewhere/a", bytes)).text());
  EXPECT_NE(key, ContentKey().addFile(folder.write("b", bytes)).text());
  EXPECT_NE(key, ContentKey().addFile(folder.write("a", bytes.substr(0, 200'000) + "c")).text());
  EXPECT_EQ(ContentKey().addFile(folder.path() / "none").text(), ContentKey().addFile(folder.write("empty/none", "")).text());
}

}  // namespace
}  // namespace poecal
