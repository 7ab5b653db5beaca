// Any bytes at all as an EDS or DCF: read, and when there is a device, looked at from every side.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/eds/device_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus;
  const eds::ReadResult result =
      eds::read_device_file({reinterpret_cast<const char*>(data), size});  // NOLINT
  for (const eds::Problem& problem : result.problems) {
    if (problem.line == 0 || problem.message.empty()) std::abort();
  }
  if (result.file == nullptr) {
    if (result.problems.empty() || result.problems[0].severity != eds::Problem::Severity::error) std::abort();
    return 0;
  }
  canopen::ObjectDictionary dictionary(result.file->dictionary, 127);
  for (const canopen::ObjectDescription& object : dictionary.description().objects()) {
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const auto number = static_cast<std::uint8_t>(sub);
      const auto value = dictionary.read(object.index, number, {});
      if (value && dictionary.write(object.index, number, std::vector(value->begin(), value->end()), {}) ==
                       canopen::AbortCode::no_object) {
        std::abort();
      }
      if (dictionary.description().find(object, number) &&
          result.file->find_facts(object.index, number) == nullptr) {
        std::abort();
      }
    }
  }
  (void)eds::identity(*result.file);
  (void)eds::count_pdos(*result.file->dictionary);
  return 0;
}
