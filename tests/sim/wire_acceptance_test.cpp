// Which ports accept an identifier: the table against the acceptance of each port.

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/sim/bus/wire/acceptance_table.hpp"

namespace canopus::sim::test::wire_acceptance_test {
namespace {

constexpr std::uint32_t port_count = 70;  // more than a word of them

struct AcceptanceStep {
  std::size_t port;
  can::Acceptance wanted;
};

/// Mostly a few of five identifiers, now and then all, or extended ones.
AcceptanceStep some_acceptance_step(std::uint32_t choice) {
  AcceptanceStep step{.port = choice % port_count, .wanted = {}};
  choice /= port_count;
  step.wanted.extended = choice % 3 == 0;
  if (choice % 7 == 0) return step;  // all
  step.wanted.base.reset();
  for (std::size_t bit = 0; bit < 5; ++bit) step.wanted.base.set(0x181 + 300 * bit, (choice >> bit & 8) != 0);
  return step;
}

RC_GTEST_PROP(WireAcceptance, IsThatOfEachPort, ()) {
  AcceptanceTable table;
  table.resize(port_count);
  std::vector<can::Acceptance> accepted(port_count, {.base = {}, .extended = false});
  const auto choices = *rc::gen::container<std::vector<std::uint32_t>>(rc::gen::arbitrary<std::uint32_t>());
  for (const std::uint32_t choice : choices) {
    const auto [changed, wanted] = some_acceptance_step(choice);
    table.change(changed, accepted[changed], wanted);
    accepted[changed] = wanted;
    for (const can::Frame& frame :
         {can::Frame{.identifier = 0x181}, can::Frame{.identifier = 0x2AD, .remote = true},
          can::Frame{.identifier = 0x3D9}, can::Frame{.identifier = 0x700},
          can::Frame{.identifier = 0x181, .extended = true}}) {
      const auto is_accepted = [&](std::size_t port) {
        return frame.extended ? accepted[port].extended : accepted[port].base[frame.identifier];
      };
      std::vector<std::size_t> accepting;
      for (std::size_t port = 0; port < port_count; ++port) {
        const bool is_in_table = (table.ports_for(frame)[port / 64] >> port % 64 & 1) != 0;
        RC_ASSERT(is_in_table == is_accepted(port));
        if (is_in_table) accepting.push_back(port);
      }
      const AcceptanceTable::Receivers receivers = table.cached_receivers(frame);
      RC_ASSERT(receivers.are_known == (accepting.size() <= 2 && !frame.extended));
      if (!receivers.are_known) continue;
      accepting.resize(2, AcceptanceTable::no_port);
      RC_ASSERT(receivers.first == accepting[0]);
      RC_ASSERT(receivers.second == accepting[1]);
    }
  }
}

}  // namespace
}  // namespace canopus::sim::test::wire_acceptance_test
