#include "canopus/module/commands/set_up_command.hpp"

#include <algorithm>
#include <utility>

#include "canopus/module/interface/word_bytes.hpp"

namespace canopus::module {

namespace {

constexpr std::uint16_t bad = 0xFFFF;  // as an answer

constexpr std::uint32_t save_signature = 0x6576'6173U;
constexpr std::uint32_t load_signature = 0x6461'6F6CU;

constexpr std::uint16_t first_rpdo = 0x1400;
constexpr std::uint16_t first_tpdo = 0x1800;
constexpr std::uint32_t invalid_bit = 0x8000'0000U;
constexpr std::uint32_t identifier_bits = 0x1FFF'FFFFU;
constexpr std::uint16_t local_tpdo = 0x80;  // in place of a destination node: a further TPDO of the local one
constexpr unsigned default_tpdos = 4;

bool no_response(canopen::AbortCode code) {
  return code == canopen::AbortCode::timed_out || code == canopen::AbortCode{0x5000'0000};
}

}  // namespace

void SetUpCommand::begin(SetUpKind kind, const SetUpRules& rules, Words words, Answers answers,
                         std::uint8_t local, std::uint16_t pdos) noexcept {
  kind_ = kind;
  rules_ = rules;
  words_.emplace(words);
  answers_.emplace(answers);
  local_ = local;
  pdos_ = pdos;
  at_ = kind == SetUpKind::heartbeat_consuming ? 1 : 0;
  step_ = 0;
  reset_due_ = false;
}

bool SetUpCommand::failed() const noexcept {
  return std::ranges::any_of(*answers_, [](std::uint16_t word) { return word != 0; });
}

bool SetUpCommand::pop_reset() noexcept { return std::exchange(reset_due_, false); }

std::uint8_t SetUpCommand::real_node(std::uint16_t written) const noexcept {
  return written == 0 ? local_ : static_cast<std::uint8_t>(written);
}

void SetUpCommand::next_step() noexcept {
  step_ = 0;
  switch (kind_) {
    case SetUpKind::heartbeat_producing:
    case SetUpKind::heartbeat_consuming:
    case SetUpKind::bind_pdos: at_ += 2; break;
    case SetUpKind::slave_assignment: at_ += 4; break;
    case SetUpKind::store:
    case SetUpKind::restore: at_ += 1; break;
  }
}

bool SetUpCommand::has_entry() const noexcept {
  switch (kind_) {
    case SetUpKind::heartbeat_consuming: return at_ + 2 < command_parameters && word() != end_of_list;
    case SetUpKind::heartbeat_producing:
    case SetUpKind::bind_pdos: return at_ + 1 < command_parameters && word() != end_of_list;
    case SetUpKind::slave_assignment: return at_ + 3 < command_parameters - 2 && word() != end_of_list;
    case SetUpKind::store:
    case SetUpKind::restore:  // the first node must be one [FX3U-CAN 10.6]
      return at_ < command_parameters && (at_ == 0 || word() != end_of_list);
  }
  return false;
}

std::optional<SetUpAccess> SetUpCommand::next() noexcept {
  while (has_entry()) {
    if (auto access = first_access()) return access;
    if (reset_due_) return std::nullopt;  // the caller comes again
  }
  return std::nullopt;
}

// The entry's access at step_; nothing, and the next entry, when it has no more, or is wrong.
std::optional<SetUpAccess> SetUpCommand::first_access() noexcept {
  switch (kind_) {
    case SetUpKind::heartbeat_producing:
    case SetUpKind::heartbeat_consuming: return heartbeat_access();
    case SetUpKind::slave_assignment: return assignment_access();
    case SetUpKind::store:
    case SetUpKind::restore: return storing_access();
    case SetUpKind::bind_pdos: return binding_access();
  }
  return std::nullopt;
}

std::optional<SetUpAccess> SetUpCommand::heartbeat_access() noexcept {
  if (kind_ == SetUpKind::heartbeat_consuming && words_->front() > last_node) {
    answers_->front() = bad;
    at_ = command_parameters;
    return std::nullopt;
  }
  if (word() > last_node) {
    answer(0, bad);
    next_step();
    return std::nullopt;
  }
  if (kind_ == SetUpKind::heartbeat_producing) {
    return SetUpAccess{
        .node = low_byte(word()), .reads = false, .index = 0x1017, .sub = 0, .length = 2, .value = word(1)};
  }
  const auto sub = static_cast<std::uint8_t>((at_ - 1) / 2 + 1);
  return SetUpAccess{.node = low_byte(words_->front()),
                     .reads = false,
                     .index = 0x1016,
                     .sub = sub,
                     .length = 4,
                     .value = std::uint32_t{word()} << 16 | word(1)};
}

// A wrong parameter is answered with itself.
bool SetUpCommand::has_wrong_assignment() noexcept {
  constexpr std::uint16_t highest_factor = 0xFF;
  const bool bad_slave = word() == 0 || word() > last_node;
  const bool bad_factor = word(3) > highest_factor;
  if (!bad_slave && !bad_factor) return false;
  if (rules_.marks_skipped_words) {
    for (const std::size_t i : {1U, 2U, 3U}) answer(i, bad);
  }
  if (bad_slave) answer(0, word() == 0 ? bad : word());
  if (bad_factor) answer(3, word(3));
  return true;
}

std::optional<SetUpAccess> SetUpCommand::assignment_access() noexcept {
  if (has_wrong_assignment()) {
    next_step();
    return std::nullopt;
  }
  const std::uint8_t slave = low_byte(word());
  switch (step_) {
    case 0:
      return SetUpAccess{.node = 0,
                         .reads = false,
                         .index = 0x1F81,
                         .sub = slave,
                         .length = 4,
                         .value = std::uint32_t{word(2)} << 16 | std::uint32_t{word(3)} << 8 |
                                  (word(1) & rules_.assignment_bits)};
    case 1:
      return SetUpAccess{
          .node = slave, .reads = false, .index = 0x100C, .sub = 0, .length = 2, .value = word(2)};
    default:
      return SetUpAccess{
          .node = slave, .reads = false, .index = 0x100D, .sub = 0, .length = 1, .value = word(3)};
  }
}

std::optional<SetUpAccess> SetUpCommand::storing_access() noexcept {
  if (word() > last_node) {
    answer(0, bad);
    next_step();
    return std::nullopt;
  }
  const bool stores = kind_ == SetUpKind::store;
  return SetUpAccess{.node = low_byte(word()),
                     .reads = false,
                     .index = static_cast<std::uint16_t>(stores ? 0x1010 : 0x1011),
                     .sub = 1,
                     .length = 4,
                     .value = stores ? save_signature : load_signature};
}

SetUpAccess SetUpCommand::cob_id_access(std::uint16_t parameter, std::uint16_t first_index) const noexcept {
  return {.node = high_byte(parameter),
          .reads = true,
          .index = static_cast<std::uint16_t>(first_index + low_byte(parameter) - 1),
          .sub = 1};
}

// [FX3U-CAN 7.2.5, 7.2.6] The source's COB-ID is read, then the destination's; a valid PDO is switched off before it gets
// another one [CiA 301 7.5.2.35].
std::optional<SetUpAccess> SetUpCommand::binding_access() noexcept {
  if (word() == 0 && word(1) == 0) {
    reset_due_ = at_ == 0 || !rules_.default_mapping_first;
    if (!reset_due_) {
      answer(0, bad);
      answer(1, bad);
    }
    next_step();
    return std::nullopt;
  }
  if (high_byte(word(1)) == local_tpdo) return extra_tpdo_access();
  const auto is_bad = [](std::uint16_t parameter) {
    return high_byte(parameter) > last_node || low_byte(parameter) == 0;
  };
  switch (step_) {
    case 0:
      if (is_bad(word())) {
        answer(0, bad);
        answer(1, bad);
        next_step();
        return std::nullopt;
      }
      return cob_id_access(word(), first_tpdo);
    case 1:
      if (is_bad(word(1))) {
        answer(1, bad);
        next_step();
        return std::nullopt;
      }
      return cob_id_access(word(1), first_rpdo);
    case 2:
    default: {
      SetUpAccess access = cob_id_access(word(1), first_rpdo);
      access.reads = false;
      access.length = 4;
      access.value = step_ == 2 ? invalid_bit | cob_id_ : cob_id_;
      return access;
    }
  }
}

std::optional<SetUpAccess> SetUpCommand::extra_tpdo_access() noexcept {
  const std::uint8_t node = high_byte(word()), tpdo = low_byte(word()), own = low_byte(word(1));
  const bool bad_source = node == 0 || node > last_node || (node == local_ && !rules_.takes_own_cob_ids) ||
                          tpdo == 0 || tpdo > default_tpdos;
  const bool bad_own = own <= default_tpdos || own > pdos_;
  if (bad_source || bad_own) {
    if (bad_source) answer(0, word());
    answer(1, bad_own ? word(1) : bad);
    next_step();
    return std::nullopt;
  }
  const auto index = static_cast<std::uint16_t>(first_tpdo + own - 1);
  const std::uint32_t cob_id = 0x80U + 0x100U * tpdo + node;
  return SetUpAccess{.node = 0,
                     .reads = false,
                     .index = index,
                     .sub = 1,
                     .length = 4,
                     .value = step_ == 0 ? invalid_bit | cob_id : cob_id};
}

void SetUpCommand::done(canopen::AbortCode code, std::uint32_t value) noexcept {
  const bool good = code == canopen::AbortCode::none;
  switch (kind_) {
    case SetUpKind::heartbeat_producing:
      // At the node that does not answer, or at the time that it refuses.
      if (!good) answer(no_response(code) ? 0U : 1U, bad);
      return next_step();
    case SetUpKind::heartbeat_consuming:
      if (no_response(code)) {
        answers_->front() = bad;
        at_ = command_parameters;
        return;
      }
      if (!good) answer(1, bad);
      return next_step();
    case SetUpKind::slave_assignment: return assignment_done(code);
    case SetUpKind::store:
    case SetUpKind::restore:
      if (!good) answer(0, bad);
      return next_step();
    case SetUpKind::bind_pdos: return binding_done(code, value);
  }
}

// [FX3U-CAN 10.4] A slave without 100CH or 100DH is answered with a copy of its four words.
void SetUpCommand::assignment_done(canopen::AbortCode code) noexcept {
  if (code != canopen::AbortCode::none) {
    if (step_ == 0) {
      answer(1, bad);
    } else if (code == canopen::AbortCode::no_object) {
      for (std::size_t i = 0; i < 4; ++i) answer(i, word(i));
    } else {
      answer(step_ == 1 ? 2U : 3U, bad);
    }
    return next_step();
  }
  if (++step_ == 3) next_step();
}

void SetUpCommand::binding_done(canopen::AbortCode code, std::uint32_t value) noexcept {
  const bool good = code == canopen::AbortCode::none;
  if (high_byte(word(1)) == local_tpdo) {
    if (!good) answer(1, word(1));
    if (!good || ++step_ == 2) next_step();
    return;
  }
  const bool at_source = step_ == 0;
  const std::size_t own_word = at_source ? 0U : 1U;
  const std::uint16_t parameter = word(own_word);
  if (!good) {
    const std::uint8_t node = real_node(high_byte(parameter));
    answer(own_word, no_response(code) ? word_of(node, 0) : word_of(node, low_byte(parameter)));
    if (at_source) answer(1, bad);
    return next_step();
  }
  switch (step_++) {
    case 0:
      if ((value & invalid_bit) != 0) {
        answer(0, low_byte(parameter));
        answer(1, bad);
        return next_step();
      }
      cob_id_ = value & identifier_bits;
      return;
    case 1:
      was_disabled_ = (value & invalid_bit) != 0;
      if (was_disabled_ || rules_.writes_over_cob_ids) ++step_;  // it can be changed as it is
      return;
    case 2: return;
    default:
      if (was_disabled_ && real_node(high_byte(parameter)) != local_) answer(1, low_byte(parameter));
      return next_step();
  }
}

}  // namespace canopus::module
