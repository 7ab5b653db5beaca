#include "canopus/text/version.hpp"

namespace canopus::text {

const char* program_version() noexcept { return CANOPUS_VERSION; }

}  // namespace canopus::text
