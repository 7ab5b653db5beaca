#include "canopus/client/node_id.hpp"

#include "canopus/ascii/number.hpp"

namespace canopus::client {

unsigned parse_node(std::string_view text) noexcept {
  const unsigned node = ascii::parse_number_with_prefix<unsigned>(text).value_or(0);
  return node <= 127 ? node : 0;
}

}  // namespace canopus::client
