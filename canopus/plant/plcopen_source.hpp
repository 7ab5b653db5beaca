#pragma once
// A program in PLCopen XML (TC6, version 2.01) as Structured Text: POUs whose body is ST, their interfaces, data types and global
// variables.

#include <string>
#include <string_view>
#include <vector>

#include "canopus/structured_text/compiler.hpp"

namespace canopus::plant {

struct PlcopenSource {
  /// Every line stands where it stands in the file, so that a line of a compile error is one of the file.
  std::string text{};
  /// What is no Structured Text, or is missing, with its place.
  std::vector<structured_text::CompileError> errors{};
};

/// `file`: its name, for errors. Bytes of anybody: bounded as eds::xml::Document says.
[[nodiscard]] PlcopenSource structured_text_of_plcopen(const std::string& file, std::string_view bytes);

}  // namespace canopus::plant
