// The CiA 301 stack on its own: how long a frame takes through a node, with no bus in between.

#include <memory>

#include <benchmark/benchmark.h>

#include "canopus/canopen/node.hpp"
#include "canopus/canopen/sdo_client.hpp"

namespace {

using namespace canopus;

/// Hands every frame straight to another node (or to nobody).
struct Wire final : can::Sink {
  can::Participant* peer = nullptr;
  canopen::SdoClient* client = nullptr;
  can::Time now{};
  bool send(const can::Frame& frame) override {
    if (peer != nullptr) peer->receive(frame, now);
    if (client != nullptr) client->receive(frame, now);
    return true;
  }
};

/// A slave with four RPDOs and four TPDOs of four U16 each.
std::shared_ptr<const canopen::DictionaryDescription> slave() {
  using canopen::DataType;
  canopen::DictionaryBuilder builder;
  builder.variable(0x1000,
                   {.name = "Device type", .type = DataType::unsigned32, .value = {0x91, 1, 0x0F, 0}});
  builder.variable(0x1001, {.name = "Error register", .type = DataType::unsigned8});
  builder.variable(0x1005, {.name = "COB-ID SYNC", .type = DataType::unsigned32, .value = {0x80}});
  builder.variable(0x1017, {.name = "Producer heartbeat time", .type = DataType::unsigned16});
  builder.uniform(0x6000, canopen::ObjectCode::array, "Inputs", 16,
                  {.name = "Input", .type = DataType::unsigned16, .tpdo_mappable = true});
  builder.uniform(0x6200, canopen::ObjectCode::array, "Outputs", 16,
                  {.name = "Output", .type = DataType::unsigned16, .rpdo_mappable = true});
  for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
    const auto communication = [&](std::uint16_t base, std::uint32_t cob_id, std::uint8_t type) {
      const auto index = static_cast<std::uint16_t>(base + pdo);
      builder.object(index, canopen::ObjectCode::record, "PDO communication");
      builder.sub(index, 1,
                  {.name = "COB-ID",
                   .type = DataType::unsigned32,
                   .value = canopen::little_endian(cob_id + 0x100U * pdo, 4),
                   .adds_node_id = true});
      builder.sub(index, 2, {.name = "Type", .type = DataType::unsigned8, .value = {type}});
    };
    const auto mapping = [&](std::uint16_t base, std::uint32_t object) {
      const auto index = static_cast<std::uint16_t>(base + pdo);
      builder.object(index, canopen::ObjectCode::record, "PDO mapping");
      builder.sub(index, 0, {.name = "Entries", .type = DataType::unsigned8, .value = {4}});
      for (std::uint8_t i = 1; i <= 4; ++i) {
        const std::uint32_t entry = object << 16 | (4U * pdo + i) << 8 | 16;
        builder.sub(
            index, i,
            {.name = "Entry", .type = DataType::unsigned32, .value = canopen::little_endian(entry, 4)});
      }
    };
    communication(0x1400, 0x200, 0xFE);
    mapping(0x1600, 0x6200);
    communication(0x1800, 0x180, 1);
    mapping(0x1A00, 0x6000);
  }
  return builder.build();
}

/// One received PDO of 8 bytes, from the frame to four words of the process image.
void rpdo_to_process_image(benchmark::State& state) {
  Wire wire;
  canopen::Node node(slave(), 5, wire);
  node.power_on(can::Time{});
  node.receive(can::data_frame(0x000, {0x01, 0x05}), can::Time{});
  can::Frame frame = can::data_frame(0x205, {1, 2, 3, 4, 5, 6, 7, 8});
  can::Time now{};
  for (auto _ : state) {
    now += std::chrono::microseconds(100);
    frame.data[0] = static_cast<std::uint8_t>(frame.data[0] + 1);
    node.receive(frame, now);
    benchmark::DoNotOptimize(node.dictionary().block().data());
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(rpdo_to_process_image);

/// SYNC, and four TPDOs of 8 bytes each go out.
void sync_to_four_tpdos(benchmark::State& state) {
  Wire wire;
  canopen::Node node(slave(), 5, wire);
  node.power_on(can::Time{});
  node.receive(can::data_frame(0x000, {0x01, 0x05}), can::Time{});
  const can::Frame sync = can::data_frame(0x080);
  can::Time now{};
  for (auto _ : state) {
    now += std::chrono::milliseconds(1);
    node.receive(sync, now);
    if (node.deadline() <= now) node.tick(now);
  }
  state.SetItemsProcessed(state.iterations() * 5);
}
BENCHMARK(sync_to_four_tpdos);

/// Client and server in one process: request and answer of an expedited upload are one round trip.
void sdo_expedited_upload(benchmark::State& state) {
  Wire to_server;
  Wire to_client;
  canopen::Node node(slave(), 5, to_client);
  canopen::SdoClient client(to_server);
  struct User final : canopen::SdoClientUser {
    std::uint64_t finished = 0;
    void sdo_finished(canopen::SdoClient& done, can::Time) override {
      finished += done.abort_code() == canopen::AbortCode::none ? 1 : 0;
    }
  } user;
  client.set_server(5);
  node.power_on(can::Time{});
  to_server.peer = &node;
  to_client.client = &client;
  can::Time now{};
  for (auto _ : state) {
    now += std::chrono::microseconds(100);
    to_server.now = to_client.now = now;
    if (!client.upload(0x1000, 0, user, now)) state.SkipWithError("the client is busy");
  }
  if (user.finished != static_cast<std::uint64_t>(state.iterations()))
    state.SkipWithError("a transfer failed");
  state.SetItemsProcessed(state.iterations());  // round trips
}
BENCHMARK(sdo_expedited_upload);

}  // namespace

BENCHMARK_MAIN();
