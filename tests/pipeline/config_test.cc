#include "pipeline/config.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "pipeline/config_file.h"
#include "pipeline/config_schema.h"
#include "pipeline/option_table.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

struct Fruit {
  double size_rel = 0.25;
  int seeds = 5;
  bool ripe = true;
  std::string kind = "apple";
  std::vector<double> weights = {1, 0.1};
  void Visit(OptionVisitor& v) {
    v.Field({.name = "size_rel", .help = "Size.", .unit = "fraction of the diagonal", .min = 0, .max = 1}, size_rel);
    v.Field({.name = "seeds", .help = "Seeds.", .min = 0}, seeds);
    v.Field({.name = "ripe", .help = "Ripe."}, ripe);
    v.Field({.name = "kind", .help = "Kind.", .choices = {"apple", "pear"}}, kind);
    v.Field({.name = "weights", .help = "Weights."}, weights);
  }
};

struct Basket {
  Fruit first, second;
  std::string label = "say \"hi\"";
  void Visit(OptionVisitor& v) {
    VisitSection(v, "first", "The first fruit.", first);
    VisitSection(v, "second", "The second fruit.", second);
    v.Field({.name = "label", .help = "Label."}, label);
  }
};

class ConfigFile : public ::testing::Test {
 protected:
  fs::path Write(const std::string& text) {
    std::ofstream(file_, std::ios::binary) << text;
    return file_;
  }
  std::vector<std::string> Read(const std::string& text) {
    ConfigProblems problems;
    ReadYamlFile(Write(text), table_, problems);
    return problems.messages;
  }
  void TearDown() override { fs::remove(file_); }

  fs::path file_ = fs::path(::testing::TempDir()) / "glint_config_test.yaml";
  Basket basket_;
  OptionTable table_{basket_};
};

TEST_F(ConfigFile, SetsWhatTheFileNamesAndNothingElse) {
  EXPECT_THAT(Read("second:\n  size_rel: 1e-3\n  ripe: false\n  kind: pear\n  weights: [3, 4.5]\nlabel: plain\n"),
              IsEmpty());
  EXPECT_EQ(basket_.second.size_rel, 1e-3);
  EXPECT_FALSE(basket_.second.ripe);
  EXPECT_EQ(basket_.second.kind, "pear");
  EXPECT_THAT(basket_.second.weights, ElementsAre(3, 4.5));
  EXPECT_EQ(basket_.label, "plain");
  EXPECT_EQ(basket_.first.size_rel, 0.25);
  EXPECT_EQ(basket_.second.seeds, 5);
}

TEST_F(ConfigFile, UnknownKeyNamesFileLineAndNearestKey) {
  EXPECT_THAT(Read("first:\n  seeds: 1\n  sice_rel: 2\n"),
              ElementsAre(AllOf(HasSubstr("glint_config_test.yaml:3: first.sice_rel"), HasSubstr("first.size_rel"))));
  EXPECT_THAT(Read("third: {seeds: 1}\n"), ElementsAre(HasSubstr("test.yaml:1: third: unknown option")));
  // The right name in no section.
  EXPECT_THAT(Read("ripe: true\n"), ElementsAre(HasSubstr("the nearest is first.ripe")));
}

TEST_F(ConfigFile, EveryProblemIsListed) {
  EXPECT_THAT(
      Read("first:\n  seeds: 1.5\n  ripe: maybe\n  size_rel: .nan\n  weights: [1, x]\n  kind: [a]\nsecond: 3\n"),
      ElementsAre(HasSubstr(":2: first.seeds: expected a whole number, found \"1.5\""),
                  HasSubstr(":3: first.ripe: expected true or false"),
                  HasSubstr(":4: first.size_rel: expected a number"),
                  HasSubstr(":5: first.weights: expected a list of numbers"),
                  HasSubstr(":6: first.kind: expected one of apple, pear, found a list"),
                  HasSubstr(":7: second: expected a section")));
  EXPECT_EQ(basket_.first.seeds, 5);
  EXPECT_THAT(Read("label: a\nlabel: b\n"), ElementsAre(HasSubstr(":2: label: given twice")));
}

TEST_F(ConfigFile, WhatIsNotYamlIsRefusedWithItsLine) {
  ConfigProblems problems;
  try {
    ReadYamlFile(Write("first:\n  seeds: [1\n"), table_, problems);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("glint_config_test.yaml:"), HasSubstr("not valid YAML")));
  }
  EXPECT_THROW(ReadYamlFile(Write("- a\n- b\n"), table_, problems), InputError);
  EXPECT_THROW(ReadYamlFile(Write(std::string("\0\x01\xff\xfe", 4)), table_, problems), InputError);
  EXPECT_THROW(ReadYamlFile("/nowhere/at/all.yaml", table_, problems), InputError);
  EXPECT_THROW(ReadYamlFile(::testing::TempDir(), table_, problems), InputError);
  ReadYamlFile(Write(""), table_, problems);
  EXPECT_THAT(problems.messages, IsEmpty());
}

TEST_F(ConfigFile, WrittenValuesReadBackExactly) {
  basket_.first.size_rel = 1.0 / 3;
  basket_.second.weights = {1e-300, 2, -0.1};
  basket_.label = "back\\slash \"and\" quote: #";
  const std::string text = WriteYaml(table_, "Title.");
  Basket other;
  ConfigProblems problems;
  ReadYamlFile(Write(text), OptionTable(other), problems);
  EXPECT_THAT(problems.messages, IsEmpty()) << text;
  EXPECT_EQ(other.first.size_rel, basket_.first.size_rel);
  EXPECT_EQ(other.second.weights, basket_.second.weights);
  EXPECT_EQ(other.label, basket_.label);
  EXPECT_THAT(text, HasSubstr("  # Size. (0 to 1, fraction of the diagonal)\n  size_rel: 0.333"));
}

TEST_F(ConfigFile, Settings) {
  ConfigProblems problems;
  ApplySetting("second.seeds=7", table_, problems);
  ApplySetting("second.weights=1, 2,3", table_, problems);
  EXPECT_THAT(problems.messages, IsEmpty());
  EXPECT_EQ(basket_.second.seeds, 7);
  EXPECT_THAT(basket_.second.weights, ElementsAre(1, 2, 3));
  ApplySetting("second.seed=7", table_, problems);
  ApplySetting("second=7", table_, problems);
  ApplySetting("second.seeds=many", table_, problems);
  ApplySetting("seeds", table_, problems);
  EXPECT_THAT(problems.messages,
              ElementsAre(HasSubstr("second.seed: unknown option; the nearest is second.seeds"),
                          HasSubstr("is a section"), HasSubstr("found \"many\""), HasSubstr("expected key=value")));
  EXPECT_THROW(problems.ThrowIfAny(), InputError);
}

TEST(Config, DefaultsAreValidAndEveryOptionIsExplained) {
  Config config;
  EXPECT_THAT(Violations(config), IsEmpty());
  const OptionTable table(config);
  for (const OptionItem& item : table.items()) {
    if (item.kind == OptionItem::Kind::kEndSection) continue;
    EXPECT_FALSE(item.help.empty()) << item.path;
    EXPECT_EQ(item.path.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_."), std::string::npos) << item.path;
  }
}

TEST(Config, DefaultFileInTheRepositoryIsUpToDate) {
  std::stringstream text;
  text << std::ifstream(GLINT_SOURCE_DIR "/configs/default.yaml", std::ios::binary).rdbuf();
  EXPECT_TRUE(text.str() == DefaultConfigYaml()) << "write it anew: glint config > configs/default.yaml";
}

TEST(Config, DefaultFileReadsBackToTheDefaults) {
  const Config config = ResolveConfig(GLINT_SOURCE_DIR "/configs/default.yaml", {});
  EXPECT_TRUE(ConfigYaml(config, "") == ConfigYaml(Config(), ""));
}

TEST(Config, RangeViolationsNameWhereTheValueCameFrom) {
  try {
    ResolveConfig("", {"output.memory_fraction=7", "output.overlay_max_side_px=3", "output.overlays=true"});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("--set: output.memory_fraction = 7: must lie in [0.01, 1]"),
                                HasSubstr("--set: output.overlay_max_side_px = 3"), Not(HasSubstr("overlays"))));
  }
}

// Where a dotted path is in the schema; null: nowhere.
const nlohmann::json* InSchema(const nlohmann::json& schema, const std::string& path) {
  const nlohmann::json* place = &schema;
  std::istringstream parts(path);
  for (std::string part; std::getline(parts, part, '.');) {
    const auto found = (*place)["properties"].find(part);
    if (found == (*place)["properties"].end()) return nullptr;
    place = &*found;
  }
  return place;
}

TEST(Schema, HasEveryOptionWithItsDeclaration) {
  Config config;
  const OptionTable table(config);
  const nlohmann::json schema = nlohmann::json::parse(JsonSchema(table));
  EXPECT_EQ(schema["additionalProperties"], false);
  for (const OptionItem& item : table.items()) {
    if (item.kind == OptionItem::Kind::kEndSection) continue;
    const nlohmann::json* place = InSchema(schema, item.path);
    ASSERT_NE(place, nullptr) << item.path;
    EXPECT_THAT((*place)["description"].get<std::string>(), HasSubstr(item.help));
    EXPECT_EQ(place->contains("default"), item.kind == OptionItem::Kind::kField) << item.path;
  }
  const nlohmann::json& levels = *InSchema(schema, "refine.levels");
  EXPECT_EQ(levels["type"], "integer");
  EXPECT_EQ(levels["minimum"], 1);
  EXPECT_EQ(levels["maximum"], 8);
  EXPECT_EQ(levels["default"], 3);
  EXPECT_THAT((*InSchema(schema, "lights.kinds"))["enum"], ElementsAre("any", "distant", "point"));
  EXPECT_EQ((*InSchema(schema, "seed.object.box"))["items"]["type"], "number");
}

TEST(Schema, TheFileThatEditorsReadIsUpToDate) {
  Config config;
  std::ifstream in(fs::path(GLINT_SOURCE_DIR) / "configs/schema.json");
  const std::string text(std::istreambuf_iterator<char>(in), {});
  EXPECT_TRUE(text == JsonSchema(OptionTable(config))) << "glint config --schema > configs/schema.json";
}

TEST(Configs, EveryOneIsValidCommentedAndSetsOnlyWhatItsUseNeeds) {
  size_t count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(GLINT_SOURCE_DIR) / "configs")) {
    if (entry.path().extension() != ".yaml" || entry.path().filename() == "default.yaml") continue;
    ++count;
    SCOPED_TRACE(entry.path().filename().string());
    std::ifstream in(entry.path());
    const std::string text(std::istreambuf_iterator<char>(in), {});
    EXPECT_TRUE(text.starts_with("# yaml-language-server: $schema=schema.json\n# "));
    EXPECT_THAT(text, HasSubstr("--config configs/" + entry.path().filename().string()));
    Config config;
    ASSERT_NO_THROW(config = ResolveConfig(entry.path(), {}));
    Config defaults, read;
    const OptionTable table(read), default_table(defaults);
    ConfigProblems problems;
    ReadYamlFile(entry.path(), table, problems);
    EXPECT_THAT(problems.messages, IsEmpty());
    EXPECT_FALSE(problems.origin.empty());
    for (const auto& [path, where] : problems.origin)
      EXPECT_NE(FormatValue(*table.FindField(path)), FormatValue(*default_table.FindField(path)))
          << path << " is the default anyway";
  }
  EXPECT_EQ(count, 8u);
}

}  // namespace
}  // namespace glint
