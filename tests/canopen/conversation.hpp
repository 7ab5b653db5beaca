#pragma once
// A node and what it says: frames in and out as text, "605 40 08 10 00 00 00 00 00", "705 R" for a remote
// frame (R8: of DLC 8), eight digits for a 29-bit identifier, so that a test reads as the conversation on the
// bus.

#include <cctype>
#include <cstdio>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::canopen {

using namespace std::chrono_literals;

inline std::string to_text(const can::Frame& frame) {
  char digits[16];
  std::snprintf(digits, sizeof digits, frame.extended ? "%08X" : "%03X", frame.identifier);
  std::string text = digits;
  if (frame.remote) {
    text += " R";
    if (frame.dlc != 0) text += std::to_string(frame.dlc);
    return text;
  }
  for (std::size_t i = 0; i < frame.dlc && i < 8; ++i) {
    std::snprintf(digits, sizeof digits, " %02X", frame.data[i]);
    text += digits;
  }
  return text;
}

inline can::Frame from_text(const std::string& text) {
  std::istringstream words(text);
  std::string word;
  words >> word;
  can::Frame frame{.identifier = static_cast<std::uint32_t>(std::stoul(word, nullptr, 16)),
                   .extended = word.size() == 8};
  while (words >> word) {
    if (word[0] == 'R') {
      frame.remote = true;
      frame.dlc = word.size() > 1 ? static_cast<std::uint8_t>(word[1] - '0') : std::uint8_t{0};
    } else {
      frame.data.at(frame.dlc++) = static_cast<std::uint8_t>(std::stoul(word, nullptr, 16));
    }
  }
  return frame;
}

/// Takes frames down as text, each with what `prefix` says.
class Notebook final : public can::Sink {
 public:
  bool send(const can::Frame& frame) override {
    if (is_full) return false;
    lines.push_back(prefix + to_text(frame));
    return true;
  }
  /// Everything since the last call, separated by " | ".
  std::string drain() {
    std::string all;
    for (const auto& line : lines) all += (all.empty() ? "" : " | ") + line;
    lines.clear();
    return all;
  }

  std::vector<std::string> lines;
  std::string prefix;
  bool is_full = false;
};

/// A dictionary with every object of CiA 301 that the node knows, four PDOs each way (not valid), and process
/// values: 6000:01-08 U8 and 6401:01-04 I16 for TPDOs, 6200:01-08 U8 and 6411:01-04 I16 for RPDOs, 6020H
/// and 6220H BOOLEAN likewise; 2000H.. one of each data type.
inline DictionaryBuilder standard_objects() {
  DictionaryBuilder b;
  const auto variable = [&b](std::uint16_t index, DataType type, Access access, std::uint64_t value = 0,
                             bool adds_node_id = false) {
    b.variable(index, {.name = "object",
                       .type = type,
                       .access = access,
                       .value = little_endian(value, byte_length(type)),
                       .adds_node_id = adds_node_id});
  };
  using enum DataType;
  using enum Access;
  variable(0x1000, unsigned32, read_only, 0x00020191);
  variable(0x1001, unsigned8, read_only);
  b.object(0x1003, ObjectCode::array, "history");
  b.sub(0x1003, 0, {.name = "number", .type = unsigned8, .access = read_write});
  for (std::uint8_t sub = 1; sub <= 3; ++sub) {
    b.sub(0x1003, sub, {.name = "error", .type = unsigned32, .access = read_only});
  }
  variable(0x1005, unsigned32, read_write, 0x80);
  variable(0x1006, unsigned32, read_write);
  variable(0x1007, unsigned32, read_write);
  b.variable(0x1008,
             {.name = "name", .type = visible_string, .access = constant, .value = text("ME3CAN1-Q")});
  b.variable(0x1009, {.name = "hardware", .type = visible_string, .access = constant, .value = text("1.0")});
  variable(0x100C, unsigned16, read_write);
  variable(0x100D, unsigned8, read_write);
  variable(0x1012, unsigned32, read_write, 0x100);
  variable(0x1014, unsigned32, read_write, 0x80, true);
  variable(0x1015, unsigned16, read_write);
  b.uniform(0x1016, ObjectCode::array, "consumers", 3, {.name = "consumer", .type = unsigned32});
  variable(0x1017, unsigned16, read_write);
  b.object(0x1018, ObjectCode::record, "identity");
  b.sub(0x1018, 1, {.name = "vendor", .access = read_only, .value = little_endian(0x1D0, 4)});
  b.sub(0x1018, 2, {.name = "product", .access = read_only});
  variable(0x1019, unsigned8, read_write);
  b.uniform(0x1028, ObjectCode::array, "emcy", 127, {.name = "emcy", .value = little_endian(0x80000000, 4)});
  b.uniform(0x1029, ObjectCode::array, "behaviour", 1, {.name = "communication", .type = unsigned8});
  for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
    const auto rpdo = static_cast<std::uint16_t>(0x1400 + pdo);
    b.object(rpdo, ObjectCode::record, "RPDO");
    b.sub(rpdo, 1, {.value = little_endian(0x80000200U + 0x100U * pdo, 4), .adds_node_id = true});
    b.sub(rpdo, 2, {.type = unsigned8, .value = {0xFF}});
    b.sub(rpdo, 3, {.type = unsigned16});
    b.sub(rpdo, 5, {.type = unsigned16});
    const auto tpdo = static_cast<std::uint16_t>(0x1800 + pdo);
    b.object(tpdo, ObjectCode::record, "TPDO");
    b.sub(tpdo, 1, {.value = little_endian(0x80000180U + 0x100U * pdo, 4), .adds_node_id = true});
    b.sub(tpdo, 2, {.type = unsigned8, .value = {0xFF}});
    b.sub(tpdo, 3, {.type = unsigned16});
    b.sub(tpdo, 5, {.type = unsigned16});
    b.sub(tpdo, 6, {.type = unsigned8});
    for (const int mapping : {0x1600, 0x1A00}) {
      const auto index = static_cast<std::uint16_t>(mapping + pdo);
      b.object(index, ObjectCode::array, "mapping");
      b.sub(index, 0, {.type = unsigned8});
      for (std::uint8_t sub = 1; sub <= 8; ++sub) b.sub(index, sub, {});
    }
  }
  const DataType types[] = {boolean,    integer8,    integer16,  integer32,       unsigned8,
                            unsigned16, unsigned32,  real32,     visible_string,  octet_string,
                            domain,     time_of_day, integer24,  real64,          integer40,
                            integer48,  integer56,   integer64,  unsigned24,      unsigned40,
                            unsigned48, unsigned56,  unsigned64, time_difference, unicode_string};
  std::uint16_t next = 0x2000;
  for (const DataType type : types) b.variable(next++, {.name = "value", .type = type});
  b.variable(0x2020, {.name = "write-only", .type = unsigned8, .access = write_only});
  b.variable(0x2021, {.name = "read-only", .type = unsigned16, .access = read_only, .value = {0x34, 0x12}});
  b.variable(0x2022, {.name = "limited",
                      .type = integer16,
                      .limits = {.low = static_cast<std::uint64_t>(-100), .high = 100}});
  b.uniform(0x6000, ObjectCode::array, "inputs", 8,
            {.type = unsigned8, .access = read_only, .tpdo_mappable = true});
  b.uniform(0x6020, ObjectCode::array, "input bits", 8,
            {.type = boolean, .access = read_only, .tpdo_mappable = true});
  b.uniform(0x6200, ObjectCode::array, "outputs", 8,
            {.type = unsigned8, .access = read_write, .rpdo_mappable = true});
  b.uniform(0x6220, ObjectCode::array, "output bits", 8,
            {.type = boolean, .access = read_write, .rpdo_mappable = true});
  b.uniform(0x6401, ObjectCode::array, "analogue inputs", 4,
            {.type = integer16, .access = read_only, .tpdo_mappable = true});
  b.uniform(0x6411, ObjectCode::array, "analogue outputs", 4,
            {.type = integer16, .access = read_write, .rpdo_mappable = true});
  b.variable(0x6500,
             {.type = unsigned64, .access = read_write, .rpdo_mappable = true, .tpdo_mappable = true});
  return b;
}

/// A node with node-ID 5 on a bus of its own, powered on: the boot-up message has been said and taken.
class Conversation : public NodeListener {
 public:
  explicit Conversation(const DictionaryBuilder& objects = standard_objects(), NodeOptions options = {})
      : node(objects.build(), 5, bus, options) {
    node.set_listener(this);
    node.power_on(now);
    bus.drain();
    events.clear();
  }
  explicit Conversation(NodeOptions options) : Conversation(standard_objects(), options) {}
  virtual ~Conversation() = default;

  /// A frame comes in; what the node says to it.
  std::string receive(const std::string& frame) {
    node.receive(from_text(frame), now);
    return bus.drain();
  }
  /// Time passes; what the node says of itself, each with the millisecond: "100: 705 05".
  std::string wait(can::Duration span) {
    const can::Time end = now + span;
    while (node.deadline() <= end) {
      now = std::max(now, node.deadline());
      const auto since_start = std::chrono::duration<double, std::milli>(now.time_since_epoch()).count();
      char digits[32];
      std::snprintf(digits, sizeof digits, "%g: ", since_start);
      bus.prefix = digits;
      node.tick(now);
    }
    bus.prefix.clear();
    now = end;
    return bus.drain();
  }
  void start() {
    node.command(NmtCommand::start, now);
    bus.drain();
  }
  /// Writes as the bus does.
  AbortCode write(std::uint16_t index, std::uint8_t sub, std::uint64_t value, unsigned length) {
    return node.dictionary().write(index, sub, little_endian(value, length), now);
  }
  /// Makes TPDO/RPDO `number` (from 0) valid: its mapping entries, type, and default identifier (no RTR).
  void set_up(std::uint16_t communication, const std::vector<std::uint32_t>& entries, std::uint8_t type) {
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    write(mapping, 0, 0, 1);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (write(mapping, static_cast<std::uint8_t>(i + 1), entries[i], 4) != AbortCode::none) std::abort();
    }
    if (write(mapping, 0, entries.size(), 1) != AbortCode::none) std::abort();
    if (write(communication, 2, type, 1) != AbortCode::none) std::abort();
    const auto cob_id = node.dictionary().get<std::uint32_t>(communication, 1) & 0x7FF;
    const std::uint32_t flags = communication >= 0x1800 && type != 0xFC && type != 0xFD ? 0x40000000U : 0U;
    if (write(communication, 1, cob_id | flags, 4) != AbortCode::none) std::abort();
    bus.drain();
  }
  std::string drain_events() {
    std::string all;
    for (const auto& event : events) all += (all.empty() ? "" : ", ") + event;
    events.clear();
    return all;
  }

  void nmt_state_changed(NmtState state, can::Time) override { note(std::string(name(state))); }
  void reset_requested(NmtCommand which, can::Time) override {
    note(which == NmtCommand::reset_node ? "reset node" : "reset communication");
  }
  void reset_done(NmtCommand, can::Time) override { note("reset done"); }
  bool may_become_operational() override { return may_start; }
  void sync_received(std::uint8_t counter, can::Time) override { note("sync " + std::to_string(counter)); }
  void time_received(const TimeOfDay& time, can::Time) override {
    note("time " + std::to_string(time.milliseconds) + " " + std::to_string(time.days));
  }
  void emergency_received(const Emergency& e, can::Time) override {
    note("emcy " + std::to_string(e.node_id) + " " + std::to_string(e.code) + " " +
         std::to_string(e.error_register) + " " + std::to_string(e.manufacturer[4]));
  }
  void rpdo_received(std::uint16_t number, can::Time) override { note("rpdo " + std::to_string(number)); }
  void rpdo_timed_out(std::uint16_t number, can::Time) override {
    note("rpdo timed out " + std::to_string(number));
  }
  void heartbeat_received(std::uint8_t id, NmtState state, can::Time) override {
    note("heartbeat " + std::to_string(id) + " " + std::string(name(state)));
  }
  void heartbeat_lost(std::uint8_t id, can::Time) override { note("lost " + std::to_string(id)); }
  void life_guarding_event(bool occurred, can::Time) override {
    note(occurred ? "life guarding lost" : "life guarding back");
  }

  Notebook bus;
  can::Time now{};
  Node node;
  bool may_start = true;
  std::vector<std::string> events;

 private:
  void note(std::string event) { events.push_back(std::move(event)); }
};

}  // namespace canopus::canopen
