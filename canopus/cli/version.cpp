#include "canopus/cli/version.hpp"

namespace canopus::cli {

const char* version() noexcept { return CANOPUS_VERSION; }

}  // namespace canopus::cli
