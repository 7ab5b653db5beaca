#include "canopus/cli/app/version.hpp"

namespace canopus::cli {

const char* version() noexcept { return CANOPUS_VERSION; }

}  // namespace canopus::cli
