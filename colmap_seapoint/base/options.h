// One binding of a stage's options struct: each field once, with name, unit, legal range, origin.
// Parsing, `-h`, the man page, OPTIONS.md, the range check and run.json are all made from it.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace colmap_seapoint {

using OptionTarget = std::variant<bool*, int*, double*, std::string*>;

struct OptionInfo {
  std::string name;  // "SeaPointExtraction.min_num_features"
  OptionTarget target;
  std::string help;                  // one line, with the unit
  std::string origin;                // "paper 2.3", "ours", "COLMAP"
  double min = 0, max = 0;           // legal range, both inclusive; of int and double only
  std::vector<std::string> choices;  // legal values, of strings only; empty = any
  bool required = false;
  std::string default_value;  // text, taken when the option was added
  bool is_output = false;     // of a path: something is written there
  std::string listing;        // printed for the value "list" or "help", instead of a run; may be ""
};

class OptionTable {
 public:
  void Add(const std::string& name, bool* value, const std::string& help,
           const std::string& origin);
  void Add(const std::string& name, int* value, const std::string& help, const std::string& origin,
           int min, int max);
  void Add(const std::string& name, double* value, const std::string& help,
           const std::string& origin, double min, double max);
  void Add(const std::string& name, std::string* value, const std::string& help,
           const std::string& origin, std::vector<std::string> choices = {});
  // What is named by the option is written. Every other option "..._path" names what is only read.
  void MarkOutput(const std::string& name);
  void SetListing(const std::string& name, const std::string& listing);
  void AddRequired(const std::string& name, std::string* value, const std::string& help);

  const std::vector<OptionInfo>& Options() const { return options_; }
  const OptionInfo* Find(const std::string& name) const;

  // Sets one option from text. Returns "" or the whole sentence: name, value, rule.
  std::string Set(const std::string& name, const std::string& text) const;
  // "" when every value is legal and every required option is set; else the whole sentence.
  std::string Check() const;

 private:
  std::vector<OptionInfo> options_;
};

// The value as text, as it would be typed on the command line.
std::string OptionValueText(const OptionTarget& target);

using OptionList = std::vector<std::pair<std::string, std::string>>;  // name, value as text

OptionList OptionValues(const OptionTable& table);

// Name and value of everything that `options` binds. By value: Bind() wants an object to change.
template <typename Options>
OptionList OptionValues(Options options) {
  OptionTable table;
  options.Bind(&table);
  return OptionValues(table);
}

// Options of a group that are not ours: kept as typed, for another program.
struct ForeignOptions {
  std::string group;  // "Mapper"; empty = none are taken
  std::string help;
  std::map<std::string, std::string>* values = nullptr;  // "Mapper.min_model_size" -> "5"
};

// The options that preset others.
inline constexpr char kQualityOption[] = "quality";
inline constexpr char kCameraPresetOption[] = "camera_preset";

// How many letters must be changed, added or left out: to guess which word a user meant.
size_t EditDistance(const std::string& a, const std::string& b);

}  // namespace colmap_seapoint
