// A long run with random faults, in virtual time: a master and 126 slaves at 1 Mbit/s and about 90 % load,
// SDO transfers all the while. It ends with an error when
//   - a transfer that reported success did not do what it said,
//   - a node is not Operational again within a bounded time after the faults have stopped,
//   - the heap has grown between the first minute and the end.
//
// usage: soak [--minutes 60] [--seed 1]

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <malloc.h>

#include "canopus/can/timeline.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/manager/nmt/master_node.hpp"
#include "canopus/sim/bus/bus.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;
using canopen::AbortCode;
using canopen::DataType;

constexpr std::uint8_t master_id = 127;
constexpr std::uint8_t slave_count = 126;
constexpr std::uint16_t scratch_object = 0x2000;  // :01 UNSIGNED32, :02 text for segmented transfers
constexpr can::Duration recovery_bound = 20s;
// An overloaded bus holds answers back for as long as a fault lasts. SDO has no transaction numbers: the late
// answer to a transfer that timed out looks like the answer to the next one of the same object, so a careful
// user waits.
constexpr can::Duration late_answers = 5s;

/// A slave that sends one TPDO of 8 bytes every `period` ms.
std::shared_ptr<const canopen::DictionaryDescription> slave_description(std::uint16_t period) {
  canopen::DictionaryBuilder builder;
  builder.variable(0x1000, {.name = "Device type",
                            .type = DataType::unsigned32,
                            .access = canopen::Access::read_only,
                            .value = {0x91, 0x01}});
  builder.variable(
      0x1001, {.name = "Error register", .type = DataType::unsigned8, .access = canopen::Access::read_only});
  builder.variable(0x1017, {.name = "Producer heartbeat time",
                            .type = DataType::unsigned16,
                            .value = canopen::little_endian(1000, 2)});
  builder.object(0x1800, canopen::ObjectCode::record, "TPDO communication");
  builder.sub(0x1800, 1,
              {.name = "COB-ID",
               .type = DataType::unsigned32,
               .value = canopen::little_endian(0x180, 4),
               .adds_node_id = true});
  builder.sub(0x1800, 2, {.name = "Type", .type = DataType::unsigned8, .value = {0xFF}});
  builder.sub(
      0x1800, 5,
      {.name = "Event timer", .type = DataType::unsigned16, .value = canopen::little_endian(period, 2)});
  builder.object(0x1A00, canopen::ObjectCode::record, "TPDO mapping");
  builder.sub(0x1A00, 0, {.name = "Entries", .type = DataType::unsigned8, .value = {2}});
  for (std::uint8_t i = 1; i <= 2; ++i) {
    builder.sub(0x1A00, i,
                {.name = "Entry",
                 .type = DataType::unsigned32,
                 .value = canopen::little_endian(0x6000'0020U | static_cast<unsigned>(i) << 8, 4)});
  }
  builder.uniform(0x6000, canopen::ObjectCode::array, "Inputs", 2,
                  {.name = "Input",
                   .type = DataType::unsigned32,
                   .value = {0x55, 0xAA, 0x55, 0xAA},
                   .tpdo_mappable = true});
  builder.object(scratch_object, canopen::ObjectCode::record, "Scratch");
  builder.sub(scratch_object, 1, {.name = "Number", .type = DataType::unsigned32});
  builder.sub(scratch_object, 2, {.name = "Text", .type = DataType::visible_string});
  return builder.build();
}

std::shared_ptr<const canopen::DictionaryDescription> master_description() {
  canopen::DictionaryBuilder builder;
  builder.variable(
      0x1000, {.name = "Device type", .type = DataType::unsigned32, .access = canopen::Access::read_only});
  builder.variable(
      0x1001, {.name = "Error register", .type = DataType::unsigned8, .access = canopen::Access::read_only});
  builder.object(0x1016, canopen::ObjectCode::array, "Consumer heartbeat time");
  builder.object(0x1F81, canopen::ObjectCode::array, "NMT slave assignment");
  for (std::uint8_t node = 1; node <= slave_count; ++node) {
    builder.sub(0x1016, node,
                {.name = "Entry",
                 .type = DataType::unsigned32,
                 .value = canopen::little_endian(static_cast<std::uint64_t>(node) << 16 | 3000, 4)});
    builder.sub(0x1F81, node, {.name = "Entry", .type = DataType::unsigned32, .value = {0x05}});
  }
  builder.variable(0x1F80, {.name = "NMT start-up", .type = DataType::unsigned32, .value = {0x01}});
  return builder.build();
}

struct Slave final : can::Participant {
  Slave(std::shared_ptr<const canopen::DictionaryDescription> description, std::uint8_t node_id,
        sim::Port& port)
      : node(std::move(description), node_id, port) {
    alarm().add_part(node.alarm());
  }
  canopen::Node node;
  void receive(const can::Frame& frame, can::Time now) override { node.receive(frame, now); }
  void tick(can::Time now) override { node.tick(now); }
};

/// The master, and a user that keeps a few SDO transfers going and checks each against the slave's own
/// memory.
class Master final : public manager::MasterNode,
                     public manager::MasterListener,
                     public canopen::SdoClientListener {
 public:
  Master(sim::Port& port, std::vector<std::unique_ptr<Slave>>& slaves, std::uint64_t seed)
      : MasterNode(master_description(), master_id, port), slaves_(slaves), random_(seed) {
    master().set_listener(this);
    alarm().add_part(next_job_);
    for (Job& job : jobs_) {
      job.client = std::make_unique<canopen::SdoClient>(port);
      alarm().add_part(job.client->alarm());
    }
  }
  void power_on(can::Time now) {
    MasterNode::power_on(now);
    next_job_ = now + 5s;
  }

  bool sdo_channel_free(std::uint8_t id) override {
    return std::ranges::none_of(jobs_, [&](const Job& job) { return job.client->busy() && job.node == id; });
  }

  void receive(const can::Frame& frame, can::Time now) override {
    MasterNode::receive(frame, now);
    for (Job& job : jobs_) job.client->receive(frame, now);
  }
  void tick(can::Time now) override {
    MasterNode::tick(now);
    for (Job& job : jobs_) {
      if (job.client->deadline() <= now) job.client->tick(now);
    }
    if (next_job_ <= now) start_jobs(now);
  }

  void sdo_finished(canopen::SdoClient& client, can::Time now) override {
    Job& job = *std::ranges::find_if(jobs_, [&](const Job& j) { return j.client.get() == &client; });
    if (client.abort_code() != AbortCode::none) {
      ++failed;
      ask_again_[job.node] = now + late_answers;
      return;
    }
    ++succeeded;
    // What the slave really holds, looked up behind the protocol's back.
    const auto& dictionary = slaves_[job.node - 1U]->node.dictionary();
    const auto held = dictionary.bytes(*dictionary.find(scratch_object, job.sub));
    const auto claimed = job.is_download ? std::span<const std::uint8_t>(job.bytes) : client.data();
    if (std::ranges::equal(held, claimed)) return;
    ++lied;
    std::printf("at %.6f s the %s of node %u, %04X:%02X, did not do what it said\n", can::seconds(now),
                job.is_download ? "download" : "upload", job.node, scratch_object, job.sub);
  }

  std::uint64_t succeeded = 0;
  std::uint64_t failed = 0;
  std::uint64_t lied = 0;

 private:
  struct Job {
    std::unique_ptr<canopen::SdoClient> client;
    std::uint8_t node = 0;
    std::uint8_t sub = 1;
    bool is_download = false;
    std::vector<std::uint8_t> bytes;
  };

  void start_jobs(can::Time now) {
    next_job_ = now + 20ms;
    for (Job& job : jobs_) {
      if (job.client->busy()) continue;
      const auto id = static_cast<std::uint8_t>(random_() % slave_count + 1);
      if (master().sdo_channel_busy(id) || !sdo_channel_free(id) || now < ask_again_[id]) continue;
      job.node = id;
      job.sub = static_cast<std::uint8_t>(random_() % 4 == 0 ? 2 : 1);
      job.is_download = random_() % 2 == 0;
      job.client->set_server(id);
      if (!job.is_download) {
        job.client->upload(scratch_object, job.sub, *this, now);
        continue;
      }
      job.bytes.resize(job.sub == 1 ? 4 : 5 + random_() % 60);
      for (std::uint8_t& byte : job.bytes) byte = static_cast<std::uint8_t>('A' + random_() % 26);
      job.client->download(scratch_object, job.sub, job.bytes, *this, now);
    }
  }

  std::vector<std::unique_ptr<Slave>>& slaves_;
  std::mt19937_64 random_;
  std::array<Job, 4> jobs_;
  std::array<can::Time, 128> ask_again_{};
  can::Alarm next_job_;
};

std::vector<sim::Fault> random_faults(std::mt19937_64& random, can::Time from, can::Time until) {
  std::vector<sim::Fault> faults;
  const auto port = [&] { return "node" + std::to_string(random() % slave_count + 1); };
  while (from < until) {
    sim::Fault fault;
    fault.from = from;
    fault.until = std::min(until, from + std::chrono::milliseconds(100 + random() % 3000));
    switch (random() % 8) {
      case 0:
        fault.kind = sim::FaultKind::drop;
        fault.probability = 0.02;
        break;
      case 1:
        fault.kind = sim::FaultKind::corrupt;
        fault.probability = 0.005;
        break;
      case 2:
        fault.kind = sim::FaultKind::duplicate;
        fault.probability = 0.01;
        break;
      case 3:
        fault.kind = sim::FaultKind::delay;
        fault.probability = 0.05;
        fault.delay = std::chrono::microseconds(1 + random() % 20000);
        break;
      case 4:
        fault.kind = sim::FaultKind::babble;
        fault.ports = {port()};
        // An identifier that wins against everything and belongs to nobody: a babbler that forges the frames
        // of a service could make any protocol lie.
        fault.frame =
            can::data_frame(static_cast<std::uint32_t>(0x010 + random() % 0x40), {1, 2, 3, 4, 5, 6, 7, 8});
        fault.interval = 500us;
        break;
      case 5:
        fault.kind = sim::FaultKind::jam;
        fault.ports = {port()};
        break;
      case 6:
        fault.kind = sim::FaultKind::cut;
        fault.ports = {port(), port(), port()};
        break;
      default:
        fault.kind = sim::FaultKind::drop;
        fault.probability = 1.0;
        fault.receiver = port();
        break;
    }
    faults.push_back(fault);
    from += std::chrono::milliseconds(2000 + random() % 6000);
  }
  return faults;
}

int run(long minutes, std::uint64_t seed) {
  can::Timeline timeline;
  sim::Bus bus("line1", 1'000'000, timeline);
  std::vector<std::unique_ptr<Slave>> slaves;
  const auto description =
      slave_description(18);  // 126 frames of about 125 bits every 18 ms, and the rest: 0.9 of the bus
  for (std::uint8_t id = 1; id <= slave_count; ++id) {
    sim::Port& port = bus.add_port("node" + std::to_string(id));
    slaves.push_back(std::make_unique<Slave>(description, id, port));
    timeline.add(*slaves.back());
    port.connect(*slaves.back());
  }
  sim::Port& port = bus.add_port("master");
  Master master(port, slaves, seed);
  timeline.add(master);
  port.connect(master);
  for (const auto& slave : slaves) slave->node.power_on(timeline.now());
  master.power_on(timeline.now());

  std::mt19937_64 random(seed);
  const can::Time end = can::Time{std::chrono::minutes(minutes)};
  const can::Time quiet = end - std::min<can::Duration>(60s, std::chrono::minutes(minutes) / 4);
  const auto faults = random_faults(random, can::Time{10s}, quiet);
  if (const auto set = bus.set_faults(faults, seed); !set) {
    std::fprintf(stderr, "soak: %s\n", set.error().c_str());
    return 2;
  }

  std::size_t heap_after_first_minute = 0;
  can::Time all_back = can::never;
  for (can::Time now = timeline.now(); now < end;) {
    now += 100ms;
    timeline.run_until(now);
    const bool all_operational = std::ranges::all_of(
        slaves, [](const auto& s) { return s->node.state() == canopen::NmtState::operational; });
    if (now < quiet || !all_operational) {
      all_back = can::never;
    } else if (all_back == can::never) {
      all_back = now;
    }
    if (heap_after_first_minute == 0 && now >= can::Time{60s}) heap_after_first_minute = mallinfo2().uordblks;
    if (now.time_since_epoch() % 60s == 0s) {
      std::printf(
          "%5.0f min  load %.2f  %llu frames  %llu error frames  SDO %llu good, %llu failed\n",
          can::seconds(now) / 60, bus.load(now).now, static_cast<unsigned long long>(bus.load(now).frames),
          static_cast<unsigned long long>(bus.load(now).error_frames),
          static_cast<unsigned long long>(master.succeeded), static_cast<unsigned long long>(master.failed));
      std::fflush(stdout);
    }
  }

  const std::size_t heap = mallinfo2().uordblks;
  int verdict = 0;
  const auto judge = [&](bool good, const char* what) {
    std::printf("%s  %s\n", good ? "ok  " : "FAIL", what);
    if (!good) verdict = 1;
  };
  std::printf("%zu faults, seed %llu\n", faults.size(), static_cast<unsigned long long>(seed));
  std::printf("%llu transfers reported success, %llu failed, %llu did not do what they said\n",
              static_cast<unsigned long long>(master.succeeded),
              static_cast<unsigned long long>(master.failed), static_cast<unsigned long long>(master.lied));
  judge(master.succeeded > 1000, "transfers went through all the while");
  judge(master.lied == 0, "no transfer that reported success was lost");
  if (all_back != can::never)
    std::printf("all nodes Operational %.1f s after the last fault\n",
                can::seconds(can::Time{all_back - quiet}));
  judge(all_back != can::never && all_back - quiet <= recovery_bound, "all nodes Operational again in time");
  std::printf("heap: %zu bytes after a minute, %zu at the end\n", heap_after_first_minute, heap);
  judge(heap <= heap_after_first_minute + 64 * 1024, "the heap did not grow");
  return verdict;
}

}  // namespace

int main(int argc, char** argv) {
  long minutes = 60;
  std::uint64_t seed = 1;
  for (int i = 1; i < argc; i += 2) {
    if (i + 1 < argc && std::strcmp(argv[i], "--minutes") == 0) {
      minutes = std::max(1L, std::strtol(argv[i + 1], nullptr, 10));
    } else if (i + 1 < argc && std::strcmp(argv[i], "--seed") == 0) {
      seed = std::strtoull(argv[i + 1], nullptr, 10);
    } else {
      std::fprintf(stderr, "usage: soak [--minutes 60] [--seed 1]\n");
      return 2;
    }
  }
  return run(minutes, seed);
}
