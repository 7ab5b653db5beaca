#pragma once

#include "canopus/trace/filter/message_filter.hpp"

namespace canopus::cli {

class Command;

/// --filter, --node, --service, --object, --can-id; --channel, --from and --to where `of_file`.
void add_filter_options(Command& command, trace::FilterOptions& options, bool of_file);

}  // namespace canopus::cli
