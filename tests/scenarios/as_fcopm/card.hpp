#pragma once
// An AS-FCOPM on a bus whose other nodes are played by the test: slaves that boot, take SDOs and beat, as far as a test
// wants them to.
//
//   FcopmCard card;
//   card.list(3).tx_pdos = {...};        // a slave of the node list, and one that is there
//   card.start();                        // supply on, everything booted
//   card.request({0x0101, 4, 0x0103, ...});  // words of a request, D25000 last
//   card.receive(0x183, {1, 2});         // somebody sends
//   card.sent(0x203);                    // data of all such frames since card.forget()

#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/module/models/as_fcopm/as_fcopm.hpp"
#include "canopus/module/models/as_fcopm/register_table.hpp"

#include "scenarios/scenario.hpp"

namespace canopus::scenario {

namespace fcopm = module::as_fcopm;

/// A slave that the test plays.
struct FcopmSlave {
  using Object = std::pair<std::uint16_t, std::uint8_t>;
  bool is_there = true;
  bool answers = true;  ///< SDOs
  std::map<Object, Bytes> objects{};
  std::map<Object, std::uint32_t> refused{};  ///< writes, with the abort code
  bool beats = true;                          ///< as 1017H was written
  // What became of it.
  std::vector<std::pair<Object, Bytes>> written{};
  std::uint8_t state = 0;  ///< as a heartbeat carries it
  can::Time next_beat = can::never;

  [[nodiscard]] bool was_written(std::uint16_t index, std::uint8_t sub, const Bytes& value) const;
};

struct FcopmFrame {
  can::Time at{};
  can::Frame frame{};
};

class FcopmCard {
 public:
  explicit FcopmCard(const module::Profile& profile = {}) : card(bus, memory, profile) {}

  /// A slave of the node list that is there, and one of the node list alone.
  fcopm::SlaveSetting& list(std::uint8_t node_id);
  fcopm::SlaveSetting& list_only(std::uint8_t node_id);
  /// Downloads `configuration`, supply on, `wait` goes by; frames so far do not matter.
  void start(can::Duration wait = 5s);
  /// Only the supply: initialization has just ended.
  void power_on();
  void run(can::Duration duration);
  /// Frames that the last call has caused.
  void settle_now() { settle(); }
  void receive(std::uint32_t identifier, const Bytes& bytes = {});

  [[nodiscard]] std::uint16_t d(std::uint32_t number) {
    return card.read_register(module::RegisterKind::data, number, now);
  }
  [[nodiscard]] std::uint16_t sr(std::uint32_t number) {
    return card.read_register(module::RegisterKind::special, number, now);
  }
  void set_d(std::uint32_t number, std::uint16_t value) {
    card.write_register(module::RegisterKind::data, number, value, now);
  }
  /// All words of a request, the first one last; then `wait`.
  void request(const Words& words, can::Duration wait = 2ms);
  /// D24000 to D24000 + count - 1.
  [[nodiscard]] Words response(std::size_t count);
  /// Code and flag of a node.
  [[nodiscard]] std::uint16_t code(std::uint8_t node) { return sr(829U + node); }
  [[nodiscard]] bool is_abnormal(std::uint8_t node) {
    return (sr(826U + (node - 1U) / 16) >> (node - 1U) % 16 & 1U) != 0;
  }

  void forget() { frames.clear(); }
  [[nodiscard]] std::vector<Bytes> sent(std::uint32_t identifier) const;
  [[nodiscard]] std::vector<can::Time> times(std::uint32_t identifier) const;

  FreeBus bus;
  RamMemory memory;
  fcopm::AsFcopm card;
  fcopm::Configuration configuration{};
  std::map<std::uint8_t, FcopmSlave> slaves;
  std::vector<FcopmFrame> frames;  ///< sent by the card
  can::Time now{};

 private:
  void settle();
  void receive(const can::Frame& frame);
  void answer(std::uint8_t node_id, FcopmSlave& slave, const can::Frame& frame);
  void beat(std::uint8_t node_id, FcopmSlave& slave);
};

/// One PDO of a slave with objects of so many bits each at 2000H, 2001H ... :00.
[[nodiscard]] fcopm::SlavePdo fcopm_pdo(std::uint16_t number, std::uint8_t type,
                                        const std::vector<int>& bits);

}  // namespace canopus::scenario
