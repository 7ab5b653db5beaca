#pragma once
// A master with its node, scripted slaves around it, and virtual time. Everything the master's side sends is
// kept as text: "500 000 01 00" = at 500 ms, identifier 000H, bytes 01 00; "R" for a remote frame.

#include <algorithm>
#include <cstdio>
#include <functional>
#include <list>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/canopen/node/node.hpp"
#include "canopus/manager/nmt/master_node.hpp"

#include "scripted_slave.hpp"

namespace canopus::manager::test {

using canopen::AbortCode;
using canopen::NmtState;

inline std::string text(const can::Frame& frame) {
  char part[8];
  std::snprintf(part, sizeof part, "%03X", static_cast<unsigned>(frame.identifier));
  std::string line = part;
  if (frame.remote) line += " R";
  for (const std::uint8_t byte : frame.bytes()) {
    std::snprintf(part, sizeof part, " %02X", static_cast<unsigned>(byte));
    line += part;
  }
  return line;
}

/// The objects of a master's dictionary that CiA 302-2 and 302-3 name.
inline std::shared_ptr<const canopen::DictionaryDescription> master_dictionary() {
  using canopen::Access;
  using canopen::DataType;
  using canopen::EntrySpec;
  using canopen::ObjectCode;
  canopen::DictionaryBuilder builder;
  const auto u32 = [](std::string name) { return EntrySpec{.name = std::move(name)}; };
  const auto u8 = [](std::string name) {
    return EntrySpec{.name = std::move(name), .type = DataType::unsigned8};
  };
  builder.variable(0x1000, {.name = "Device type", .access = Access::read_only});
  builder.variable(0x1001,
                   {.name = "Error register", .type = DataType::unsigned8, .access = Access::read_only});
  builder.uniform(0x1016, ObjectCode::array, "Consumer heartbeat time", 127, u32("Entry"));
  builder.variable(0x1017, {.name = "Producer heartbeat time", .type = DataType::unsigned16});
  builder.uniform(0x1018, ObjectCode::record, "Identity", 4,
                  {.name = "Identity", .access = Access::read_only});
  builder.variable(0x102A, {.name = "NMT inhibit time", .type = DataType::unsigned16});
  builder.uniform(0x1F22, ObjectCode::array, "Concise DCF", 127, {.name = "File", .type = DataType::domain});
  builder.uniform(0x1F25, ObjectCode::array, "Configuration request", 128,
                  {.name = "Request", .access = Access::write_only});
  builder.uniform(0x1F26, ObjectCode::array, "Expected configuration date", 127, u32("Date"));
  builder.uniform(0x1F27, ObjectCode::array, "Expected configuration time", 127, u32("Time"));
  builder.uniform(0x1F55, ObjectCode::array, "Expected software identification", 127, u32("Version"));
  builder.uniform(0x1F58, ObjectCode::array, "Program", 127, {.name = "Program", .type = DataType::domain});
  builder.variable(0x1F80, u32("NMT start-up"));
  builder.uniform(0x1F81, ObjectCode::array, "NMT slave assignment", 127, u32("Assignment"));
  builder.uniform(0x1F82, ObjectCode::array, "Request NMT", 128, u8("Request"));
  builder.uniform(0x1F83, ObjectCode::array, "Request node guarding", 128, u8("Request"));
  for (std::uint16_t index = 0x1F84; index <= 0x1F88; ++index) {
    builder.uniform(index, ObjectCode::array, "Expected identity", 127, u32("Expected"));
  }
  builder.variable(0x1F89, u32("Boot time"));
  builder.uniform(0x1F8A, ObjectCode::array, "Restore configuration", 127, u8("Sub-index"));
  builder.object(0x1F90, ObjectCode::record, "Flying master timing");
  const std::uint16_t timing[] = {100, 500, 1, 1500, 10, 4010};
  for (std::uint8_t sub = 1; sub <= 6; ++sub) {
    builder.sub(
        0x1F90, sub,
        {.name = "Time", .type = DataType::unsigned16, .value = canopen::little_endian(timing[sub - 1], 2)});
  }
  return builder.build();
}

/// Node 1 with a master on it; its objects and the slaves' concise DCFs are set from outside.
class ConfiguredMaster : public MasterNode, public ConfigurationSource {
 public:
  explicit ConfiguredMaster(can::Sink& sink) : MasterNode(master_dictionary(), 1, sink) {
    master().set_configuration_source(this);
  }
  std::span<const std::uint8_t> concise_dcf(std::uint8_t id) override { return files[id]; }

  std::map<std::pair<std::uint16_t, std::uint8_t>, std::uint32_t> stored;
  std::map<std::uint8_t, std::vector<std::uint8_t>> files;

 private:
  void configure(canopen::ObjectDictionary& objects) override {
    for (const auto& [place, value] : stored) objects.set(place.first, place.second, value);
  }
};

class MasterBench : public ::testing::Test,
                    public can::Sink,
                    public canopen::NodeListener,
                    public MasterListener,
                    public ConfigurationSource {
 public:
  MasterBench() : node(master_dictionary(), 1, *this), master(node, *this) {
    node.set_listener(this);
    master.set_listener(this);
    master.set_configuration_source(this);
  }
  virtual ~MasterBench() = default;

  // --- set up before switch_on()
  /// What the dictionary holds when the node starts.
  void object(std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
    stored_.push_back({index, sub, value});
  }
  ScriptedSlave& slave(std::uint8_t id) {
    return slaves.emplace_back(id, [this](const can::Frame& frame, can::Duration after) {
      bus_.push_back({now + after, ++order_, frame});
    });
  }
  ScriptedSlave& absent_slave(std::uint8_t id) {
    ScriptedSlave& device = slave(id);
    device.present = false;
    return device;
  }

  // --- time
  void switch_on() {
    node.power_on(now);
    run_for(0ms);
  }
  void run_for(can::Duration duration) { run_until(now + duration); }
  void run_until_ms(int milliseconds) { run_until(can::Time(std::chrono::milliseconds(milliseconds))); }
  /// A frame of somebody else reaches the master's side now.
  void receive(const can::Frame& frame) {
    node.receive(frame, now);
    master.receive(frame, now);
    run_for(0ms);
  }
  void heartbeat(std::uint8_t id, std::uint8_t state) { receive(can::data_frame(0x700U + id, {state})); }
  /// A heartbeat every `period` from now on to `end`.
  void heartbeats(std::uint8_t id, std::uint8_t state, can::Duration period, can::Duration duration) {
    for (can::Duration after{}; after <= duration; after += period) {
      bus_.push_back({now + after, ++order_, can::data_frame(0x700U + id, {state})});
    }
  }

  // --- what happened
  /// All that was sent since the last call, each with its time in ms.
  std::vector<std::string> sent() {
    std::vector<std::string> lines;
    std::swap(lines, sent_);
    return lines;
  }
  /// The same, but only NMT commands.
  std::vector<std::string> commands() {
    std::vector<std::string> lines;
    for (const std::string& line : sent()) {
      if (line.find(" 000 ") != std::string::npos) lines.push_back(line);
    }
    return lines;
  }
  [[nodiscard]] std::uint32_t read(std::uint16_t index, std::uint8_t sub) {
    const auto bytes = node.dictionary().read(index, sub, now);
    EXPECT_TRUE(bytes.has_value());
    return bytes ? (*bytes)[0] : 0xFFFFFFFF;
  }
  AbortCode write(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length) {
    const auto bytes = canopen::little_endian(value, length);
    const AbortCode code = node.dictionary().write(index, sub, bytes, now);
    run_for(0ms);
    return code;
  }

  can::Time now{};
  canopen::Node node;
  NmtMaster master;
  std::list<ScriptedSlave> slaves;
  std::map<std::uint8_t, std::vector<std::uint8_t>> files;
  std::map<std::uint8_t, std::vector<std::uint8_t>> programs;
  canopen::MemorySource program_source;
  std::vector<std::string> events;
  int refuse_frames = 0;  // the next so many frames find the transmit queue full
  bool channel_free = true;
  bool cpu_runs = true;

  // can::Sink
  bool send(const can::Frame& frame) override {
    if (refuse_frames > 0) {
      --refuse_frames;
      return false;
    }
    sent_.push_back(
        std::to_string(
            std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count()) +
        " " + text(frame));
    for (ScriptedSlave& device : slaves) device.receive(frame);
    return true;
  }
  // NodeListener
  void reset_requested(canopen::NmtCommand, can::Time at) override { master.stop(at); }
  void reset_done(canopen::NmtCommand, can::Time at) override {
    for (const auto& [index, sub, value] : stored_) node.dictionary().set(index, sub, value);
    master.start(at);
  }
  void nmt_state_changed(NmtState state, can::Time at) override { master.own_state_changed(state, at); }
  void heartbeat_received(std::uint8_t id, NmtState state, can::Time at) override {
    master.heartbeat_received(id, state, at);
  }
  void heartbeat_lost(std::uint8_t id, can::Time at) override { master.heartbeat_lost(id, at); }
  bool may_become_operational() override { return cpu_runs; }
  // MasterListener
  void active_changed(bool active, can::Time) override { note(active ? "active" : "inactive"); }
  void starting_changed(bool starting, can::Time) override { note(starting ? "starting" : "started"); }
  void start_up_finished(can::Time) override { note("finished"); }
  void start_up_halted(std::uint8_t id, BootError error, can::Time) override {
    note("halted by " + std::to_string(id) + " " + letter(error));
  }
  void slave_booted(std::uint8_t id, can::Time) override { note("booted " + std::to_string(id)); }
  void slave_failed(std::uint8_t id, BootError error, can::Time) override {
    note("failed " + std::to_string(id) + " " + letter(error));
  }
  void error_control_event(std::uint8_t id, ErrorControlEvent event, can::Time) override {
    note("event " + std::to_string(id) +
         (event == ErrorControlEvent::heartbeat_lost ? " heartbeat"
          : event == ErrorControlEvent::node_lost    ? " lost"
                                                     : " state"));
  }
  void error_control_resolved(std::uint8_t id, can::Time) override { note("resolved " + std::to_string(id)); }
  bool sdo_channel_free(std::uint8_t) override { return channel_free; }
  // ConfigurationSource
  std::span<const std::uint8_t> concise_dcf(std::uint8_t id) override { return files[id]; }
  Program open_program(std::uint8_t id) override {
    if (!programs.contains(id)) return {};
    program_source = canopen::MemorySource(programs[id]);
    return {.bytes = &program_source, .size = static_cast<std::uint32_t>(programs[id].size())};
  }

 private:
  struct Stored {
    std::uint16_t index;
    std::uint8_t sub;
    std::uint32_t value;
  };
  struct Coming {
    can::Time time;
    unsigned order;
    can::Frame frame;
  };

  void note(const std::string& event) { events.push_back(event); }
  void run_until(can::Time end) {
    for (unsigned steps = 0;; ++steps) {
      ASSERT_LT(steps, 10'000'000U) << "time does not go on";
      const auto coming = std::min_element(bus_.begin(), bus_.end(), [](const Coming& a, const Coming& b) {
        return a.time != b.time ? a.time < b.time : a.order < b.order;
      });
      can::Time next = std::min(node.deadline(), master.deadline());
      if (coming != bus_.end()) next = std::min(next, coming->time);
      if (next > end) break;
      now = std::max(now, next);
      if (coming != bus_.end() && coming->time <= now) {
        const can::Frame frame = coming->frame;
        bus_.erase(coming);
        node.receive(frame, now);
        master.receive(frame, now);
      } else if (node.deadline() <= now) {
        node.tick(now);
      } else {
        master.tick(now);
      }
    }
    now = std::max(now, end);
  }

  std::vector<Stored> stored_;
  std::vector<Coming> bus_;
  std::vector<std::string> sent_;
  unsigned order_ = 0;
};

/// The lines of `lines` that contain `part`.
inline std::vector<std::string> only(const std::vector<std::string>& lines, const std::string& part) {
  std::vector<std::string> result;
  std::copy_if(lines.begin(), lines.end(), std::back_inserter(result),
               [&](const std::string& line) { return line.find(part) != std::string::npos; });
  return result;
}

}  // namespace canopus::manager::test
