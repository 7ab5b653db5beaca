// Racks of the families: which devices they have, how X and Y are counted, where their modules are, and what FROM
// and TO do, with modules that no manual describes.

#include <array>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plc/rack/rack.hpp"

#include "plc/fake_module.hpp"

namespace canopus::plc::families_test {
namespace {

using ::testing::ElementsAre;
using testing::FakeModule;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

std::uint16_t word(Rack& rack, Device device, std::uint32_t number, can::Time now) {
  std::uint16_t value = 0xDEAD;
  EXPECT_TRUE(rack.read_words(device, number, {&value, 1}, now)) << number;
  return value;
}

bool bit(Rack& rack, Device device, std::uint32_t number, can::Time now) {
  std::uint8_t value = 2;
  EXPECT_TRUE(rack.read_bits(device, number, {&value, 1}, now)) << number;
  return value == 1;
}

TEST(Families, HaveTheirDevices) {
  struct Row {
    const CpuModel& model;
    std::map<Device, std::uint32_t> points;
  };
  using enum Device;
  const std::array rows = {
      Row{fx3u(),
          {{x, 248},
           {y, 248},
           {m, 7680},
           {d, 8000},
           {r, 32768},
           {s, 4096},
           {tn, 512},
           {cn, 256},
           {l, 0},
           {b, 0},
           {w, 0},
           {sm, 0},
           {sd, 0},
           {zr, 0},
           {hcn, 56}}},  // the high words of C200 to C255
      Row{fx5u(),
          {{x, 1024},
           {y, 1024},
           {m, 7680},
           {l, 7680},
           {b, 256},
           {f, 128},
           {sb, 512},
           {s, 4096},
           {d, 8000},
           {w, 512},
           {sw, 512},
           {sm, 10000},
           {sd, 12000},
           {r, 32768},
           {zr, 0},
           {stn, 16},
           {v, 0}}},
      Row{as300(),
          {{x, 1024},
           {y, 1024},
           {m, 8192},
           {s, 2048},
           {tn, 512},
           {cn, 512},
           {hcs, 256},
           {hcn, 512},
           {d, 30000},
           {sd, 2048},
           {sm, 2048},
           {r, 0},
           {w, 0},
           {b, 0}}},
      Row{r04cpu(), {{s, 0}, {hcn, 0}, {zr, 32768}}},
  };
  for (const Row& row : rows) {
    can::Timeline timeline;
    Rack rack(timeline, row.model);
    rack.power_on({});
    for (const auto& [device, points] : row.points) {
      SCOPED_TRACE(std::string(row.model.name) + " " + std::string(device_info(device).name));
      EXPECT_EQ(row.model.points_of(device), points);
      if (points == 0) {
        const auto none = rack.check(device, 0, 1);
        ASSERT_FALSE(none.has_value());
        EXPECT_EQ(none.error(), AccessError::no_device);
        continue;
      }
      EXPECT_TRUE(rack.check(device, 0, points));
      const bool special_follow = row.model.name == fx3u().name && device == d;  // D8000 to D8511
      const auto beyond = rack.check(device, special_follow ? points + 512 : points, 1);
      ASSERT_FALSE(beyond.has_value());
      EXPECT_EQ(beyond.error(), AccessError::out_of_range);
      std::array<std::uint16_t, 1> last{};
      const std::uint32_t at = device_info(device).is_bit ? points - 16 : points - 1;
      EXPECT_TRUE(rack.read_words(device, at, last, {}));
      EXPECT_TRUE(rack.write_words(device, at, last, {}));
    }
  }
}

TEST(Families, CountXAndYTheirOwnWay) {
  EXPECT_EQ(fx3u().number_base(Device::x), 8U);
  EXPECT_EQ(fx5u().number_base(Device::y), 8U);
  EXPECT_EQ(fx5u().number_base(Device::b), 16U);
  EXPECT_EQ(fx3u().number_base(Device::m), 10U);
  EXPECT_EQ(r04cpu().number_base(Device::x), 16U);
  EXPECT_EQ(as300().number_base(Device::x), 10U);
  EXPECT_EQ(as300().name_of(Device::sd), "SR");
  EXPECT_EQ(q03udvcpu().name_of(Device::sd), "SD");
}

TEST(Fx3, SpecialRelaysAndRegisters_AreMAndDFrom8000On) {
  can::Timeline timeline;
  Rack rack(timeline, fx3u(), 2500us);
  rack.set_clock(std::chrono::local_days{std::chrono::year{2026} / 11 / 22} + 9h + 31min + 5s, {});
  rack.power_on({});
  const can::Time first{1ms};
  const can::Time later{10s};
  EXPECT_TRUE(bit(rack, Device::m, 8000, first));
  EXPECT_FALSE(bit(rack, Device::m, 8001, first));
  EXPECT_TRUE(bit(rack, Device::m, 8002, first));
  EXPECT_FALSE(bit(rack, Device::m, 8003, first));
  EXPECT_FALSE(bit(rack, Device::m, 8002, later));
  EXPECT_TRUE(bit(rack, Device::m, 8003, later));
  EXPECT_FALSE(bit(rack, Device::m, 8013, later));
  EXPECT_TRUE(bit(rack, Device::m, 8013, later + 500ms));
  EXPECT_EQ(word(rack, Device::d, 8010, first), 0);
  for (const std::uint32_t time : {8010U, 8011U, 8012U}) EXPECT_EQ(word(rack, Device::d, time, later), 25);
  std::array<std::uint16_t, 7> clock{};
  ASSERT_TRUE(rack.read_words(Device::d, 8013, clock, can::Time{5s}));
  EXPECT_THAT(clock, ElementsAre(10, 31, 9, 22, 11, 26, 0)) << "a Sunday";
  rack.set_cpu_state(module::CpuState::stop, later);
  EXPECT_FALSE(bit(rack, Device::m, 8000, later));
  EXPECT_TRUE(bit(rack, Device::m, 8001, later));
}

TEST(Fx3, BetweenTheLastPointAndTheSpecialOnes_ThereIsNothing) {
  can::Timeline timeline;
  Rack rack(timeline, fx3u());
  rack.power_on({});
  EXPECT_TRUE(rack.check(Device::m, 7664, 16));
  EXPECT_FALSE(rack.check(Device::m, 7665, 16));
  EXPECT_FALSE(rack.check(Device::m, 7999, 2));
  EXPECT_TRUE(rack.check(Device::m, 8496, 16));
  EXPECT_FALSE(rack.check(Device::m, 8497, 16));
  EXPECT_FALSE(rack.check(Device::d, 7999, 2));
  EXPECT_TRUE(rack.check(Device::d, 8000, 512));
  EXPECT_FALSE(rack.check(Device::d, 8511, 2));
  std::array<std::uint16_t, 1> value{0x1234};
  ASSERT_TRUE(rack.write_words(Device::d, 8100, value, {}));
  ASSERT_TRUE(rack.write_words(Device::d, 100, value, {}));
  rack.clear_devices(true, {});
  EXPECT_EQ(word(rack, Device::d, 8100, {}), 0x1234) << "clearing the devices is not for special ones";
  EXPECT_EQ(word(rack, Device::d, 100, {}), 0);
}

TEST(Fx5, HasTheSpecialRelaysOfBothWorlds) {
  can::Timeline timeline;
  Rack rack(timeline, fx5u(), 1500us);
  rack.power_on({});
  EXPECT_TRUE(bit(rack, Device::sm, 400, {}));
  EXPECT_TRUE(bit(rack, Device::sm, 402, {}));
  EXPECT_TRUE(bit(rack, Device::sm, 8002, {}));
  EXPECT_EQ(word(rack, Device::sd, 420, can::Time{15ms}), 10);
  EXPECT_EQ(word(rack, Device::sd, 520, can::Time{15ms}), 1);
  EXPECT_EQ(word(rack, Device::sd, 521, can::Time{15ms}), 500);
  EXPECT_EQ(word(rack, Device::sd, 8010, can::Time{15ms}), 15);
  EXPECT_EQ(word(rack, Device::sd, 260, {}), 0) << "no points of devices there";
}

TEST(As300, SpecialRelaysBeginAt400) {
  can::Timeline timeline;
  Rack rack(timeline, as300());
  rack.power_on({}, module::CpuState::stop);
  EXPECT_FALSE(bit(rack, Device::sm, 400, {}));
  EXPECT_TRUE(bit(rack, Device::sm, 401, {}));
  rack.set_cpu_state(module::CpuState::run, {});
  EXPECT_TRUE(bit(rack, Device::sm, 400, {}));
  EXPECT_TRUE(bit(rack, Device::sm, 402, {}));
  EXPECT_TRUE(bit(rack, Device::sm, 403, can::Time{1s}));
  EXPECT_FALSE(bit(rack, Device::sm, 203, {}));
}

/// Whether a module can be put at this number.
bool takes(const CpuModel& model, std::uint16_t number) {
  can::Timeline timeline;
  Rack rack(timeline, model);
  FakeModule module(8);
  timeline.add(module);
  return rack.insert(static_cast<std::uint16_t>(16 * number), module);
}

TEST(Families, PutModulesAtTheirOwnPlaces) {
  EXPECT_TRUE(takes(fx3u(), 0) && takes(fx3u(), 7));
  EXPECT_FALSE(takes(fx3u(), 8));
  EXPECT_TRUE(takes(fx5u(), 1) && takes(fx5u(), 16));
  EXPECT_FALSE(takes(fx5u(), 0) || takes(fx5u(), 17));
  EXPECT_TRUE(takes(as300(), 1) && takes(as300(), 2));
  EXPECT_FALSE(takes(as300(), 0) || takes(as300(), 3));
  EXPECT_TRUE(takes(q03udvcpu(), 0xFF));
}

TEST(Fx3, ModulesOccupyNoXAndY) {
  can::Timeline timeline;
  Rack rack(timeline, fx3u());
  FakeModule first(32);
  FakeModule second(32);
  timeline.add(first);
  ASSERT_TRUE(rack.insert(0x00, first));
  timeline.add(second);
  ASSERT_TRUE(rack.insert(0x10, second)) << "the next position is the next module";
  rack.power_on({});
  first.x = 0xFFFFFFFF;
  EXPECT_FALSE(bit(rack, Device::x, 0, {}));
  const std::uint8_t on = 1;
  ASSERT_TRUE(rack.write_bits(Device::y, 0, {&on, 1}, {}));
  EXPECT_THAT(first.edges, IsEmpty());
  ASSERT_TRUE(rack.write_bits(Device::x, 3, {&on, 1}, {}));
  EXPECT_TRUE(bit(rack, Device::x, 3, {})) << "memory: what is wired to the main unit";
}

/// A special function block whose data BFM read what came from the network and take what goes there, and which
/// watches the program: FROM or TO of any BFM retriggers the watchdog, whose time is BFM 26 in 10 ms.
class WatchingBlock final : public FakeModule {
 public:
  WatchingBlock() : FakeModule(8, 100) {}
  std::uint16_t program_read(module::BufferAddress address, can::Time now) override {
    if (address == 29) return deadline() <= now ? 0x80 : 0;
    return address < 20 ? received[address] : FakeModule::program_read(address, now);
  }
  void accessed(module::BufferAddress first, std::uint32_t count, can::Time now) override {
    accesses.emplace_back(first, count);
    alarm() = now + 10ms * words[26];
  }
  void tick(can::Time now) override {
    expired_at = now;
    alarm().cancel();
  }

  std::array<std::uint16_t, 20> received{};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> accesses;
  can::Time expired_at = can::never;
};

struct FxRack {
  FxRack() {
    timeline.add(block);
    rack.insert(0x20, block);
    block.words[26] = 20;
    rack.power_on({});
  }
  can::Timeline timeline;
  WatchingBlock block;
  Rack rack{timeline, fx3u()};
};

TEST(FromTo, FromReadsAnotherPlaneThanToWrites) {
  FxRack plc;
  plc.block.received = {0x1111, 0x2222};
  const std::array<std::uint16_t, 2> sent = {7, 8};
  ASSERT_TRUE(plc.rack.write_buffer(0x20, 0, sent, {}));
  std::array<std::uint16_t, 2> found{};
  ASSERT_TRUE(plc.rack.read_buffer(0x20, 0, found, {}));
  EXPECT_THAT(found, ElementsAre(0x1111, 0x2222));
  EXPECT_EQ(plc.block.words[0], 7);
  EXPECT_EQ(plc.block.words[1], 8);
}

TEST(FromTo, DoubleWords_AreTwoWordsLowOneFirst_InOneAccess) {
  FxRack plc;
  const std::array<std::uint32_t, 2> values = {0x12345678, 0xFFFF0000};
  ASSERT_TRUE(plc.rack.write_double_words(0x20, 40, values, {}));
  EXPECT_EQ(plc.block.words[40], 0x5678);
  EXPECT_EQ(plc.block.words[41], 0x1234);
  std::array<std::uint32_t, 2> found{};
  ASSERT_TRUE(plc.rack.read_double_words(0x20, 40, found, {}));
  EXPECT_EQ(found, values);
  EXPECT_THAT(plc.block.accesses, ElementsAre(std::pair(40U, 4U), std::pair(40U, 4U)));
}

TEST(FromTo, BeyondTheLastWord_NothingIsReadOrWritten) {
  FxRack plc;
  std::array<std::uint32_t, 1> value{1};
  EXPECT_EQ(plc.rack.write_double_words(0x20, 99, value, {}).error(), AccessError::beyond_buffer);
  EXPECT_EQ(plc.rack.read_double_words(0x20, 99, value, {}).error(), AccessError::beyond_buffer);
  EXPECT_EQ(plc.rack.read_double_words(0x30, 0, value, {}).error(), AccessError::no_module);
  EXPECT_TRUE(plc.rack.write_double_words(0x20, 98, value, {}));
  EXPECT_EQ(plc.block.accesses.size(), 1U) << "what is refused is no access";
}

TEST(FromTo, AnyFromOrTo_RetriggersTheWatchdog) {
  FxRack plc;
  const auto at = [&plc](can::Duration time) { plc.timeline.run_until(can::Time{time}); };
  std::array<std::uint16_t, 1> words{};
  std::array<std::uint32_t, 1> doubles{};
  at(100ms);
  ASSERT_TRUE(plc.rack.read_buffer(0x20, 50, words, plc.timeline.now()));
  at(299ms);
  ASSERT_TRUE(plc.rack.write_buffer(0x20, 60, words, plc.timeline.now()));
  at(498ms);
  ASSERT_TRUE(plc.rack.read_double_words(0x20, 0, doubles, plc.timeline.now()));
  at(697ms);
  ASSERT_TRUE(plc.rack.write_double_words(0x20, 0, doubles, plc.timeline.now()));
  at(800ms);
  EXPECT_EQ(plc.block.expired_at, can::never);
  at(2s);
  EXPECT_EQ(plc.block.expired_at, can::Time{897ms});
}

/// A function card: registers of the CPU are its own.
class RegisterCard final : public FakeModule, public module::RegisterAccess {
 public:
  RegisterCard() : FakeModule(0, 0) {}
  [[nodiscard]] module::BufferMemoryAccess* buffer_memory() noexcept override { return nullptr; }
  [[nodiscard]] module::SignalAccess* signals() noexcept override { return nullptr; }
  [[nodiscard]] module::RegisterAccess* registers() noexcept override { return this; }
  [[nodiscard]] std::span<const module::RegisterRange> registers() const noexcept override {
    static constexpr std::array ranges = {module::RegisterRange{module::RegisterKind::data, 24000, 24002},
                                          module::RegisterRange{module::RegisterKind::special, 825, 825}};
    return ranges;
  }
  std::uint16_t read_register(module::RegisterKind kind, std::uint32_t number, can::Time) override {
    return static_cast<std::uint16_t>(kind == module::RegisterKind::data ? number : 1000 + number);
  }
  void write_register(module::RegisterKind kind, std::uint32_t number, std::uint16_t value,
                      can::Time) override {
    written.emplace_back(kind == module::RegisterKind::data ? number : 100000 + number, value);
  }
  std::vector<std::pair<std::uint32_t, std::uint16_t>> written;
};

TEST(As300, RegistersOfACard_AreReadAndWrittenInIt) {
  can::Timeline timeline;
  Rack rack(timeline, as300());
  RegisterCard card;
  timeline.add(card);
  ASSERT_TRUE(rack.insert(0x20, card));
  EXPECT_EQ(word(rack, Device::d, 24000, {}), 0) << "without supply";
  rack.power_on({});
  std::array<std::uint16_t, 5> found{};
  ASSERT_TRUE(rack.read_words(Device::d, 23999, found, {}));
  EXPECT_THAT(found, ElementsAre(0, 24000, 24001, 24002, 0));
  EXPECT_EQ(word(rack, Device::sd, 825, {}), 1825);
  EXPECT_EQ(word(rack, Device::sd, 24, {}), 0);
  const std::array<std::uint16_t, 3> sent = {7, 8, 9};
  ASSERT_TRUE(rack.write_words(Device::d, 24002, sent, {}));
  EXPECT_THAT(card.written, ElementsAre(std::pair(24002U, std::uint16_t{7})));
  EXPECT_EQ(word(rack, Device::d, 24003, {}), 8);
  std::array<std::uint16_t, 1> buffer{};
  EXPECT_EQ(rack.read_buffer(0x20, 0, buffer, {}).error(), AccessError::beyond_buffer)
      << "it has no buffer memory";
}

}  // namespace
}  // namespace canopus::plc::families_test
