// What a node takes from the heap, counted: 6 KiB for a slave of the usual size, and nothing on a frame's
// path.

#include <cstdlib>
#include <limits>
#include <new>

#include <gtest/gtest.h>
#include <malloc.h>

#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/canopen/service/node_listener.hpp"

#include "canopen/conversation.hpp"

namespace {
std::size_t allocated_bytes = 0;
std::size_t allocations = 0;
constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();
std::size_t allocations_left = unlimited;  // then there is no memory
}  // namespace

// GCC takes malloc() here and free() below for a mismatch, because it inlines only one of the two.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
void* operator new(std::size_t size) {
  if (allocations_left == 0) throw std::bad_alloc();
  if (allocations_left != unlimited) --allocations_left;
  allocated_bytes += size;
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#pragma GCC diagnostic pop

namespace canopus::canopen::memory_test {
namespace {

struct Counter final : can::Sink {
  bool send(const can::Frame& frame) override {
    ++frames;
    last = frame;
    return true;
  }
  int frames = 0;
  can::Frame last;
};

TEST(Memory, OfASlaveWithFourPdosEachWay_IsBelowSixKibibytes) {
  const DictionaryBuilder objects = standard_objects();
  const auto description = objects.build();
  ASSERT_GE(description->objects().size(), 50U);
  Counter bus;
  const std::size_t before = allocated_bytes;
  Node node(description, 5, bus);
  node.power_on({});
  for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
    for (const int base : {0x1400, 0x1800}) {
      const auto communication = static_cast<std::uint16_t>(base + pdo);
      const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
      const std::uint32_t first = base == 0x1400 ? 0x62000108 : 0x60000108;
      ObjectDictionary& d = node.dictionary();
      for (std::uint8_t i = 0; i < 8; ++i) {
        ASSERT_EQ(
            d.write(mapping, static_cast<std::uint8_t>(i + 1), little_endian(first + i * 0x100U, 4), {}),
            AbortCode::none);
      }
      ASSERT_EQ(d.write(mapping, 0, little_endian(8, 1), {}), AbortCode::none);
      const auto cob_id = d.get<std::uint32_t>(communication, 1) & 0x7FF;
      ASSERT_EQ(d.write(communication, 1, little_endian(cob_id, 4), {}), AbortCode::none);
    }
  }
  node.receive(can::data_frame(0x000, {0x01, 0x05}), {});
  // What building tables took and gave back is counted, too: the node holds less than this.
  RecordProperty("bytes", static_cast<int>(allocated_bytes - before + sizeof(Node)));
  EXPECT_LE(allocated_bytes - before + sizeof(Node), 6U * 1024)
      << "sizeof(Node) is " << sizeof(Node) << ". A new member or timer of a service counts for every slave: "
      << "allocate what few slaves use when it is first used, or keep it in what slaves of one kind share "
      << "(DictionaryDescription)";
}

// 48 objects: device and identity, parameters, inputs and outputs, four PDOs each way with four entries.
DictionaryBuilder usual_slave() {
  DictionaryBuilder builder;
  for (const int index : {0x1000, 0x1001, 0x1005, 0x1006, 0x1008, 0x1014, 0x1015, 0x1017, 0x1018}) {
    builder.variable(static_cast<std::uint16_t>(index), {.name = "Communication object"});
  }
  for (std::uint16_t i = 0; i <= 20; ++i) {
    builder.variable(static_cast<std::uint16_t>(0x2100 + i), {.name = "Parameter"});
  }
  for (const int index : {0x6000, 0x6200}) {
    builder.uniform(static_cast<std::uint16_t>(index), ObjectCode::array, "Values", 16,
                    {.name = "Value", .type = DataType::unsigned16});
  }
  for (const unsigned first : {0x1400U, 0x1600U, 0x1800U, 0x1A00U}) {
    for (unsigned index = first; index < first + 4; ++index) {
      for (std::uint8_t sub = 1; sub <= 4; ++sub) {
        builder.sub(static_cast<std::uint16_t>(index), sub, {.name = "Entry"});
      }
    }
  }
  return builder;
}

TEST(Memory, OfADescriptionOfTheUsualSize_IsBelowTwoKibibytes) {
  const DictionaryBuilder objects = usual_slave();
  ASSERT_EQ(objects.build()->objects().size(), 48U);
  const std::size_t before = mallinfo2().uordblks;
  const auto description = objects.build();
  const std::size_t bytes = mallinfo2().uordblks - before;
  RecordProperty("bytes", static_cast<int>(bytes));
  EXPECT_LE(bytes, 2U * 1024)
      << "a field of each object or sub-index costs this slave 48 or more times its size";
}

TEST(Memory, NothingIsAllocatedOnAFramesPath) {
  Conversation c;
  c.set_up(0x1400, {0x62000108, 0x64110110}, 0xFE);
  c.set_up(0x1401, {0x62000208}, 0x01);
  c.set_up(0x1800, {0x60000108}, 0x01);
  c.write(0x1017, 0, 10, 2);
  c.write(0x1016, 1, 0x00090064, 4);
  Counter bus;
  Node node(standard_objects().build(), 5, bus);
  node.power_on({});
  for (const int index : {0x1400, 0x1401, 0x1600, 0x1601, 0x1800, 0x1A00, 0x1016, 0x1017}) {
    const ObjectDescription* object = node.dictionary().description().find(static_cast<std::uint16_t>(index));
    for (unsigned sub = 0; sub <= object->highest_sub; ++sub) {
      const Entry entry = node.dictionary().description().find(*object, static_cast<std::uint8_t>(sub));
      if (entry) node.dictionary().assign(entry, c.node.dictionary().bytes(entry));
    }
  }
  struct Restorer final : NodeListener {
  } listener;
  node.set_listener(&listener);
  // Communication parameters are read again when they are written; this one write stands for all.
  for (const int index : {0x1400, 0x1401, 0x1800}) {
    const auto raw = node.dictionary().get<std::uint32_t>(static_cast<std::uint16_t>(index), 1);
    ASSERT_EQ(node.dictionary().write(static_cast<std::uint16_t>(index), 1, little_endian(raw, 4), {}),
              AbortCode::none);
  }
  ASSERT_EQ(node.dictionary().write(0x1017, 0, little_endian(10, 2), {}), AbortCode::none);
  ASSERT_EQ(node.dictionary().write(0x1016, 1, little_endian(0x00090064, 4), {}), AbortCode::none);
  can::Time now{};
  SdoClient client(bus);
  client.set_server(5);
  struct User final : SdoClientListener {
    void sdo_finished(SdoClient&, can::Time) override {}
  } user;
  const std::uint8_t value[] = {1, 0};
  const auto round = [&] {
    now += 10ms;
    node.receive(can::data_frame(0x000, {0x01, 0x05}), now);
    node.receive(can::data_frame(0x205, {1, 2, 3}), now);
    node.receive(can::data_frame(0x305, {1}), now);
    node.receive(can::data_frame(0x080), now);
    node.receive(can::data_frame(0x709, {0x05}), now);
    node.tick(now);
    client.upload(0x1000, 0, user, now);
    node.receive(bus.last, now);
    client.receive(bus.last, now);
    client.download(0x2005, 0, value, user, now);
    node.receive(bus.last, now);
    client.receive(bus.last, now);
  };
  round();  // buffers grow to their size
  const std::size_t before = allocations;
  const int frames_before = bus.frames;
  for (int i = 0; i < 100; ++i) round();
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(bus.frames - frames_before, 600) << "TPDO, heartbeat, and two SDO requests and answers each time";
}

// Each allocation of a rebuild fails once.
TEST(Memory, ThatADescriptionNeedsAndThereIsNot_LeavesTheNodeAsItWas) {
  struct Refusal final : ObjectHandler {
    AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>,
                           can::Time) override {
      return AbortCode::hardware_error;
    }
  } refusal;
  Counter bus;
  const auto first = standard_objects().build();
  Node node(first, 5, bus);
  for (const int object : {0x2003, 0x2005, 0x2104}) {
    const auto index = static_cast<std::uint16_t>(object);
    node.attach(index, index, refusal);
  }
  const auto second = usual_slave().build();
  const auto is_described = [&] {
    try {
      node.describe(second, {});
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  };
  std::size_t failures = 0;
  for (;; ++failures) {
    node.power_on({});
    node.receive(can::data_frame(0x605, {0x2B, 0x05, 0x20, 0x00, 0x07, 0x00, 0x00, 0x00}), {});
    EXPECT_EQ(to_text(bus.last), "585 80 05 20 00 00 00 06 06") << failures;
    node.receive(can::data_frame(0x605, {0x2B, 0x17, 0x10, 0x00, 0x0A, 0x00, 0x00, 0x00}), {});
    EXPECT_EQ(to_text(bus.last), "585 60 17 10 00 00 00 00 00") << failures;
    EXPECT_EQ(node.deadline(), can::Time(10ms));
    node.power_off();
    EXPECT_EQ(node.deadline(), can::never);
    allocations_left = failures;
    const bool is_done = is_described();
    allocations_left = unlimited;
    if (is_done) break;
    ASSERT_EQ(&node.dictionary().description(), first.get()) << failures;
  }
  EXPECT_GT(failures, 10U);
  EXPECT_EQ(&node.dictionary().description(), second.get());
  node.power_on({});
  EXPECT_EQ(to_text(bus.last), "705 00");
  node.receive(can::data_frame(0x605, {0x23, 0x04, 0x21, 0x00, 0x07, 0x00, 0x00, 0x00}), {});
  EXPECT_EQ(to_text(bus.last), "585 80 04 21 00 00 00 06 06");
}

}  // namespace
}  // namespace canopus::canopen::memory_test
