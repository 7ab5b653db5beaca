#pragma once
// What the tests of the EDS reader share: small files, and questions to what was read.

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/eds/device_file.hpp"

namespace canopus::eds::test {

/// The least a file needs for not being complained of; base_lines lines.
inline const std::string base =
    "[FileInfo]\nFileName=a.eds\n"
    "[DeviceInfo]\nVendorNumber=1\nBaudRate_250=1\n"
    "[MandatoryObjects]\nSupportedObjects=3\n1=0x1000\n2=0x1001\n3=0x1018\n"
    "[1000]\nParameterName=Device type\nDataType=7\nAccessType=ro\nDefaultValue=0x191\n"
    "[1001]\nParameterName=Error register\nDataType=5\nAccessType=ro\n"
    "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber=2\n"
    "[1018sub0]\nParameterName=Highest\nDataType=5\nAccessType=ro\nDefaultValue=1\n"
    "[1018sub1]\nParameterName=Vendor\nDataType=7\nAccessType=ro\nDefaultValue=1\n";
inline constexpr unsigned base_lines = 33;

/// base, a list of one manufacturer object 2000H (lines 34 to 36), and that object's sections from line 37
/// on.
inline std::string with_object(std::string_view sections) {
  return base + "[ManufacturerObjects]\nSupportedObjects=1\n1=0x2000\n" + std::string(sections);
}
inline constexpr unsigned object_line = 37;

/// 2000H as a VAR with these further lines, from line 40 on.
inline std::string with_variable(std::string_view lines) {
  return with_object("[2000]\nParameterName=Value\nAccessType=rw\n" + std::string(lines));
}

/// The problem in this line, as "warning: message"; empty when there is none. Several are joined.
inline std::string problem(const ReadResult& result, unsigned line) {
  std::string text;
  for (const Problem& found : result.problems) {
    if (found.line != line) continue;
    if (!text.empty()) text += " | ";
    text += std::string(name(found.severity)) + ": " + found.message;
  }
  return text;
}

/// All problems, for failure messages and for "there is none".
inline std::string all_problems(const ReadResult& result) {
  std::ostringstream text;
  for (const Problem& found : result.problems) {
    text << found.line << ": " << name(found.severity) << ": " << found.message << '\n';
  }
  return text.str();
}

/// The default of a sub-index for node-ID 5, as the bus would read it.
inline std::vector<std::uint8_t> value(const ReadResult& result, std::uint16_t index, std::uint8_t sub = 0) {
  canopen::ObjectDictionary dictionary(result.file->dictionary, 5);
  const canopen::Entry entry = result.file->dictionary->find(index, sub);
  if (!entry) return {0xDE, 0xAD, 0xDE, 0xAD, 0xDE, 0xAD};
  const auto bytes = dictionary.bytes(entry);
  return {bytes.begin(), bytes.end()};
}

inline std::optional<std::string> read_text(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

}  // namespace canopus::eds::test
