#pragma once
// The network of fuzz/master.cpp: the object dictionary of its master, and three slaves that mostly answer,
// take configurations and programs, also in blocks.

#include <array>
#include <cstdint>
#include <deque>
#include <memory>

#include "canopus/canopen/dictionary/object_dictionary.hpp"

#include "input.hpp"

namespace canopus::fuzz {

using canopen::Access;
using canopen::DataType;
using canopen::ObjectCode;

inline constexpr std::uint8_t own_id = 1;
inline constexpr std::uint8_t slave_ids[] = {2, 3, 127};
inline constexpr std::uint32_t new_version = 9;  // of the program; the slaves begin with version 4

inline std::shared_ptr<const canopen::DictionaryDescription> master_objects() {
  static const auto built = [] {
    canopen::DictionaryBuilder b;
    const auto u32 = [] { return canopen::EntrySpec{}; };
    const auto u8 = [] { return canopen::EntrySpec{.type = DataType::unsigned8}; };
    b.variable(0x1000, {.access = Access::read_only});
    b.variable(0x1001, {.type = DataType::unsigned8, .access = Access::read_only});
    b.variable(0x1014, {.value = canopen::little_endian(0x81, 4)});
    b.uniform(0x1016, ObjectCode::array, "Consumers", 127, u32());
    b.variable(0x1017, {.type = DataType::unsigned16});
    b.uniform(0x1018, ObjectCode::record, "Identity", 4, {.access = Access::read_only});
    b.uniform(0x1029, ObjectCode::array, "Error behaviour", 1, u8());
    b.variable(0x102A, {.type = DataType::unsigned16});
    b.uniform(0x1F22, ObjectCode::array, "Concise DCF", 127, {.type = DataType::domain});
    b.uniform(0x1F25, ObjectCode::array, "Configuration request", 128, {.access = Access::write_only});
    b.uniform(0x1F26, ObjectCode::array, "Configuration date", 127, u32());
    b.uniform(0x1F27, ObjectCode::array, "Configuration time", 127, u32());
    b.uniform(0x1F55, ObjectCode::array, "Software version", 127, u32());
    b.uniform(0x1F58, ObjectCode::array, "Program", 127, {.type = DataType::domain});
    b.variable(0x1F80, u32());
    b.uniform(0x1F81, ObjectCode::array, "Slave assignment", 127, u32());
    b.uniform(0x1F82, ObjectCode::array, "Request NMT", 128, u8());
    b.uniform(0x1F83, ObjectCode::array, "Request guarding", 128, u8());
    for (std::uint16_t index = 0x1F84; index <= 0x1F88; ++index) {
      b.uniform(index, ObjectCode::array, "Expected identity", 127, u32());
    }
    b.variable(0x1F89, u32());
    b.uniform(0x1F8A, ObjectCode::array, "Restore", 127, u8());
    b.object(0x1F90, ObjectCode::record, "Flying master timing");
    constexpr std::uint16_t timing[] = {100, 500, 1, 1500, 10, 4010};
    for (std::uint8_t sub = 1; sub <= 6; ++sub) {
      b.sub(0x1F90, sub, {.type = DataType::unsigned16, .value = canopen::little_endian(timing[sub - 1], 2)});
    }
    return b.build();
  }();
  return built;
}

struct Slaves {
  /// What the master's side sent; the answers wait in `answers`.
  void receive(const can::Frame& frame) {
    if (frame.extended || answers.size() > 64) return;
    if (frame.identifier == 0x000) {
      for (const std::uint8_t id : slave_ids) {
        if (frame.data[1] != 0 && frame.data[1] != id) continue;
        if (frame.data[0] >= 0x81) answers.push_back(can::data_frame(0x700U + id, {0x00}));
        state[id] = frame.data[0] == 1 ? 5 : frame.data[0] == 2 ? 4 : 0x7F;
        if (frame.data[0] >= 0x81) toggle[id] = 0;
      }
      return;
    }
    const auto id = static_cast<std::uint8_t>(frame.identifier & 0x7F);
    if (frame.identifier > 0x700 && frame.remote) {
      answers.push_back(
          can::data_frame(frame.identifier, {static_cast<std::uint8_t>(state[id] | toggle[id])}));
      toggle[id] ^= 0x80;
      return;
    }
    if (frame.identifier < 0x601 || frame.identifier > 0x67F) return;
    can::Frame response = frame;
    response.identifier -= 0x80;
    if (block_sequence[id] != 0) {  // segments of a block download, 1 is due first
      if (frame.data[0] == 0x80) {
        block_sequence[id] = 0;
        return;
      }
      if ((frame.data[0] & 0x7F) != block_sequence[id]) return;
      const bool last = (frame.data[0] & 0x80) != 0;
      if (!last && block_sequence[id]++ != 127) return;
      response.data = {0xA2, static_cast<std::uint8_t>(frame.data[0] & 0x7F), 127};
      block_sequence[id] = last ? 0 : 1;
      answers.push_back(response);
      return;
    }
    const auto index = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
    switch (frame.data[0] >> 5) {
      case 0: response.data = {static_cast<std::uint8_t>(0x20 | (frame.data[0] & 0x10))}; break;
      case 6:  // no CRC
        if (!knows_blocks) {
          response.data = {0x80, frame.data[1], frame.data[2], frame.data[3], 0x01, 0x00, 0x04, 0x05};
        } else if ((frame.data[0] & 1) != 0) {
          response.data = {0xA1};
          version[id] = new_version;
        } else {
          response.data = {0xA0, frame.data[1], frame.data[2], frame.data[3], 127};
          block_sequence[id] = 1;
        }
        break;
      case 1:
        if (index == 0x1F51) program_state[id] = frame.data[4] == 3 ? 2 : frame.data[4];
        if (index == 0x1F50) version[id] = new_version;
        response.data[0] = 0x60;
        for (unsigned i = 4; i < 8; ++i) response.data[i] = 0;
        break;
      case 2:
        response.data[0] = 0x43;
        response.data[4] = index == 0x1000   ? 0x91
                           : index == 0x1020 ? static_cast<std::uint8_t>(4 + frame.data[3])
                           : index == 0x1F51 ? program_state[id]
                           : index == 0x1F56 ? static_cast<std::uint8_t>(version[id])
                           : index == 0x1F57 ? flash_status
                                             : 2;
        response.data[5] = index == 0x1000 ? 0x01 : 0;
        response.data[6] = index == 0x1018 ? 1 : 0;
        break;
      default: return;
    }
    answers.push_back(response);
  }

  std::deque<can::Frame> answers;
  std::array<std::uint8_t, 128> state{};
  std::array<std::uint8_t, 128> toggle{};
  std::array<std::uint8_t, 128> block_sequence{};
  std::array<std::uint8_t, 128> program_state{};
  std::array<std::uint32_t, 128> version{};
  std::uint8_t flash_status = 0;
  bool knows_blocks = true;
};

}  // namespace canopus::fuzz
