// The master on a bus that is a function call: a frame is heard by all others before send() returns, and so
// are their answers, in the middle of whatever the master does. Whoever embeds the stack may have such a bus.

#include <gmock/gmock.h>

#include "canopus/manager/boot/concise_dcf.hpp"

#include "master_bench.hpp"

namespace canopus::manager::test::function_call_bus_test {
namespace {

using ::testing::ElementsAre;

std::shared_ptr<const canopen::DictionaryDescription> slave_objects() {
  using canopen::Access;
  using canopen::DataType;
  canopen::DictionaryBuilder builder;
  builder.variable(0x1000, {.name = "Device type", .access = Access::read_only, .value = {0x91, 1, 0x0F, 0}});
  builder.variable(0x1017, {.name = "Producer heartbeat time", .type = DataType::unsigned16});
  builder.uniform(0x1018, canopen::ObjectCode::record, "Identity", 4,
                  {.name = "Identity", .access = Access::read_only, .value = {7, 0, 0, 0}});
  builder.uniform(0x2000, canopen::ObjectCode::array, "Parameters", 100, {.name = "Parameter"});
  builder.variable(0x2100, {.name = "Table", .type = DataType::domain});
  return builder.build();
}

class FunctionCallBus {
 public:
  class Port final : public can::Sink {
   public:
    explicit Port(FunctionCallBus& bus) : bus_(&bus) {}
    bool send(const can::Frame& frame) override {
      bus_->deliver(frame, owner);
      return true;
    }
    can::Participant* owner = nullptr;

   private:
    FunctionCallBus* bus_;
  };
  void add(can::Participant& participant, Port& port) {
    port.owner = &participant;
    participants.push_back(&participant);
  }
  void deliver(const can::Frame& frame, const can::Participant* from) {
    deepest = std::max(deepest, ++depth_);
    sent.push_back(frame);
    for (can::Participant* each : participants) {
      if (each != from) each->receive(frame, now);
    }
    --depth_;
  }
  void run_until(can::Time end) {
    for (unsigned steps = 0;; ++steps) {
      ASSERT_LT(steps, 1'000'000U) << "time does not go on";
      const auto next = std::ranges::min_element(participants, {}, &can::Participant::deadline);
      if ((*next)->deadline() > end) break;
      now = std::max(now, (*next)->deadline());
      (*next)->tick(now);
    }
    now = end;
  }
  [[nodiscard]] auto count(std::uint32_t identifier, std::initializer_list<std::uint8_t> bytes) const {
    return std::ranges::count(sent, can::data_frame(identifier, bytes));
  }

  can::Time now{};
  std::vector<can::Participant*> participants;
  std::vector<can::Frame> sent;
  int deepest = 0;

 private:
  int depth_ = 0;
};

class HeartbeatTeller final : public ConfiguredMaster {
 public:
  using ConfiguredMaster::ConfiguredMaster;
  std::function<void(std::uint8_t, can::Time)> on_heartbeat;

 private:
  void heartbeat_received(std::uint8_t id, NmtState state, can::Time now) override {
    ConfiguredMaster::heartbeat_received(id, state, now);
    if (on_heartbeat) on_heartbeat(id, now);
  }
};

class FunctionCallMaster : public ::testing::Test, public MasterListener {
 public:
  struct Slave {
    Slave(std::uint8_t id, FunctionCallBus& bus) : port(bus), node(slave_objects(), id, port) {
      bus.add(node, port);
    }
    FunctionCallBus::Port port;
    canopen::Node node;
  };
  FunctionCallMaster() : port(bus), seat(port), node(seat.node()), master(seat.master()) {
    master.set_listener(this);
    bus.add(seat, port);
    seat.stored[{0x1F80, 0}] = 0x01;
    for (std::uint8_t id = 2; id <= 4; ++id) {
      slaves.emplace_back(id, bus);
      seat.stored[{0x1F81, id}] = 0x0D;
      seat.stored[{0x1F84, id}] = 0x000F0191;
      seat.stored[{0x1F85, id}] = 7;
    }
  }
  void switch_on() {
    for (Slave& slave : slaves) slave.node.power_on(bus.now);
    bus.run_until(bus.now + 100ms);
    bus.sent.clear();
    node.power_on(bus.now);
  }
  void expect_operational() {
    EXPECT_EQ(node.state(), NmtState::operational);
    for (Slave& slave : slaves) EXPECT_EQ(slave.node.state(), NmtState::operational);
    for (std::uint8_t id = 2; id <= 4; ++id) EXPECT_EQ(master.node_state(id), 5) << int{id};
  }

  void slave_booted(std::uint8_t id, can::Time now) override {
    events.push_back("booted " + std::to_string(id));
    if (on_booted) on_booted(id, now);
  }
  void slave_failed(std::uint8_t id, BootError, can::Time) override {
    events.push_back("failed " + std::to_string(id));
  }
  void start_up_finished(can::Time) override { events.push_back("finished"); }

  FunctionCallBus bus;
  FunctionCallBus::Port port;
  HeartbeatTeller seat;
  canopen::Node& node;
  NmtMaster& master;
  std::list<Slave> slaves;
  std::vector<std::string> events;
  std::function<void(std::uint8_t, can::Time)> on_booted;
};

TEST_F(FunctionCallMaster, SlavesAreBootedAndStarted_EachOnce) {
  switch_on();
  bus.run_until(bus.now + 3s);
  expect_operational();
  EXPECT_THAT(events, ElementsAre("booted 2", "booted 3", "booted 4", "finished"));
  EXPECT_EQ(bus.count(0x000, {0x82, 0x00}), 1);
  for (std::uint8_t id = 2; id <= 4; ++id) {
    EXPECT_EQ(bus.count(0x000, {0x01, id}), 1) << int{id};
    EXPECT_EQ(bus.count(0x600U + id, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}), 1) << "device type, asked once";
  }
}

TEST_F(FunctionCallMaster, ConfigurationInSegmentsAndBlocks_Arrives) {
  std::vector<std::uint8_t> table(5000);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<std::uint8_t>(i * 7);
  for (std::uint8_t id = 2; id <= 4; ++id) {
    seat.files[id] =
        ConciseDcfWriter().add(0x1017, 0, 100, 2).add(0x2100, 0, table).add(0x2000, 9, id, 4).file();
  }
  for (const unsigned block_from : {0U, 100U}) {
    master.options().block_from = block_from;
    switch_on();
    bus.run_until(bus.now + 3s);
    expect_operational();
    for (Slave& slave : slaves) {
      const auto& d = slave.node.dictionary();
      EXPECT_TRUE(std::ranges::equal(d.bytes(*d.find(0x2100, 0)), table));
      EXPECT_EQ(d.get<std::uint32_t>(0x2000, 9), slave.node.node_id());
    }
    node.command(canopen::NmtCommand::reset_node, bus.now);
  }
}

TEST_F(FunctionCallMaster, TransfersMayBeStartedFromAnyCallback_OneFromTheEndOfTheOther) {
  std::map<std::uint8_t, std::vector<std::uint32_t>> values;
  std::function<void(std::uint8_t, std::uint8_t, can::Time)> read_next;
  read_next = [&](std::uint8_t id, std::uint8_t sub, can::Time now) {
    const auto done = [&, sub](const SdoResult& result, can::Time then) {
      ASSERT_EQ(result.abort_code, canopen::AbortCode::none);
      values[result.node_id].push_back(result.data.empty() ? 0U : result.data[0]);
      if (values[result.node_id].size() < 1000) {
        read_next(result.node_id, static_cast<std::uint8_t>(sub % 100 + 1), then);
      }
    };
    EXPECT_EQ(master.read_object(id, 0x2000, sub, done, now), canopen::AbortCode::none);
  };
  on_booted = [&](std::uint8_t id, can::Time now) { read_next(id, 1, now); };
  switch_on();
  for (Slave& slave : slaves) {
    for (unsigned sub = 1; sub <= 100; ++sub) {
      slave.node.dictionary().set(0x2000, static_cast<std::uint8_t>(sub), sub);
    }
  }
  bus.run_until(bus.now + 3s);
  expect_operational();
  for (std::uint8_t id = 2; id <= 4; ++id) {
    ASSERT_EQ(values[id].size(), 1000U) << int{id};
    EXPECT_EQ(values[id][998], 99U);
  }
  EXPECT_LT(bus.deepest, 8) << "a thousand transfers one inside the other";
}

TEST_F(FunctionCallMaster, CommandFromInsideAnother_GoesOutAfterIt_EachOnce) {
  for (std::uint8_t id = 2; id <= 4; ++id) {
    seat.stored[{0x1016, id}] = std::uint32_t{id} << 16 | 300;
    seat.files[id] = ConciseDcfWriter().add(0x1017, 0, 100, 2).file();
  }
  seat.stored[{0x102A, 0}] = 100;  // 10 ms between commands
  switch_on();
  bus.run_until(bus.now + 3s);
  expect_operational();
  bus.sent.clear();
  bool asked = false;
  seat.on_heartbeat = [&](std::uint8_t id,
                          can::Time now) {  // the boot-up message of node 3, inside its reset
    if (id != 3 || asked) return;
    asked = true;
    EXPECT_EQ(master.request_nmt(4, node_state::stopped, now), canopen::AbortCode::none);
  };
  EXPECT_EQ(master.request_nmt(3, 6, bus.now), canopen::AbortCode::none);
  EXPECT_TRUE(asked);
  bus.run_until(bus.now + 9ms);
  EXPECT_EQ(bus.count(0x000, {0x02, 0x04}), 0) << "102AH";
  bus.run_until(bus.now + 1s);
  EXPECT_EQ(bus.count(0x000, {0x81, 0x03}), 1);
  EXPECT_EQ(bus.count(0x000, {0x02, 0x04}), 1);
  EXPECT_EQ(master.node_state(3), 5);
  EXPECT_EQ(master.node_state(4), node_state::stopped);
}

TEST_F(FunctionCallMaster, LostSlave_IsResetAndComesBack) {
  for (std::uint8_t id = 2; id <= 4; ++id) {
    seat.stored[{0x1016, id}] = std::uint32_t{id} << 16 | 300;
    seat.files[id] = ConciseDcfWriter().add(0x1017, 0, 100, 2).file();
  }
  switch_on();
  bus.run_until(bus.now + 3s);
  events.clear();
  // Its heartbeat is switched off from outside: the master resets it, and its answer comes from inside.
  canopen::Node& lost = std::next(slaves.begin())->node;
  ASSERT_EQ(lost.dictionary().write(0x1017, 0, canopen::little_endian(0, 2), bus.now),
            canopen::AbortCode::none);
  bus.run_until(bus.now + 5s);
  expect_operational();
  EXPECT_THAT(events, ElementsAre("booted 3"));
}

TEST_F(FunctionCallMaster, GuardedSlave_AnswersFromInside) {
  seat.stored[{0x1F81, 3}] = 0x0064030D;
  switch_on();
  bus.run_until(bus.now + 10s);
  expect_operational();
  EXPECT_EQ(master.error_control(3), error_control::guarding_active);
  EXPECT_EQ(std::ranges::count(events, "booted 3"), 1);
}

}  // namespace
}  // namespace canopus::manager::test::function_call_bus_test
