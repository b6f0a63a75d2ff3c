// Options declared once. An options struct has default values and one member function
//   void Visit(OptionVisitor& v);
// that shows every field with its name, help, unit and range. YAML reading and writing, --set, the commented
// default configuration, the schema and the validation are all visitors over that one declaration.
#pragma once

#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

// What is known of one option besides its value. Numbers must lie in [min, max]; strings must be one of
// `choices` where there are any. `unit` is for people: "px", "deg", "voxels", "fraction of the diagonal".
struct OptionInfo {
  std::string_view name;
  std::string_view help;
  std::string_view unit = "";
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::vector<std::string_view> choices = {};
};

class OptionVisitor {
 public:
  virtual ~OptionVisitor() = default;
  virtual void Begin(std::string_view section, std::string_view help) = 0;
  virtual void End() = 0;
  virtual void Field(const OptionInfo& info, double& value) = 0;
  virtual void Field(const OptionInfo& info, int& value) = 0;
  virtual void Field(const OptionInfo& info, bool& value) = 0;
  virtual void Field(const OptionInfo& info, std::string& value) = 0;
  virtual void Field(const OptionInfo& info, std::vector<double>& value) = 0;
};

// Shows a nested options struct as a section.
template <class Options>
void VisitSection(OptionVisitor& v, std::string_view section, std::string_view help, Options& options) {
  v.Begin(section, help);
  options.Visit(v);
  v.End();
}

// Every violation of the declared ranges and choices, one line each: "PATH = VALUE: CONSTRAINT".
template <class Options>
std::vector<std::string> Violations(Options options);

namespace internal {

// Collects violations; see Violations().
class ViolationVisitor : public OptionVisitor {
 public:
  void Begin(std::string_view section, std::string_view help) override;
  void End() override;
  void Field(const OptionInfo& info, double& value) override;
  void Field(const OptionInfo& info, int& value) override;
  void Field(const OptionInfo& info, bool& value) override;
  void Field(const OptionInfo& info, std::string& value) override;
  void Field(const OptionInfo& info, std::vector<double>& value) override;
  std::vector<std::string> Take() { return std::move(violations_); }

 private:
  std::string Path(std::string_view name) const;
  std::vector<std::string> sections_;
  std::vector<std::string> violations_;
};

}  // namespace internal

template <class Options>
std::vector<std::string> Violations(Options options) {
  internal::ViolationVisitor visitor;
  options.Visit(visitor);
  return visitor.Take();
}

}  // namespace glint
