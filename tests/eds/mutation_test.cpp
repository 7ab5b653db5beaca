// Whatever happens to a file, the reader answers with a device or with an error that has a line.

#include <gtest/gtest.h>
// rapidcheck/gtest.h wants GoogleTest before it
#include <rapidcheck/gtest.h>

#include "eds/reading.hpp"
#include "paths.hpp"

namespace canopus::eds::mutation_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;

const std::string& original() {
  static const std::string text =
      with_object(
          "[2000]\nParameterName=C\nObjectType=8\nDataType=6\nAccessType=rw\nDefaultValue=3\nCompactSubObj="
          "12\n"
          "[2000Name]\nNrOfEntries=1\n12=Twelfth\n[2000Value]\nNrOfEntries=1\n12=0x1234\n") +
      read_text(CANOPUS_SOURCE_DIR "/examples/devices/io-block.eds").value_or("");
  return text;
}

rc::Gen<std::string> mutated() {
  return rc::gen::exec([] {
    std::string text = original();
    const int changes = *rc::gen::inRange(1, 40);
    for (int i = 0; i < changes && !text.empty(); ++i) {
      const auto place = *rc::gen::inRange<std::size_t>(0, text.size());
      const auto length = *rc::gen::inRange<std::size_t>(0, 200);
      switch (*rc::gen::inRange(0, 6)) {
        case 0: text[place] = *rc::gen::arbitrary<char>(); break;
        case 1: text.erase(place, length); break;
        case 2:
          text.insert(place, text.substr(*rc::gen::inRange<std::size_t>(0, text.size()), length));
          break;
        case 3: text.insert(place, *rc::gen::arbitrary<std::string>()); break;
        case 4: text.resize(place); break;
        default: {
          constexpr std::string_view words[] = {"\n[1018sub1]\n",
                                                "\nObjectType=9\n",
                                                "\nCompactSubObj=254\n",
                                                "\nDataType=0x11\n",
                                                "0x",
                                                "$NODEID+",
                                                "99999999999999",
                                                "-",
                                                "\n[M1SubExt6000]\n",
                                                "\nCompactPDO=63\nNrOfRXPDO=9\n",
                                                "="};
          text.insert(place, words[*rc::gen::inRange<std::size_t>(0, std::size(words))]);
        }
      }
    }
    return text;
  });
}

RC_GTEST_PROP(Mutation, AnyChangeOfAFile_GivesADeviceOrAnErrorWithALine, ()) {
  const std::string text = *mutated();
  const ReadResult result = read_device_file(text);
  for (const Problem& found : result.problems) {
    RC_ASSERT(found.line >= 1U);
    RC_ASSERT(!found.message.empty());
  }
  if (result.file == nullptr) {
    RC_ASSERT(!result.problems.empty());
    RC_ASSERT(result.problems[0].severity == Problem::Severity::error);
    return;
  }
  RC_ASSERT(result.file->dictionary->find(0x1018, 0));
  for (const Problem& found : result.problems) RC_ASSERT(found.severity != Problem::Severity::error);
}

}  // namespace
}  // namespace canopus::eds::mutation_test
