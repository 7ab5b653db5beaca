#pragma once
// `canopus module compare`: the modules beside each other, from their models.

#include <string>

#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

/// A table in Markdown: a row for each property, a column for each module.
[[nodiscard]] std::string comparison_table();
int module_compare(Output& out);

}  // namespace canopus::cli
