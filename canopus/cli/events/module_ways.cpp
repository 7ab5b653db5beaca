#include "canopus/cli/events/module_ways.hpp"

#include <algorithm>
#include <array>

namespace canopus::cli {
namespace {

constexpr ModuleWay by_signal(unsigned number, std::string_view how) {
  return {.kind = ModuleWay::Kind::signal, .signal = number, .how = how};
}
constexpr ModuleWay by_word(std::uint32_t word, std::uint16_t value, std::string_view how) {
  return {.kind = ModuleWay::Kind::word, .word = word, .value = value, .how = how};
}

// [ME3CAN1-Q 3.3.2, 3.5.7; RJ71CN91 App. 1; FX3U-CAN 6.8, 6.17, 14.2; FX2N-32CAN 4.2.4, 4.2.7; AS-FCOPM 10.5.1]
constexpr std::array all_ways = {
    ModuleWays{.model = "ME3CAN1-Q",
               .clear = by_signal(0x0F, "Y0F ON until X0F is OFF"),
               .restart = by_signal(0x02, "Y02 ON until X02 is ON"),
               .error_word = 29,
               .error_word_name = "G29"},
    ModuleWays{.model = "RJ71CN91",
               .clear = by_signal(0x0F, "YF ON until XF is OFF"),
               .restart = by_signal(0x02, "Y2 ON until X2 is ON"),
               .error_word = 29,
               .error_word_name = "G29"},
    ModuleWays{.model = "FX3U-CAN",
               .clear = by_word(29, 0, "0 into BFM #29"),
               .restart = by_word(25, 1, "bit 0 into BFM #25"),
               .error_word = 29,
               .error_word_name = "BFM #29"},
    ModuleWays{.model = "FX2N-32CAN",
               .clear = by_word(29, 0, "0 into BFM #29"),
               .restart = by_word(25, 1, "bit 0 into BFM #25"),
               .error_word = 29,
               .error_word_name = "BFM #29"},
    ModuleWays{.model = "AS-FCOPM",
               .clear = {.how = "its codes go by themselves when their cause is gone"},
               .restart = {.how = "it starts with the PLC's supply alone"}},
};

constexpr ModuleWays no_ways{.clear = {.how = "nothing is known of it"},
                             .restart = {.how = "nothing is known of it"}};

}  // namespace

const ModuleWays& module_ways(std::string_view model) noexcept {
  const auto found = std::ranges::find(all_ways, model, &ModuleWays::model);
  return found == all_ways.end() ? no_ways : *found;
}

}  // namespace canopus::cli
