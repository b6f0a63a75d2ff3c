// What the fuzzers feed the readers, without a fuzzer: sound files, their mutants, and the files that once broke one.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace glint::fuzz {
namespace {

namespace fs = std::filesystem;

class Reader : public ::testing::TestWithParam<Target> {};

// `bytes` changed at a few places: a byte set or a piece doubled, left out, or replaced by a number at a limit.
std::string Mutant(std::string bytes, std::mt19937& random) {
  const auto below = [&](size_t n) {
    return std::uniform_int_distribution<size_t>(0, std::max<size_t>(n, 1) - 1)(random);
  };
  static const std::vector<std::string> pieces = {
      "-1",      "1e999", "nan", "4294967295", "18446744073709551615", "[",
      "{\"a\":", "\n",    " ",   "../",        std::string(4, '\xFF'), std::string(1, '\0')};
  for (size_t changes = 1 + below(3); changes > 0 && !bytes.empty(); --changes) {
    const size_t at = below(bytes.size());
    const size_t length = std::min(1 + below(8), bytes.size() - at);
    const size_t kind = below(5);
    if (kind == 0) bytes[at] = static_cast<char>(below(256));
    if (kind == 1) bytes.erase(at, length);
    if (kind == 2) bytes.insert(at, std::string(bytes, at, length));
    if (kind == 3) bytes.replace(at, length, pieces[below(pieces.size())]);
    if (kind == 4) bytes.resize(at);
  }
  return bytes;
}

TEST_P(Reader, SurvivesMutantsOfSoundFiles) {
  const Target& target = GetParam();
  std::mt19937 random(1);
  const std::vector<std::string> seeds = target.seeds();
  ASSERT_FALSE(seeds.empty());
  target.run("");
  for (const std::string& seed : seeds) {
    ASSERT_NO_THROW(target.run(seed));
    for (int i = 0; i < 300; ++i) {
      const std::string mutant = Mutant(seed, random);
      ASSERT_NO_THROW(target.run(mutant)) << "mutant " << i << " of " << mutant.size() << " bytes";
    }
  }
}

// Parsers that call themselves for what is nested run out of stack.
TEST_P(Reader, SurvivesDeepNesting) {
  const auto repeated = [](std::string_view piece) {
    std::string text;
    for (int i = 0; i < 100000; ++i) text += piece;
    return text;
  };
  for (const std::string_view open : {"[", "{", "{\"a\":", "{\"lights\": [", "- ", "? ", "a:\n ", "[[1],"}) {
    ASSERT_NO_THROW(GetParam().run(repeated(open)));
    ASSERT_NO_THROW(GetParam().run(std::string("{\"lights\": ").append(repeated(open))));
  }
  const std::string nested = std::string(100000, '[') + std::string(100000, ']');
  ASSERT_NO_THROW(GetParam().run(std::string("{\"lights\": [").append(nested).append("]}")));
  ASSERT_NO_THROW(GetParam().run(std::string("{\"highlights\": [").append(nested).append("]}")));
  ASSERT_NO_THROW(GetParam().run(std::string("part: {list: ").append(nested).append("}")));
}

TEST_P(Reader, SurvivesLongWordsAndLines) {
  const std::string word(1 << 20, 'a'), digits(1 << 20, '7');
  for (const std::string& text : {word, digits}) {
    ASSERT_NO_THROW(GetParam().run(text));
    ASSERT_NO_THROW(GetParam().run(std::string(text).append(": 1\n")));
    ASSERT_NO_THROW(GetParam().run(std::string("OFF\n").append(text)));
    ASSERT_NO_THROW(GetParam().run(std::string("v 1 2 3\nf ").append(text)));
    ASSERT_NO_THROW(GetParam().run(std::string("ply\nformat ascii 1.0\nelement vertex ").append(text)));
  }
}

// tests/fuzz/crashes/READER/: what the fuzzers found, one file a fault.
TEST_P(Reader, SurvivesWhatOnceBrokeIt) {
  const fs::path folder = fs::path(GLINT_SOURCE_DIR) / "tests/fuzz/crashes" / GetParam().name;
  if (!fs::is_directory(folder)) return;
  for (const auto& entry : fs::directory_iterator(folder))
    EXPECT_NO_THROW(GetParam().run(BytesOf(entry.path()))) << entry.path();
}

INSTANTIATE_TEST_SUITE_P(Files, Reader, ::testing::ValuesIn(Targets()),
                         [](const auto& reader) { return std::string(reader.param.name); });

TEST(Crashes, AllBelongToAReader) {
  const fs::path folder = fs::path(GLINT_SOURCE_DIR) / "tests/fuzz/crashes";
  if (!fs::is_directory(folder)) GTEST_SKIP() << "no file has broken a reader";
  for (const auto& entry : fs::directory_iterator(folder))
    EXPECT_NE(FindTarget(entry.path().filename().string()), nullptr) << entry.path();
}

}  // namespace
}  // namespace glint::fuzz
