// A flat table over an options struct: every field by its dotted path, with its declaration and a pointer to its value.
// Reading and writing YAML, --set and the nearest valid key for a misspelt one all go through it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/options.h"

namespace glint {

// One line of the declaration, in its order.
struct OptionItem {
  enum class Kind { kBeginSection, kField, kEndSection };
  using Value = std::variant<double*, int*, bool*, std::string*, std::vector<double>*>;

  Kind kind = Kind::kField;
  std::string path;  // "refine.level_set.voxel_rel"; of a section: its own path
  std::string name;  // last part of the path
  std::string help;
  std::string unit;
  double min = 0;
  double max = 0;
  std::vector<std::string> choices;
  Value value;  // fields only
};

// Holds pointers into the options it was made from, which must outlive it and stay where they are.
class OptionTable {
 public:
  template <class Options>
  explicit OptionTable(Options& options) {
    Builder builder(*this);
    options.Visit(builder);
  }

  const std::vector<OptionItem>& items() const { return items_; }
  const OptionItem* FindField(std::string_view path) const;    // nullptr: no such field
  const OptionItem* FindSection(std::string_view path) const;  // nullptr: no such section
  // The field or section whose path is most like `path` (least edits); empty for an empty table.
  std::string Nearest(std::string_view path) const;

 private:
  class Builder : public OptionVisitor {
   public:
    explicit Builder(OptionTable& table) : table_(table) {}
    void Begin(std::string_view section, std::string_view help) override;
    void End() override;
    void Field(const OptionInfo& info, double& value) override { Add(info, &value); }
    void Field(const OptionInfo& info, int& value) override { Add(info, &value); }
    void Field(const OptionInfo& info, bool& value) override { Add(info, &value); }
    void Field(const OptionInfo& info, std::string& value) override { Add(info, &value); }
    void Field(const OptionInfo& info, std::vector<double>& value) override { Add(info, &value); }

   private:
    void Add(const OptionInfo& info, OptionItem::Value value);
    OptionTable& table_;
    std::vector<std::string> sections_;
  };

  const OptionItem* Find(std::string_view path, OptionItem::Kind kind) const;
  std::vector<OptionItem> items_;
};

// What a field's value looks like, for messages: "a number", "true or false", "one of a, b", ...
std::string ExpectedValue(const OptionItem& item);

// The value as YAML writes it; numbers in the shortest form that reads back exactly.
std::string FormatValue(const OptionItem& item);

// Sets a scalar field from text. False (and no change) when the text is not such a value. Ranges are not checked here.
bool ParseValue(const OptionItem& item, std::string_view text);

// The declared constraint in words, empty when there is none: "0.001 to 0.5, fraction of the diagonal".
std::string DescribeConstraint(const OptionItem& item);

}  // namespace glint
