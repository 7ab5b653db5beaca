#pragma once
// Which word shows which object of a lift [FX3U-CAN 8.1].

#include <array>

#include "canopus/module/lift/lift.hpp"
#include "canopus/module/models/fx3u_can/buffer_table.hpp"

namespace canopus::module::fx3u_can {

namespace lift_words {
// clang-format off
inline constexpr std::array receive = std::to_array<LiftWords>({
    // first  object  sub   elements  words from element to element, from lift to lift
    {12050, 0x6301, 0x01, 4, 1, 4},  // door status word
    {12082, 0x6302, 0x01, 4, 1, 4},  // door position
    {12114, 0x6310, 0x01, 4, 1, 4},  // light barrier status
    {12300, 0x6383, 0x01, 4, 2, 8},  // position value
    {12364, 0x6390, 0x01, 4, 1, 4},  // speed value car
    {12396, 0x6391, 0x01, 4, 1, 4},  // acceleration value car
    {12428, 0x6401, 0x00, 1, 1, 1},  // status word
    {12436, 0x6404, 0x00, 1, 1, 1},  // modes of operation display
    {12444, 0x6406, 0x00, 1, 2, 2},  // control effort
    {12460, 0x6407, 0x00, 1, 2, 2},  // position actual value
    {12492, 0x6433, 0x00, 1, 2, 2},  // velocity actual value
    {12508, 0x6480, 0x01, 2, 1, 2},  // absolute load, SI unit
    {12524, 0x6482, 0x01, 2, 1, 2},  // load signal, its interrupt
});
inline constexpr std::array transmit = std::to_array<LiftWords>({
    // first  object  sub                 always 1, always 0
    {13050, 0x6300, 0x01, 4, 1, 4, 0x0003, 0x0000},  // door control word
    {13428, 0x6400, 0x00, 1, 1, 1, 0x0000, 0x0400},  // control word
    {13436, 0x6403, 0x00, 1, 1, 1, 0x0000, 0xFF00},  // modes of operation
    {13460, 0x6420, 0x00, 1, 2, 2, 0x0000, 0x0000},  // target position
    {13476, 0x6423, 0x00, 1, 2, 2, 0x0000, 0x0000},  // profile velocity
    {13492, 0x6430, 0x00, 1, 2, 2, 0x0000, 0x0000},  // target velocity
});
// clang-format on
}  // namespace lift_words

/// Virtual inputs come from panels with node-ID 1 to 64, by the RPDOs 1481H to 14C0H [FX3U-CAN 5.6].
inline constexpr LiftLayout lift_layout{.modes = mode_417,
                                        .older_first = 3000,
                                        .received = {12000, 540},
                                        .transmitted = {13000, 508},
                                        .receive = lift_words::receive,
                                        .transmit = lift_words::transmit,
                                        .first_input_pdo = 0x81,
                                        .last_input_pdo = 0xC0};

}  // namespace canopus::module::fx3u_can
