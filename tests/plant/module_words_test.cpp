// Words of a module's buffer memory by the names of its manual.

#include "canopus/cli/plc/module_words.hpp"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::cli::module_words_test {
namespace {

using ::testing::HasSubstr;

std::string error_of(std::string_view name, std::string_view model = {}) {
  const auto found = find_word(name, model);
  return found ? "G" + std::to_string(*found) : found.error();
}

TEST(ModuleWords, AreFoundByTheManualsNames) {
  EXPECT_EQ(find_word("communication_status", "ME3CAN1-Q"), 25U);
  EXPECT_EQ(find_word("Communication status", "me3can1-q"), 25U);
  EXPECT_EQ(find_word("time_stamp_day_of_week", "ME3CAN1-Q"), 57U);
  EXPECT_EQ(find_word("nmt_state", "ME3CAN1-Q"), 601U);
  EXPECT_EQ(find_word("nmt_state[0]", "ME3CAN1-Q"), 601U);
  EXPECT_EQ(find_word("nmt_state[126]", "ME3CAN1-Q"), 727U);
}

TEST(ModuleWords, EveryNameOfEveryModule_IsFound_AndIsOneWord) {
  for (const plant::CatalogueEntry& entry : plant::module_catalogue()) {
    std::set<std::string> names;
    for (const NamedWords& words : named_words(entry)) {
      EXPECT_TRUE(names.insert(words.name).second) << words.name;
      EXPECT_EQ(words.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string::npos)
          << words.name;
      EXPECT_EQ(find_word(words.name, entry.data_sheet->model), words.first);
      EXPECT_EQ(
          find_word(words.name + "[" + std::to_string(words.count() - 1) + "]", entry.data_sheet->model),
          words.last);
    }
    EXPECT_FALSE(names.empty() && !entry.buffer_rows.empty());
  }
}

TEST(ModuleWords, WhatIsNone_IsSaidWithTheNearestName) {
  EXPECT_THAT(error_of("comunication_status"), HasSubstr("did you mean communication_status?"));
  EXPECT_THAT(error_of("nothing_of_the_kind"), HasSubstr("canopus plc names lists them"));
  EXPECT_THAT(error_of("nmt_state[127]", "ME3CAN1-Q"),
              HasSubstr("nmt_state has 127 words; expected [0] to [126]"));
  EXPECT_THAT(error_of("nmt_state", "FX9"), HasSubstr("'FX9' is no module; expected one of"));
  for (const char* wrong : {"nmt_state[", "nmt_state[]", "nmt_state[x]", "nmt_state[-1]", "nmt_state[1",
                            "nmt_state[99999999999]"}) {
    EXPECT_THAT(error_of(wrong), HasSubstr("is no name of words")) << wrong;
  }
  EXPECT_THAT(error_of(""), HasSubstr("no module has words named ''"));
  EXPECT_THAT(error_of("[0]"), HasSubstr("no module has words"));
}

}  // namespace
}  // namespace canopus::cli::module_words_test
