#pragma once
// What the Layer 2 modes do, said a second time: lists where the module keeps flags, milliseconds that are counted where
// the module has deadlines.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace canopus::scenario::layer2 {

enum class Kind { off, transmit, receive };
enum class Rtr { automatic, manual, none };

struct Message {
  unsigned dlc = 0;
  bool remote = false;
  std::array<std::uint8_t, 8> data{};
  std::uint32_t identifier = 0;
  bool operator==(const Message& other) const {
    if (dlc != other.dlc || remote != other.remote || identifier != other.identifier) return false;
    return remote || std::equal(data.begin(), data.begin() + dlc, other.data.begin());
  }
};

struct Slot {
  Kind kind = Kind::off;
  std::uint32_t identifier = 0;
  // transmit
  Rtr rtr = Rtr::none;
  unsigned type = 0;
  unsigned cycle = 0;  // in 10 ms
  bool strict = false;
  Message written, exchanged, last;
  bool strict_in_force = false;
  bool flagged = false;  // RTR
  // receive
  std::uint32_t mask = 0;
  std::vector<Message> came;         // since the last exchange
  std::optional<Message> before;     // the one before these
  std::optional<Message> displayed;  // in the words
  bool new_data = false, new_frame = false, overflow = false;
};

class Model {
 public:
  std::array<Slot, 42> slots;
  std::array<std::optional<Message>, 4> stop_messages;
  bool is_online = false;
  unsigned online_for = 0;  // ms
  std::vector<Message> sent;

  void send(Slot& slot) {
    sent.push_back(slot.exchanged);
    slot.last = slot.exchanged;
    slot.flagged = false;
  }
  void go_online() {
    is_online = true;
    online_for = 0;
    unsigned answering = 0;
    for (Slot& slot : slots) {
      slot.came.clear();
      slot.before.reset();
      if (slot.kind != Kind::transmit) continue;
      if (slot.rtr != Rtr::none && ++answering > 28) {
        slot.rtr = Rtr::none;
        slot.strict = false;
      }
      if ((slot.type == 2 || slot.type == 3) && slot.cycle == 0) slot.cycle = 1;
      slot.exchanged = slot.last = slot.written;
      slot.strict_in_force = slot.strict;
    }
  }
  void exchange() {
    if (!is_online) return;
    for (Slot& slot : slots) {
      if (slot.kind == Kind::transmit) {
        slot.exchanged = slot.written;
        slot.strict_in_force = slot.strict;
        if (slot.type == 0 || (slot.type == 1 && !(slot.exchanged == slot.last))) send(slot);
      }
      if (slot.kind != Kind::receive || slot.came.empty()) continue;
      const bool unread = slot.new_data || slot.new_frame || slot.overflow;
      if (unread || slot.came.size() > 1) slot.overflow = true;
      slot.new_frame = true;
      for (const Message& message : slot.came) {
        if (!slot.before || !(message == *slot.before)) slot.new_data = true;
        slot.before = message;
      }
      slot.displayed = slot.before;
      slot.came.clear();
    }
  }
  void pass_millisecond() {
    if (!is_online) return;
    ++online_for;
    for (Slot& slot : slots) {
      if (slot.kind != Kind::transmit || slot.cycle == 0 || online_for % (10 * slot.cycle) != 0) continue;
      if (slot.type == 2 || (slot.type == 3 && !(slot.exchanged == slot.last))) send(slot);
    }
  }
  void receive(const Message& message) {
    if (!is_online) return;
    for (Slot& slot : slots) {
      if (slot.kind == Kind::receive && !message.remote &&
          (message.identifier | slot.mask) == (slot.identifier | slot.mask)) {
        slot.came.push_back(message);
      }
      if (slot.kind != Kind::transmit || !message.remote || message.identifier != slot.identifier) continue;
      if (slot.strict_in_force && message.dlc != slot.exchanged.dlc) continue;
      if (slot.rtr == Rtr::automatic) send(slot);
      if (slot.rtr == Rtr::manual) slot.flagged = true;
    }
  }
};

}  // namespace canopus::scenario::layer2
