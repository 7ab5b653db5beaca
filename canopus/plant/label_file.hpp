#pragma once
// Global labels of GX Works2 and GX Works3 ("Export to CSV File"), as Structured Text: variables at their devices.

#include <string>
#include <string_view>
#include <vector>

#include "canopus/instruction_list/compiler.hpp"
#include "canopus/plc/execution/device_label.hpp"
#include "canopus/structured_text/compiler.hpp"

namespace canopus::plant {

/// Of a label that is a variable of the program.
struct LabelComment {
  std::string name{};  ///< "start", a local one "MAIN.start"
  std::string comment{};
};

struct LabelFile {
  std::string text{};  ///< VAR_GLOBAL ... END_VAR for each label, in the line that it has in the file
  std::vector<plc::DeviceLabel> labels{};  ///< those that have a device; local ones as "MAIN.start"
  std::vector<instruction_list::Label> list_labels{};  ///< those that instruction lists need besides the text
  std::vector<LabelComment> comments{};
  std::vector<structured_text::CompileError> errors{};
};

/// Tabs, commas or semicolons; UTF-8, or UTF-16 with a byte order mark; titles of the columns in English, German or Japanese. A label
/// without a device is a variable. Labels of the class VAR are local ones of the instruction list that is called as the file.
[[nodiscard]] LabelFile read_labels(const std::string& file, std::string_view bytes);

}  // namespace canopus::plant
