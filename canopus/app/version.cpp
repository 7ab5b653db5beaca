#include "canopus/app/version.hpp"

namespace canopus::app {

const char* version() noexcept { return CANOPUS_VERSION; }

}  // namespace canopus::app
