// docs/modules/README.md has the table that `canopus module compare` prints.

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/plc/module_command.hpp"
#include "canopus/cli/plc/module_words.hpp"

#include "paths.hpp"

namespace canopus::cli::module_comparison_test {
namespace {

using ::testing::HasSubstr;

TEST(ModuleComparison, IsThePagesTable_WithEveryModule) {
  RecordProperty("spec", "ASF-GEN-005 ASF-GEN-008");
  std::ifstream in(CANOPUS_SOURCE_DIR "/docs/modules/README.md");
  std::ostringstream page;
  page << in.rdbuf();
  EXPECT_THAT(page.str(), HasSubstr("\n\n" + comparison_table() + "\n"));
  for (const plant::CatalogueEntry& entry : plant::module_catalogue()) {
    EXPECT_THAT(comparison_table(), HasSubstr(std::string(entry.data_sheet->model)));
    EXPECT_THAT(page.str(), HasSubstr("| " + std::string(entry.data_sheet->model) + " | ["));
  }
}

// The manuals' own figures, for the rows that are counted.
TEST(ModuleComparison, CountsAreTheManuals) {
  const std::string table = comparison_table();
  for (const char* row :
       {"| PDOs each way | 256 | 256 | 80 | 30 | 256 |",
        "| PDOs each way as slave | 256 | 256 | 80 | 30 | 8 |",
        "| Process data words each way | 1024 | 1024 | 320 | 120 | 947 |",
        "| X/Y signals | yes | yes | - | - | - |", "| Layer 2 (plain CAN) | yes | yes | yes | - | - |",
        "| Flying master (1F90H) | yes | yes | yes | - | - |"})
    EXPECT_THAT(table, HasSubstr(row));
}

}  // namespace
}  // namespace canopus::cli::module_comparison_test
