// The Layer 2 modes against a model of their own: whatever settings make sense and whatever the program and
// the bus do, frames, flags and words are what the model (layer2_model.hpp) says.

#include "scenarios/me3can1_q/layer2_model.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/module/models/me3can1_q/me3can1_q.hpp"

#include "scenarios/scenario.hpp"

namespace canopus::scenario::me3can1_q_layer2_model_test {
namespace {

using namespace layer2;

// The module, the program and the bus beside it.
class Comparison {
 public:
  Comparison(std::uint32_t seed, bool is_extended) : random_(seed), extended_(is_extended) {
    RC_ASSERT(module_.preset_word(21, extended_ ? 29 : 11));
    module_.power_on(now_);
    while (module_.program_read(25, now_) != 0) step(1ms);
    for (module::BufferAddress number = 0; number < 42; ++number) configure(number);
    for (module::BufferAddress number = 0; number < 4; ++number) {
      if (below(2) == 0) continue;
      Message message = some_message();
      message.remote = false;
      model_.stop_messages[number] = message;
      write_message(8450 + 7 * number, message, message.dlc);
    }
    toggle_online();
    RC_ASSERT((module_.inputs() >> 3 & 1U) == 1U);
  }

  void act(unsigned what, std::uint32_t seed) {
    random_.seed(seed);
    Slot& slot = model_.slots[below(42)];
    const auto number = static_cast<module::BufferAddress>(&slot - model_.slots.data());
    switch (what % 12) {
      case 0:
      case 1: exchange(); break;
      case 2:
      case 3: {
        Message message = some_message();
        message.remote = false;
        receive(message);
        break;
      }
      case 4: {
        Message message = some_message();
        message.remote = true;
        receive(message);
        break;
      }
      case 5:
      case 6:
        if (slot.kind != Kind::transmit) break;
        slot.written.data = some_data();
        for (module::BufferAddress word = 0; word < 4; ++word)
          write(10003 + 7 * number + word, two(slot.written.data, word));
        break;
      case 7:
        if (slot.kind != Kind::transmit) break;
        write_form(number);
        break;
      case 8: {  // the program has read
        if (slot.kind != Kind::receive) break;
        const bool keeps_new_frame = below(4) == 0;
        write(10002 + 7 * number, keeps_new_frame ? 0x0200 : 0);
        slot.new_data = slot.overflow = false;
        slot.new_frame = slot.new_frame && keeps_new_frame;
        break;
      }
      case 9: trigger(); break;
      case 10: step(std::chrono::milliseconds(below(25))); break;
      default:
        if (below(3) == 0) toggle_online();
        if (below(3) == 0) stop_and_run();
        break;
    }
    compare();
  }

 private:
  std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(random_() % limit); }
  std::uint32_t some_identifier() { return (extended_ ? 0x18FF0000U : 0x180U) + below(12); }
  std::array<std::uint8_t, 8> some_data() {
    std::array<std::uint8_t, 8> data{};
    for (auto& byte : data) byte = static_cast<std::uint8_t>(below(8) == 0 ? random_() : below(2));
    return data;
  }
  Message some_message() {
    Message message{.dlc = below(9), .identifier = some_identifier()};
    message.data = some_data();
    return message;
  }
  static std::uint16_t two(const std::array<std::uint8_t, 8>& data, std::size_t word) {
    return static_cast<std::uint16_t>(data[2 * word] + 256 * data[2 * word + 1]);
  }
  void write(module::BufferAddress address, std::uint32_t value) {
    module_.write_word(address, static_cast<std::uint16_t>(value), now_);
  }
  void write_message(module::BufferAddress first, const Message& message, std::uint32_t form) {
    write(first, message.identifier & 0xFFFF);
    write(first + 1, message.identifier >> 16);
    write(first + 2, form);
    for (module::BufferAddress word = 0; word < 4; ++word) write(first + 3 + word, two(message.data, word));
  }
  static std::uint32_t form_of(const Slot& slot) {
    return slot.written.dlc + (slot.strict ? 0x1000U : 0U) + (slot.written.remote ? 0x8000U : 0U);
  }

  void configure(module::BufferAddress number) {
    Slot& slot = model_.slots[number];
    slot.kind = static_cast<Kind>(below(3));
    slot.identifier = some_identifier();
    if (slot.kind == Kind::receive) {
      slot.mask = below(2) == 0 ? 0 : below(8);
      write(6000 + 4 * number, slot.identifier & 0xFFFF);
      write(6001 + 4 * number, slot.identifier >> 16);
      write(6002 + 4 * number, slot.mask & 0xFFFF);
      write(6003 + 4 * number, slot.mask >> 16);
    }
    if (slot.kind != Kind::transmit) return;
    slot.rtr = below(4) == 0 ? Rtr::none : static_cast<Rtr>(below(2));
    slot.type = below(5);
    slot.cycle = below(4);
    slot.written = some_message();
    slot.written.identifier = slot.identifier;
    constexpr std::array<std::uint32_t, 3> parameter_b{0x7FFF, 0x6FFF, 0x5FFF};
    write(6001 + 4 * number, parameter_b[static_cast<std::size_t>(slot.rtr)]);
    write(6002 + 4 * number, slot.type);
    write(6003 + 4 * number, slot.cycle);
    choose_form(slot);
    write_message(10000 + 7 * number, slot.written, form_of(slot));
  }
  void choose_form(Slot& slot) {
    slot.written.dlc = below(9);
    slot.strict = slot.rtr != Rtr::none && below(2) == 0;
    slot.written.remote = slot.rtr == Rtr::none && below(3) == 0;
  }
  void write_form(module::BufferAddress number) {
    choose_form(model_.slots[number]);
    write(10002 + 7 * number, form_of(model_.slots[number]));
  }

  void y(unsigned number, bool on) {
    module_.set_output(number, on, now_);
    run(now_);
  }
  void run(can::Time end) {
    while (!bus_.completing.empty() || module_.deadline() <= end) {
      for (const auto frames = std::exchange(bus_.completing, {}); const can::Frame& frame : frames) {
        module_.transmitted(frame, now_);
      }
      if (module_.deadline() > end) continue;
      now_ = std::max(now_, module_.deadline());
      module_.tick(now_);
    }
    now_ = end;
  }
  void step(can::Duration duration) {
    for (can::Duration passed{}; passed < duration; passed += 1ms) {
      run(now_ + 1ms);
      model_.pass_millisecond();
    }
  }
  void exchange() {
    y(1, true);
    run(now_ + 1ms);
    model_.exchange();  // a data exchange that ends with a cycle goes first
    model_.pass_millisecond();
    RC_ASSERT((module_.inputs() >> 1 & 1U) == 1U);
    y(1, false);
  }
  void receive(const Message& message) {
    can::Frame frame{.identifier = message.identifier,
                     .extended = extended_,
                     .remote = message.remote,
                     .dlc = static_cast<std::uint8_t>(message.dlc)};
    for (std::size_t i = 0; !message.remote && i < message.dlc; ++i) frame.data[i] = message.data[i];
    module_.receive(frame, now_);
    can::Frame foreign = frame;  // of the other format: nobody's
    foreign.extended = !extended_;
    if (foreign.identifier <= can::max_base_identifier || foreign.extended) module_.receive(foreign, now_);
    model_.receive(message);
    step(1ms);
  }
  void trigger() {
    std::array<std::uint32_t, 3> flags{};
    for (auto& word : flags) word = static_cast<std::uint32_t>(random_()) & 0xFFFF;
    for (module::BufferAddress word = 0; word < 3; ++word) write(8400 + word, flags[word]);
    flags[2] &= 0x03FF;  // bits 10 to 15 are reserved
    y(4, true);
    RC_ASSERT((module_.inputs() >> 4 & 1U) == (model_.is_online ? 1U : 0U));
    for (std::size_t number = 0; number < 42; ++number) {
      Slot& slot = model_.slots[number];
      const bool flagged = (flags[number / 16] >> (number % 16) & 1U) != 0;
      if (model_.is_online && flagged && slot.kind == Kind::transmit) model_.send(slot);
    }
    for (module::BufferAddress word = 0; word < 3; ++word) {
      RC_ASSERT(module_.program_read(8400 + word, now_) == (model_.is_online ? 0U : flags[word]));
    }
    y(4, false);
    for (module::BufferAddress word = 0; word < 3; ++word) write(8400 + word, 0);
  }
  void toggle_online() {
    y(3, !model_.is_online);
    if (model_.is_online) {
      model_.is_online = false;
    } else {
      model_.go_online();
    }
    RC_ASSERT((module_.inputs() >> 3 & 1U) == (model_.is_online ? 1U : 0U));
  }
  void stop_and_run() {
    module_.cpu_changed(module::CpuState::stop, now_);
    run(now_);
    module_.cpu_changed(module::CpuState::run, now_);
    for (const auto& message : model_.stop_messages) {
      if (message && model_.is_online) model_.sent.push_back(*message);
    }
  }

  void compare() {
    std::vector<Message> sent;
    for (const can::Frame& frame : bus_.sent) {
      RC_ASSERT(frame.extended == extended_);
      Message message{.dlc = frame.dlc, .remote = frame.remote, .identifier = frame.identifier};
      message.data = frame.data;
      sent.push_back(message);
    }
    RC_ASSERT(sent.size() == model_.sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) RC_ASSERT(sent[i] == model_.sent[i]);
    bus_.sent.clear();
    model_.sent.clear();
    for (module::BufferAddress number = 0; number < 42; ++number) compare(number);
    RC_ASSERT(module_.program_read(29, now_) == 0U);
  }
  void compare(module::BufferAddress number) {
    const Slot& slot = model_.slots[number];
    const auto word = [&](module::BufferAddress offset) {
      return module_.program_read(10000 + 7 * number + offset, now_);
    };
    const bool rtr_flag = (module_.program_read(8350 + number / 16, now_) >> (number % 16) & 1U) != 0;
    RC_ASSERT(rtr_flag == slot.flagged);
    if (slot.kind == Kind::receive) {
      const unsigned flags =
          (slot.new_data ? 1U : 0U) + (slot.new_frame ? 2U : 0U) + (slot.overflow ? 4U : 0U);
      RC_ASSERT((word(2) >> 8) == flags);
      if (!slot.displayed) return;
      const Message& message = *slot.displayed;
      RC_ASSERT((word(2) & 0xFF) == message.dlc);
      RC_ASSERT(word(0) + 65536U * word(1) == message.identifier);
      for (unsigned i = 0; i < 8; ++i) {
        const unsigned byte = word(3 + i / 2) >> (i % 2 * 8) & 0xFFU;
        RC_ASSERT(byte == (i < message.dlc ? message.data[i] : 0U));
      }
    } else if (slot.kind == Kind::transmit) {
      RC_ASSERT(word(2) == form_of(slot));
      for (module::BufferAddress i = 0; i < 4; ++i) RC_ASSERT(word(3 + i) == two(slot.written.data, i));
      constexpr std::array<std::uint32_t, 3> parameter_b{0x7FFF, 0x6FFF, 0x5FFF};
      RC_ASSERT(module_.program_read(6001 + 4 * number, now_) ==
                parameter_b[static_cast<std::size_t>(slot.rtr)]);
      RC_ASSERT(module_.program_read(6003 + 4 * number, now_) == slot.cycle);
    } else {
      RC_ASSERT(word(0) == 0xFFFFU);
      RC_ASSERT(word(2) == 0U);
    }
  }

  std::mt19937 random_;
  bool extended_;
  RamMemory memory_;
  FreeBus bus_;
  module::me3can1_q::Me3can1Q module_{bus_, memory_};
  can::Time now_{};
  Model model_;
};

RC_GTEST_PROP(Me3Layer2Model, FramesFlagsAndWords_AreTheModels, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint32_t>().as("seed of the settings");
  const auto is_extended = *rc::gen::arbitrary<bool>().as("29-bit");
  using Actions = std::vector<std::pair<unsigned, std::uint32_t>>;
  const auto actions =
      *rc::gen::scale(3, rc::gen::container<Actions>(
                             rc::gen::pair(rc::gen::inRange(0U, 12U), rc::gen::arbitrary<std::uint32_t>())));
  Comparison comparison(seed, is_extended);
  for (const auto& [what, detail] : actions) comparison.act(what, detail);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_layer2_model_test
