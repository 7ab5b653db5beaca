// Node::values_changed() of some places: the same frames as of all, where nothing else was changed.

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::tpdo_places_test {
namespace {

TEST(ValueMask, ValuesThatShareAByte_ShareAPlace) {
  constexpr std::array<std::uint8_t, 5> lengths{1, 2, 3, 4, 8};
  for (std::uint32_t offset = 0; offset < 70; ++offset) {
    for (const std::uint8_t length : lengths) {
      for (std::uint32_t byte = offset; byte < offset + length; ++byte)
        EXPECT_NE(value_mask_of(offset, length) & value_mask_of(byte, 1), 0) << offset << ' ' << byte;
      EXPECT_EQ(value_mask_of(offset, length) & value_mask_of(offset + 12, length), 0) << offset;
    }
  }
}

constexpr std::array<std::uint32_t, 12> mappable{0x60000108, 0x60000208, 0x60000308, 0x60000808,
                                                 0x64010110, 0x64010210, 0x64010410, 0x65000040,
                                                 0x60200101, 0x60200801, 0x10010008, 0x00050008};

struct TpdoSetting {
  std::vector<std::uint32_t> mapping;
  std::uint8_t type;
  std::uint16_t inhibit_time;  // 100 us
  std::uint16_t event_timer;   // ms
};

/// One of two nodes to which the same happens.
struct Twin : Conversation {
  Twin(NodeOptions options, const std::vector<TpdoSetting>& tpdos) : Conversation(options) {
    for (std::size_t i = 0; i < tpdos.size(); ++i) {
      const auto communication = static_cast<std::uint16_t>(0x1800 + i);
      const auto mapping = static_cast<std::uint16_t>(0x1A00 + i);
      ObjectDictionary& objects = node.dictionary();
      std::uint8_t count = 0;
      for (const std::uint32_t value : tpdos[i].mapping) objects.set(mapping, ++count, value);
      objects.set(mapping, 0, count);
      objects.set(communication, 2, tpdos[i].type);
      objects.set(communication, 3, tpdos[i].inhibit_time);
      objects.set(communication, 5, tpdos[i].event_timer);
      write(communication, 1, (0x40000185 + 0x100 * i), 4);
    }
  }
  /// Where the value lies.
  ValueMask set(std::uint32_t mapped, std::uint64_t value) {
    const auto index = static_cast<std::uint16_t>(mapped >> 16);
    const Entry entry = node.dictionary().description().find(index, static_cast<std::uint8_t>(mapped >> 8));
    node.dictionary().set(entry, value);
    return index < 0x2000 ? ValueMask{0} : value_mask_of(entry.offset, entry.description->length);
  }
};

TEST(ValueMask, WhatTheEndOfAnInhibitTimeCouldNotSend_IsSentAtTheNextLook) {
  Twin node({}, {{.mapping = {0x60000108}, .type = 0xFF, .inhibit_time = 100, .event_timer = 0}});
  node.start();
  const ValueMask place = node.set(0x60000108, 7);
  EXPECT_EQ(node.node.values_changed(place, node.now), 1U);
  node.bus.is_full = true;
  EXPECT_EQ(node.wait(20ms), "");
  node.bus.is_full = false;
  const ValueMask other_place = node.set(0x60000808, 1);
  ASSERT_EQ(place & other_place, 0);
  EXPECT_EQ(node.node.values_changed(other_place, node.now), 1U);
  EXPECT_EQ(node.bus.drain(), "185 07");
  node.set(0x60000108, 8);
  EXPECT_EQ(node.node.values_changed(other_place, node.now), 0U);
}

TEST(ValueMask, ATpdoWithoutValuesThatWasNotSentYet_IsSentAtTheNextLook) {
  Twin node({}, {{.mapping = {0x00050008}, .type = 0xFF, .inhibit_time = 0, .event_timer = 0}});
  node.bus.is_full = true;
  node.start();
  node.bus.is_full = false;
  EXPECT_EQ(node.node.values_changed(node.set(0x60000108, 1), node.now), 1U);
  EXPECT_EQ(node.bus.drain(), "185 00");
}

RC_GTEST_PROP(ValueMask, OfWhatWasChanged_SayTheSameAsAll, ()) {
  const auto anything = [](auto below) {
    return *rc::gen::inRange<std::uint32_t>(0, static_cast<std::uint32_t>(below));
  };
  std::vector<TpdoSetting> tpdos(4);
  for (TpdoSetting& tpdo : tpdos) {
    for (auto count = anything(4); count != 0; --count)
      tpdo.mapping.push_back(mappable[anything(mappable.size())]);
    constexpr std::array<std::uint8_t, 4> types{0, 2, 0xFE, 0xFF};
    tpdo.type = types[anything(types.size())];
    constexpr std::array<std::uint16_t, 3> inhibit_times{0, 35, 200};
    tpdo.inhibit_time = inhibit_times[anything(inhibit_times.size())];
    tpdo.event_timer = static_cast<std::uint16_t>(anything(3) * 7);
  }
  NodeOptions options;
  options.unsent_values_are_changed = anything(2) != 0;
  options.dismiss_events_during_inhibit = anything(2) != 0;
  Twin all(options, tpdos);
  Twin some(options, tpdos);
  all.start();
  some.start();
  ValueMask changed = 0;
  for (int step = 0; step < 120; ++step) {
    std::string said;
    std::string said_by_some;
    switch (anything(8)) {
      case 0:
      case 1: {
        const std::uint32_t mapped = mappable[anything(mappable.size() - 1)];
        const std::uint64_t value = anything(3);
        changed |= all.set(mapped, value);
        some.set(mapped, value);
        break;
      }
      case 2:
      case 3:
      case 4:
        if (changed == 0) break;
        all.node.values_changed(all.now);
        some.node.values_changed(changed, some.now);
        changed = 0;
        break;
      case 5: {
        const auto span = std::chrono::milliseconds(anything(15));
        said = all.wait(span);
        said_by_some = some.wait(span);
        break;
      }
      case 6: all.bus.is_full = some.bus.is_full = anything(3) == 0; break;
      default:
        switch (anything(4)) {
          case 0: {  // as a client of SDO does
            const std::uint64_t value = anything(3);
            all.write(0x6500, 0, value, 8);
            some.write(0x6500, 0, value, 8);
            changed = all_values;
            break;
          }
          case 1: {
            const bool is_start = anything(2) != 0;
            for (Twin* twin : {&all, &some}) {
              twin->node.command(is_start ? NmtCommand::start : NmtCommand::enter_pre_operational, twin->now);
            }
            break;
          }
          case 2: {
            const auto communication = static_cast<std::uint16_t>(0x1800 + anything(tpdos.size()));
            for (Twin* twin : {&all, &some}) {
              const auto cob_id = twin->node.dictionary().get<std::uint32_t>(communication, 1);
              twin->write(communication, 1, cob_id | 0x80000000, 4);
              twin->write(communication, 1, cob_id, 4);
            }
            break;
          }
          default:
            said = all.receive("080");
            said_by_some = some.receive("080");
            break;
        }
    }
    said += all.bus.drain();
    said_by_some += some.bus.drain();
    RC_ASSERT(said_by_some == said);
  }
}

}  // namespace
}  // namespace canopus::canopen::tpdo_places_test
