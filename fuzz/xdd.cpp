// Any bytes behind "<" as an XDD or XDC: read, and when there is a device, written in both formats, read again, and
// changed in place: unchanged it is the same bytes, and what was set is read again.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "canopus/eds/files/device_text.hpp"
#include "canopus/eds/files/losses.hpp"
#include "canopus/eds/files/xdd_writer.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus;
  const std::string text = '<' + std::string(reinterpret_cast<const char*>(data), size);  // NOLINT
  const eds::ReadResult result = eds::read_device_file(text);
  for (const eds::Problem& problem : result.problems) {
    if (problem.line == 0 || problem.message.empty()) std::abort();
  }
  eds::DeviceText changed(text);
  if (changed.text() != text || !changed.is_xml()) std::abort();
  (void)eds::beyond_device_file(text);
  if (result.file == nullptr) {
    if (result.problems.empty() || result.problems[0].severity != eds::Problem::Severity::error) std::abort();
    if (changed.set_parameter_value(0x1000, 0, "1") || changed.text() != text) std::abort();
    return 0;
  }
  for (const std::string& written : {eds::write_xdd(*result.file).text, eds::write_eds(*result.file).text}) {
    const eds::ReadResult again = eds::read_device_file(written);
    if (again.file == nullptr ||
        again.file->dictionary->objects().size() != result.file->dictionary->objects().size()) {
      std::abort();
    }
  }
  const canopen::ObjectDescription& last = result.file->dictionary->objects().back();
  const canopen::Entry entry = result.file->dictionary->find(last, last.highest_sub);
  if (entry && entry.description->length != 0 &&
      changed.set_parameter_value(last.index, last.highest_sub, "0")) {
    const eds::ReadResult again = eds::read_device_file(changed.text());
    if (again.file == nullptr) std::abort();
    if (again.file->dictionary->default_value(again.file->dictionary->find(last.index, last.highest_sub),
                                              1) != 0) {
      std::abort();
    }
  }
  eds::Commissioning node;
  node.node_id = 7;
  node.node_name = "a\"b";
  eds::DeviceText configured(text);
  if (configured.configure({}, node)) {
    const eds::ReadResult again = eds::read_device_file(configured.text());
    if (again.file == nullptr || !again.file->commissioning || again.file->commissioning->node_id != 7)
      std::abort();
  } else if (configured.text() != text) {
    std::abort();
  }
  return 0;
}
