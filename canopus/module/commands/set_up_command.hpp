#pragma once
// Commands of the command interface that set up one node or many by SDO: heartbeat, guarding, storing, binding of PDOs
// [FX3U-CAN 7.2, 10.3, 10.4, 10.6, 10.7]. A command is a list of parameters; each entry makes some accesses, one after the
// other, and answers at its own words: 0 = good.
//
//   begin() --next(): an access--> its end --done()--> next() ... --next(): nothing--> over

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "canopus/canopen/dictionary/object_dictionary.hpp"

namespace canopus::module {

/// Words after the command code.
inline constexpr std::size_t command_parameters = 66;
inline constexpr std::uint8_t last_node = 127;
/// In place of a node: the list of parameters is over.
inline constexpr std::uint16_t end_of_list = 0xFFFF;

enum class SetUpKind : std::uint8_t {
  heartbeat_producing,  ///< pairs of node and time: 1017H
  heartbeat_consuming,  ///< a node, pairs of consumed node and time: its 1016H
  slave_assignment,     ///< slave, configuration, guard time, retry factor: own 1F81H, its 100CH and 100DH
  store,                ///< nodes: 1010H
  restore,              ///< nodes: 1011H
  bind_pdos,            ///< pairs of source TPDO and destination RPDO (Mode B)
};

/// What the manuals say otherwise of the same command.
struct SetUpRules {
  /// Bits of the configuration of a slave; others are ignored.
  std::uint8_t assignment_bits = 0xFF;
  /// Of a record of slave assignment with a wrong parameter the words that are not wrong read FFFFH [FX2N-32CAN 8.2.6].
  bool marks_skipped_words = false;
  /// Mode B's default mapping may be requested by the first pair alone [FX2N-32CAN 7.4.6].
  bool default_mapping_first = false;
  /// The COB-ID of a destination that is valid is written over; else it is switched off before [CiA 301 7.5.2.35].
  bool writes_over_cob_ids = false;
  /// A further TPDO of the local node may take a default COB-ID of the local node.
  bool takes_own_cob_ids = false;
};

/// An SDO access; a node of 0 is the local one.
struct SetUpAccess {
  std::uint8_t node = 0;
  bool reads = false;  ///< 32 bits
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t length = 0;  ///< of the value to write, bytes
  std::uint32_t value = 0;
};

class SetUpCommand {
 public:
  using Words = std::span<const std::uint16_t, command_parameters>;
  using Answers = std::span<std::uint16_t, command_parameters>;

  /// `local`: the own node-ID; `pdos`: how many the module has each way. Both spans are used until the command is over;
  /// the answers are 0.
  void begin(SetUpKind kind, const SetUpRules& rules, Words words, Answers answers, std::uint8_t local,
             std::uint16_t pdos) noexcept;
  /// The next access. Nothing: the command is over.
  [[nodiscard]] std::optional<SetUpAccess> next() noexcept;
  /// How the last access ended; `value`: what was read.
  void done(canopen::AbortCode code, std::uint32_t value) noexcept;
  /// Some parameter was answered with something else than 0.
  [[nodiscard]] bool failed() const noexcept;
  /// The entry that next() stands at requires Mode B's default mapping first: to be done before going on. True once.
  [[nodiscard]] bool pop_reset() noexcept;

 private:
  [[nodiscard]] std::uint16_t word(std::size_t offset = 0) const noexcept { return (*words_)[at_ + offset]; }
  void answer(std::size_t offset, std::uint16_t value) noexcept { (*answers_)[at_ + offset] = value; }
  /// The entry is over.
  void next_step() noexcept;
  [[nodiscard]] bool has_entry() const noexcept;
  [[nodiscard]] std::optional<SetUpAccess> first_access() noexcept;
  [[nodiscard]] std::optional<SetUpAccess> heartbeat_access() noexcept;
  [[nodiscard]] std::optional<SetUpAccess> assignment_access() noexcept;
  [[nodiscard]] bool has_wrong_assignment() noexcept;
  [[nodiscard]] std::optional<SetUpAccess> storing_access() noexcept;
  [[nodiscard]] std::optional<SetUpAccess> binding_access() noexcept;
  [[nodiscard]] std::optional<SetUpAccess> extra_tpdo_access() noexcept;
  void assignment_done(canopen::AbortCode code) noexcept;
  void binding_done(canopen::AbortCode code, std::uint32_t value) noexcept;
  [[nodiscard]] std::uint8_t real_node(std::uint16_t written) const noexcept;
  [[nodiscard]] SetUpAccess cob_id_access(std::uint16_t parameter, std::uint16_t first_index) const noexcept;

  SetUpKind kind_ = SetUpKind::store;
  SetUpRules rules_;
  std::optional<Words> words_;
  std::optional<Answers> answers_;
  std::uint8_t local_ = 0;
  std::uint16_t pdos_ = 0;
  std::size_t at_ = 0;  // first word of the entry
  unsigned step_ = 0;   // accesses of the entry that are done
  bool reset_due_ = false;
  std::uint32_t cob_id_ = 0;  // to be written
  bool was_disabled_ = false;
};

}  // namespace canopus::module
