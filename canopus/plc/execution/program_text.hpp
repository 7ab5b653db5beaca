#pragma once
// The text of a program with what has a value in it: variables and devices, line by line. For those who watch a running program; the
// text is that of any language, and what is no name in it is left alone.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/plc/execution/program_execution.hpp"

namespace canopus::plc {

struct NamedValue {
  std::uint32_t column = 0;  ///< from 1
  std::uint32_t length = 0;
  std::string name{};  ///< as Machine::find() takes it, or a device in capital letters
  bool is_device = false;
};

struct SourceLine {
  std::string text{};
  bool has_code = false;  ///< a break may be set here
  std::vector<NamedValue> values{};
};

struct SourceView {
  std::uint32_t lines = 0;            ///< of the whole file
  std::vector<SourceLine> shown{};    ///< from the wanted one on
  std::vector<std::string> blocks{};  ///< instances of the function blocks whose text is shown, at most 64
  std::string block{};                ///< the one whose values are there
};

/// Lines `from` (1: the first one) to `from + count - 1` of a source, by its number. `block`: the instance of a function block whose
/// values are to be shown in the block's text; empty, or none of its instances: the first one.
[[nodiscard]] SourceView source_view(const ProgramExecution& execution, const CpuModel& model,
                                     std::size_t source, std::uint32_t from, std::uint32_t count,
                                     std::string_view block);

}  // namespace canopus::plc
