#include "colmap_seapoint/base/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <type_traits>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

// Whole numbers without an exponent, others as the shortest text that reads back the same.
template <typename Number>
std::string NumberText(Number value) {
  if constexpr (std::is_same_v<Number, double>) {
    if (std::fabs(value) < 1e15 && value == std::floor(value)) {
      return NumberText(static_cast<long long>(value));
    }
  }
  char buffer[64];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  return std::string(buffer, result.ptr);
}

// False when `text` is not wholly a number of this type.
template <typename Number>
bool ParseNumber(const std::string& text, Number* value) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') ++begin;
  const auto result = std::from_chars(begin, end, *value);
  return begin != end && result.ec == std::errc() && result.ptr == end;
}

std::string Sentence(const OptionInfo& option, const std::string& text, const std::string& rule) {
  return "--" + option.name + " " + (text.empty() ? "''" : text) + ": " + rule;
}

template <typename Number>
std::string RangeRule(const OptionInfo& option) {
  return "must lie between " + NumberText(static_cast<Number>(option.min)) + " and " +
         NumberText(static_cast<Number>(option.max));
}

template <typename Number>
std::string CheckRange(const OptionInfo& option, Number value) {
  const double v = static_cast<double>(value);
  if (v >= option.min && v <= option.max) return "";  // false for NaN
  return Sentence(option, NumberText(value), RangeRule<Number>(option));
}

std::string CheckChoice(const OptionInfo& option, const std::string& value) {
  const auto& choices = option.choices;
  if (choices.empty() || std::find(choices.begin(), choices.end(), value) != choices.end()) {
    return "";
  }
  std::string rule = "must be one of";
  for (const std::string& choice : choices) rule += " " + choice;
  return Sentence(option, value, rule);
}

template <typename Number>
std::string SetNumber(const OptionInfo& option, const std::string& text, Number* target) {
  Number value{};
  // A switch of COLMAP's, which writes true and false into its project files, with a third value.
  const bool is_switch = option.min == -1 && option.max == 1;
  if (is_switch && (text == "true" || text == "false")) {
    *target = text == "true" ? 1 : 0;
    return "";
  }
  if (!ParseNumber(text, &value)) {
    const std::string kind = std::is_integral_v<Number> ? "a whole number" : "a number";
    return Sentence(option, text,
                    "must be " + kind + ", and " + RangeRule<Number>(option).substr(5));
  }
  const std::string problem = CheckRange(option, value);
  if (problem.empty()) *target = value;
  return problem;
}

std::string SetBool(const OptionInfo& option, const std::string& text, bool* target) {
  // COLMAP writes true and false into its project files.
  const bool is_true = text == "1" || text == "true";
  if (!is_true && text != "0" && text != "false") return Sentence(option, text, "must be 0 or 1");
  *target = is_true;
  return "";
}

std::string SetString(const OptionInfo& option, const std::string& text, std::string* target) {
  const std::string problem = CheckChoice(option, text);
  if (problem.empty()) *target = text;
  return problem;
}

std::string CheckOption(const OptionInfo& option) {
  if (const auto* number = std::get_if<int*>(&option.target)) return CheckRange(option, **number);
  if (const auto* number = std::get_if<double*>(&option.target)) {
    return CheckRange(option, **number);
  }
  const auto* text = std::get_if<std::string*>(&option.target);
  if (text == nullptr) return "";
  if (option.required && (*text)->empty()) return "--" + option.name + " is required";
  return CheckChoice(option, **text);
}

void Append(std::vector<OptionInfo>* options, OptionInfo option) {
  for (const OptionInfo& other : *options) SEAPOINT_CHECK(other.name != option.name);
  option.default_value = OptionValueText(option.target);
  options->push_back(std::move(option));
}

}  // namespace

void OptionTable::Add(const std::string& name, bool* value, const std::string& help,
                      const std::string& origin) {
  Append(&options_, {name, value, help, origin, 0, 1, {}, false, "", false, ""});
}

void OptionTable::Add(const std::string& name, int* value, const std::string& help,
                      const std::string& origin, int min, int max) {
  const double lowest = static_cast<double>(min), highest = static_cast<double>(max);
  Append(&options_, {name, value, help, origin, lowest, highest, {}, false, "", false, ""});
}

void OptionTable::Add(const std::string& name, double* value, const std::string& help,
                      const std::string& origin, double min, double max) {
  Append(&options_, {name, value, help, origin, min, max, {}, false, "", false, ""});
}

void OptionTable::Add(const std::string& name, std::string* value, const std::string& help,
                      const std::string& origin, std::vector<std::string> choices) {
  Append(&options_, {name, value, help, origin, 0, 0, std::move(choices), false, "", false, ""});
}

void OptionTable::MarkOutput(const std::string& name) {
  for (OptionInfo& option : options_) option.is_output |= option.name == name;
}

void OptionTable::SetListing(const std::string& name, const std::string& listing) {
  for (OptionInfo& option : options_) {
    if (option.name == name) option.listing = listing;
  }
}

void OptionTable::AddRequired(const std::string& name, std::string* value,
                              const std::string& help) {
  Append(&options_, {name, value, help, "COLMAP", 0, 0, {}, true, "", false, ""});
}

const OptionInfo* OptionTable::Find(const std::string& name) const {
  for (const OptionInfo& option : options_) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

std::string OptionTable::Set(const std::string& name, const std::string& text) const {
  const OptionInfo* option = Find(name);
  if (option == nullptr) return "--" + name + ": there is no such option";
  return std::visit(
      [&](auto* target) -> std::string {
        using Value = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_same_v<Value, bool>) return SetBool(*option, text, target);
        if constexpr (std::is_same_v<Value, std::string>) return SetString(*option, text, target);
        if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>) {
          return SetNumber(*option, text, target);
        }
      },
      option->target);
}

std::string OptionTable::Check() const {
  for (const OptionInfo& option : options_) {
    const std::string problem = CheckOption(option);
    if (!problem.empty()) return problem;
  }
  return "";
}

std::string OptionValueText(const OptionTarget& target) {
  return std::visit(
      [](const auto* value) -> std::string {
        using Value = std::remove_const_t<std::remove_pointer_t<decltype(value)>>;
        if constexpr (std::is_same_v<Value, bool>) return *value ? "1" : "0";
        if constexpr (std::is_same_v<Value, std::string>) return *value;
        if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>) {
          return NumberText(*value);
        }
      },
      target);
}

OptionList OptionValues(const OptionTable& table) {
  OptionList values;
  for (const OptionInfo& option : table.Options()) {
    values.emplace_back(option.name, OptionValueText(option.target));
  }
  return values;
}

size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

}  // namespace colmap_seapoint
