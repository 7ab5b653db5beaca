// Simulated devices as LSS slaves [CiA 305], alone and on the simulated bus, where every bit counts.

#include "sim/lss_on_bus.hpp"

namespace canopus::sim::device_lss_test {
namespace {

TEST_F(LssOnBus, WithoutNodeId_TheDeviceIsSilentAndDeaf_UntilItHasOne_ThenItBootsUp) {
  Seat& seat = add(address);
  run_for(1s);
  EXPECT_TRUE(station.heard.empty());
  EXPECT_EQ(seat.device->node().state(), canopen::NmtState::initialising);
  station.send_at(timeline.now(), can::data_frame(0x000, {0x81, 0x00}));
  station.send_at(timeline.now(), can::data_frame(0x000, {0x01, 0x00}));
  station.send_at(timeline.now(), can::data_frame(0x67F, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}));
  run_for(1s);
  EXPECT_TRUE(station.heard.empty());

  EXPECT_EQ(select(address), LssResult::done);
  EXPECT_EQ(seat.device->lss()->state(), LssSlave::State::configuration);
  EXPECT_EQ(set_node_id(5), LssResult::done);
  run_for(1s);
  EXPECT_EQ(heard(0x705), 0U);  // only pending
  switch_all(false);
  run_for(5ms);
  EXPECT_EQ(heard(0x705), 1U);
  EXPECT_EQ(seat.device->node().state(), canopen::NmtState::pre_operational);
  forget();
  station.send_at(timeline.now(), can::data_frame(0x605, {0x40, 0x18, 0x10, 0x04, 0, 0, 0, 0}));
  run_for(5ms);
  EXPECT_THAT(station.frames(),
              ElementsAre(can::data_frame(0x585, {0x43, 0x18, 0x10, 0x04, 0x78, 0x56, 0x34, 0x12})));
  EXPECT_EQ(fastscan(), LssResult::silence);
}

TEST_F(LssOnBus, NodeIdOfAConfiguredDevice_ChangesWithItsNextReset_AndCanBeTakenAway) {
  Seat& seat = add(address, 9);
  run_for(5ms);
  select(address);
  EXPECT_EQ(set_node_id(5), LssResult::done);
  switch_all(false);
  run_for(5ms);
  EXPECT_EQ(seat.device->node().node_id(), 9);
  forget();
  station.send_at(timeline.now(), can::data_frame(0x000, {0x82, 0x09}));
  run_for(5ms);
  EXPECT_EQ(heard(0x705), 1U);
  EXPECT_EQ(seat.device->node().node_id(), 5);

  select(address);
  EXPECT_EQ(set_node_id(unconfigured), LssResult::done);
  switch_all(false);
  forget();
  station.send_at(timeline.now(), can::data_frame(0x000, {0x82, 0x00}));
  run_for(100ms);
  EXPECT_TRUE(station.heard.empty());
  EXPECT_EQ(seat.device->node().state(), canopen::NmtState::initialising);
  EXPECT_EQ(fastscan(), LssResult::done);
}

TEST_F(LssOnBus, WhatIsStored_ComesBackAfterAPowerCut_TheRestIsLost) {
  Seat& seat = add(address);
  select(address);
  set_node_id(5);
  switch_all(false);
  run_for(5ms);
  EXPECT_EQ(seat.device->node().node_id(), 5);
  cut(seat);  // not stored
  EXPECT_EQ(seat.device->node().node_id(), unconfigured);
  select(address);
  set_node_id(6);
  EXPECT_EQ(store(), LssResult::done);
  forget();
  cut(seat);
  EXPECT_EQ(heard(0x706), 1U);
  EXPECT_EQ(seat.device->node().node_id(), 6);
}

TEST_F(LssOnBus, ItsStore_OutlivesTheDevice_AndAFailureIsTold) {
  Store memory;
  add(address, unconfigured, 250'000, &memory);
  select(address);
  set_node_id(7);
  memory.broken = true;
  EXPECT_EQ(store(), LssResult::refused);
  EXPECT_EQ(master.error(), 2);
  memory.broken = false;
  EXPECT_EQ(store(), LssResult::done);
  can::Timeline later;
  Bus other("field", 250'000, later);
  const Seat again(other, later, address, unconfigured, 250'000, &memory);
  EXPECT_EQ(again.device->node().node_id(), 7);
  memory.image = {5, 0, 0, 0, 0};  // no bit rate
  const Seat damaged(other, later, address, unconfigured, 250'000, &memory);
  EXPECT_EQ(damaged.device->node().node_id(), unconfigured);
}

TEST_F(LssOnBus, BitRate_ChangesAfterTheSwitchDelay_WithSilenceBeforeAndAfter) {
  Seat& seat = add(address, 5);
  run_for(5ms);
  station.send_at(timeline.now(),
                  can::data_frame(0x605, {0x2B, 0x17, 0x10, 0x00, 10, 0, 0, 0}));  // heartbeat
  run_for(100ms);
  EXPECT_GE(heard(0x705), 9U);
  select(address);
  EXPECT_EQ(set_bit_rate(2), LssResult::done);  // 500 kbit/s
  run_for(50ms);
  EXPECT_EQ(seat.port.bit_rate(), 250'000U);
  EXPECT_EQ(activate(200ms), LssResult::done);
  const can::Time asked = timeline.now();
  forget();
  run_for(190ms);
  EXPECT_TRUE(station.heard.empty());
  EXPECT_EQ(seat.port.bit_rate(), 250'000U);
  run_for(10ms);
  EXPECT_EQ(seat.port.bit_rate(), 500'000U);
  station.port.restart(500'000);
  run_for(189ms);
  EXPECT_TRUE(station.heard.empty());
  run_for(100ms);
  EXPECT_GE(heard(0x705), 9U);
  EXPECT_GE(station.heard.front().at, asked + 400ms - 1ms);
  EXPECT_LE(station.heard.front().at, asked + 400ms + 11ms);
}

// One that has nothing else to do than to move a value does not overlook it, whichever of the two it was told first.
TEST_F(LssOnBus, BitRate_OfADeviceThatMovesAValue_ChangesAfterTheSwitchDelay) {
  constexpr Behaviour moving{
      .kind = Behaviour::Kind::counter, .index = 0x6000, .sub = 1, .high = 9, .period = 20ms};
  for (const bool moves_first : {true, false}) {
    Port& port = bus.add_port("device");
    Device device(io_block(address), 5, port);
    if (!moves_first) device.enable_lss(port, nullptr);
    EXPECT_EQ(device.add_behaviour(moving), std::nullopt);
    if (moves_first) device.enable_lss(port, nullptr);
    const can::Timeline::Handle handle = timeline.add(device);
    port.connect(device);
    device.power_on(timeline.now());
    device.node().command(canopen::NmtCommand::start, timeline.now());
    run_for(5ms);
    EXPECT_EQ(select(address), LssResult::done);
    EXPECT_EQ(set_bit_rate(2), LssResult::done);  // 500 kbit/s
    EXPECT_EQ(activate(200ms), LssResult::done);
    run_for(190ms);
    EXPECT_EQ(port.bit_rate(), 250'000U);
    run_for(10ms);
    EXPECT_EQ(port.bit_rate(), 500'000U) << moves_first;
    port.plug(false);
    timeline.remove(handle);
  }
}

TEST_F(LssOnBus, BitRateThatTheFileDoesNotName_IsRefused) {
  Seat& seat = add(address, 5);
  run_for(5ms);
  std::set<std::uint32_t> named(seat.device->file().device.bit_rates.begin(),
                                seat.device->file().device.bit_rates.end());
  ASSERT_FALSE(named.empty());
  select(address);
  for (std::uint8_t index = 0; index < lss::bit_rates.size(); ++index) {
    const bool known = named.contains(lss::bit_rates[index]);
    EXPECT_EQ(set_bit_rate(index), known ? LssResult::done : LssResult::refused) << unsigned{index};
    if (!known) {
      EXPECT_EQ(master.error(), 1);
    }
  }
}

TEST_F(LssOnBus, PendingBitRate_IsInForceAfterAReset) {
  Seat& seat = add(address, 5);
  run_for(5ms);
  select(address);
  set_bit_rate(4);  // 125 kbit/s
  switch_all(false);
  run_for(50ms);
  EXPECT_EQ(seat.port.bit_rate(), 250'000U);
  station.send_at(timeline.now(), can::data_frame(0x000, {0x82, 0x00}));
  run_for(1ms);
  station.port.restart(125'000);
  EXPECT_EQ(seat.port.bit_rate(), 125'000U);
  forget();
  run_for(50ms);
  EXPECT_EQ(heard(0x705), 1U);
  EXPECT_EQ(seat.device->node().node_id(), 5);
}

TEST_F(LssOnBus, AtAnotherBitRate_ItHearsNothingAndDestroysFrames_LssAtItsRateBringsItBack) {
  Seat& good = add({1, 2, 3, 4}, 9);
  Seat& wrong = add(address, unconfigured, 125'000);
  run_for(20ms);
  EXPECT_EQ(select(address), LssResult::silence);
  EXPECT_GT(wrong.port.counters().errors, 0U);
  EXPECT_GT(station.port.counters().errors, 0U);  // its frames were hit by error flags
  good.port.plug(false);                          // one to one, as the manuals advise
  station.port.restart(125'000);
  run_for(10ms);
  EXPECT_EQ(select(address), LssResult::done);
  EXPECT_EQ(set_node_id(5), LssResult::done);
  EXPECT_EQ(set_bit_rate(3), LssResult::done);
  EXPECT_EQ(store(), LssResult::done);
  EXPECT_EQ(activate(100ms), LssResult::done);
  run_for(100ms);
  station.port.restart(250'000);
  good.port.plug(true);
  run_for(100ms);
  forget();
  switch_all(false);
  run_for(20ms);
  EXPECT_EQ(heard(0x705), 1U);
  const std::uint64_t errors = station.port.counters().errors;
  station.send_at(timeline.now(), can::data_frame(0x609, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}));
  station.send_at(timeline.now(), can::data_frame(0x605, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}));
  run_for(20ms);
  EXPECT_EQ(heard(0x589), 1U);
  EXPECT_EQ(heard(0x585), 1U);
  EXPECT_EQ(station.port.counters().errors, errors);
  cut(wrong);
  EXPECT_EQ(wrong.port.bit_rate(), 250'000U);
  EXPECT_EQ(wrong.device->node().node_id(), 5);
}

TEST_F(LssOnBus, EqualAnswersOfSeveralDevices_AreOneFrameOnTheWire_DifferentOnesCollide) {
  add({1, 2, 3, 4});
  add({1, 2, 3, 5});
  add({1, 2, 3, 6});
  run_for(5ms);
  EXPECT_EQ(service([&](can::Time now) { return master.identify_unconfigured(now); }), LssResult::done);
  run_for(5ms);
  EXPECT_EQ(heard(0x7E4), 1U);
  EXPECT_EQ(station.port.counters().errors, 0U);
  switch_all(true);
  EXPECT_EQ(service([&](can::Time now) { return master.inquire(0, now); }), LssResult::done);
  EXPECT_EQ(master.value(), 1U);  // all of one vendor
  EXPECT_EQ(station.port.counters().errors, 0U);
  service([&](can::Time now) { return master.inquire(3, now); });
  EXPECT_GT(station.port.counters().errors, 0U);  // of three serial numbers none may have gone through whole
}

TEST_F(LssOnBus, SlowScan_FindsAllOfAVendorsDevices_WithAndWithoutNodeId) {
  std::mt19937_64 random(11);
  std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
  const auto put = [&](std::uint32_t own_revision, std::uint32_t own_serial, std::uint8_t node_id) {
    expected.insert({own_revision, own_serial});
    add({0x71, 0xED63, own_revision, own_serial}, node_id);
  };
  put(0, 0, 20);
  put(0xFFFFFFFF, 0xFFFFFFFF, unconfigured);
  put(0xFFFFFFFF, 0, 21);
  put(0x00010000, 7, unconfigured);
  put(0x00010000, 8, unconfigured);
  for (std::uint8_t i = 0; i < 10; ++i) {
    put(static_cast<std::uint32_t>(random()), static_cast<std::uint32_t>(random()),
        i % 2 == 0 ? unconfigured : static_cast<std::uint8_t>(30 + i));
  }
  add({0x72, 0xED63, 1, 1});  // another vendor's, another product
  add({0x71, 0xED64, 1, 1});
  run_for(20ms);
  master.set_time_out(5ms);
  std::set<std::pair<std::uint32_t, std::uint32_t>> found;
  LssAddress low{0x71, 0xED63, 0, 0};
  LssAddress high{0x71, 0xED63, 0xFFFFFFFF, 0xFFFFFFFF};
  // In the order of revision and serial number: behind each one the rest of its revision, then what follows.
  while (found.size() < 100) {
    const std::size_t sent_before = station.sent.size();
    if (service([&](can::Time now) { return master.slow_scan(low, high, now); }) == LssResult::done) {
      const LssAddress one = master.address();
      EXPECT_LE(station.sent.size() - sent_before, 65U * 6 + 4);
      EXPECT_TRUE(found.empty() || *found.rbegin() < std::pair(one.revision, one.serial));
      EXPECT_TRUE(found.insert({one.revision, one.serial}).second);
      switch_all(false);
      low = high = one;
      low.serial = one.serial + 1;
      high.serial = 0xFFFFFFFF;
      if (one.serial != 0xFFFFFFFF) continue;
    }
    EXPECT_NE(latest, LssResult::lost);
    if (high.revision == 0xFFFFFFFF) break;
    low = {0x71, 0xED63, high.revision + 1, 0};
    high = {0x71, 0xED63, 0xFFFFFFFF, 0xFFFFFFFF};
  }
  EXPECT_EQ(found, expected);
}

/// Watching the wire makes the bus work bit by bit.
struct Wire final : WireObserver {
  void level_changed(bool, can::Time) override { ++changes; }
  void transmit_changed(const Port&, bool, can::Time) override {}
  void activity_changed(const Port&, bool, bool, can::Time) override {}
  std::uint64_t changes = 0;
};

LssAddress random_address(std::mt19937_64& random) {
  LssAddress own;
  // A few vendors and products, so that long parts of the addresses agree, and any revision and serial.
  own.vendor = random() % 3 == 0 ? 0x71 : static_cast<std::uint32_t>(random());
  own.product = random() % 2 == 0 ? 0xED63 : static_cast<std::uint32_t>(random());
  own.revision = random() % 2 == 0 ? 0x00010000 : static_cast<std::uint32_t>(random());
  own.serial = static_cast<std::uint32_t>(random());
  return own;
}

TEST_F(LssOnBus, Fastscan_Finds32DevicesWithRandomIdentities_AndConfiguresAll_BitByBit) {
  Wire wire;
  bus.add_observer(wire);
  std::mt19937_64 random(7);
  std::map<std::uint8_t, LssAddress> given;
  for (int i = 0; i < 32; ++i) add(random_address(random));
  run_for(5ms);
  master.set_time_out(2ms);
  std::uint8_t next = 10;
  while (fastscan() == LssResult::done && next < 100) {
    given[next] = master.address();
    EXPECT_EQ(set_node_id(next), LssResult::done);
    EXPECT_EQ(store(), LssResult::done);
    switch_all(false);
    ++next;
  }
  EXPECT_EQ(latest, LssResult::silence);
  EXPECT_EQ(given.size(), 32U);
  EXPECT_GT(wire.changes, 100'000U);
  EXPECT_EQ(station.port.counters().errors, 0U);
  run_for(50ms);
  std::set<std::uint8_t> ids;
  for (const Seat& seat : seats) {
    const std::uint8_t id = seat.device->node().node_id();
    EXPECT_TRUE(ids.insert(id).second);
    EXPECT_EQ(heard(0x700U + id), 1U);
    EXPECT_EQ(seat.device->node().state(), canopen::NmtState::pre_operational);
    ASSERT_TRUE(given.contains(id));
    for (unsigned part = 0; part < 4; ++part) {
      EXPECT_EQ(
          seat.device->node().dictionary().get<std::uint32_t>(0x1018, static_cast<std::uint8_t>(part + 1)),
          given[id].part(part));
    }
  }
  bus.remove_observer(wire);
}

}  // namespace
}  // namespace canopus::sim::device_lss_test
