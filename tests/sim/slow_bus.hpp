#pragma once
// Controllers on one wire, bit by bit, as ISO 11898-1 tells it and as slowly as that: a reference for what the
// simulated bus does. Nothing here is shared with the program. All have one bit rate and the same phase, so that
// time is the number of a bit (slot); levels are characters, '0' dominant, '1' recessive. A receiver reads the
// frame anew from its SOF with every bit.

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/frame.hpp"

#include "can/slow_frame.hpp"
#include "sim/slow_reading.hpp"

namespace canopus::sim::slow {

class Bus {
 public:
  struct Node {
    std::string name;
    bool listen_only = false;
    int tec = 0;
    int rec = 0;
    std::vector<can::Frame> heard{};
    std::vector<can::Frame> sent{};

    enum class Phase {
      idle,
      frame,
      active_flag,
      passive_flag,
      overload_flag,
      flags_of_others,
      delimiter,
      intermission,
      suspend,
      bus_off
    } phase = Phase::idle;
    int bits = 0;           // in the phase
    char flag_level = ' ';  // of the passive flag's row of equal bits
    bool is_overload = false;
    bool may_count = false;    // passive, not acknowledged: a dominant bit in its flag counts
    bool transmitter = false;  // of the present or last frame
    std::string out{};         // what it sends
    std::size_t arbitration = 0;
    std::string seen{};
    Reading reading{};  // of `seen`
    std::size_t start = 0;
    std::optional<can::Frame> current{};
    std::vector<std::pair<std::string, can::Frame>> waiting{};

    [[nodiscard]] bool passive() const { return tec >= 128 || rec >= 128; }
    [[nodiscard]] bool sends() const { return phase == Phase::frame && transmitter; }
  };

  Node& add(std::string name) {
    nodes.push_back({.name = std::move(name)});
    return nodes.back();
  }
  /// The frame is queued before slot `slot` begins. Identifiers are a node's own.
  void send(std::size_t node, std::size_t slot, const can::Frame& frame) {
    plan_.push_back({slot, node, frame});
  }
  /// Inverts bit `bit` of the attempt with this number (from 1), on the wire or for one node alone.
  void corrupt(std::size_t attempt, std::size_t bit, std::optional<std::size_t> node) {
    corruptions_.push_back({attempt, bit, node});
  }

  void run(std::size_t slots) {
    for (std::size_t slot = wire.size(); slots-- > 0; ++slot) step(slot);
  }

  std::vector<Node> nodes;
  std::string wire;                 ///< the level of every slot
  std::vector<std::string> errors;  ///< "b stuff 5": who, what, at the sample point of which slot
  std::vector<std::string> frames;  ///< "291 0 53": identifier, first slot, slot after the last
  std::vector<std::size_t> starts;  ///< of every attempt
  std::size_t overloads = 0;        ///< overload flags begun

 private:
  using Phase = Node::Phase;
  struct Planned {
    std::size_t slot;
    std::size_t node;
    can::Frame frame;
  };
  struct Corruption {
    std::size_t attempt;
    std::size_t bit;
    std::optional<std::size_t> node;
  };

  void step(std::size_t slot) {
    for (const Planned& planned : plan_) {
      if (planned.slot == slot) queue(nodes[planned.node], planned.frame);
    }
    bool begins = false;
    for (Node& node : nodes) {
      if (node.phase != Phase::idle || node.waiting.empty() || node.listen_only) continue;
      begin(node, slot);
      sample(node);
      begins = true;
    }
    if (begins) {
      starts.push_back(slot);
      corrupting_ = true;
    }
    char level = '1';
    for (const Node& node : nodes) {
      if (drives(node) == '0') level = '0';
    }
    if (is_inverted(slot, std::nullopt)) level = level == '0' ? '1' : '0';
    wire += level;
    bool failed = false;
    std::optional<std::string> complete;
    for (std::size_t number = 0; number < nodes.size(); ++number) {
      const char seen = is_inverted(slot, number) ? (level == '0' ? '1' : '0') : level;
      const std::size_t errors_before = errors.size();
      see(nodes[number], seen, slot, complete);
      failed = failed || errors.size() != errors_before;
    }
    if (complete) frames.push_back(*complete);
    const bool sends = std::any_of(nodes.begin(), nodes.end(), [](const Node& node) { return node.sends(); });
    const bool quiet = std::all_of(nodes.begin(), nodes.end(), [](const Node& node) {
      return node.phase == Phase::idle || node.phase == Phase::suspend || node.phase == Phase::bus_off;
    });
    if ((failed && !sends) || quiet) corrupting_ = false;  // they were about that frame
  }

  static void queue(Node& node, const can::Frame& frame) {
    node.waiting.emplace_back(can::slow::wire(frame), frame);
    std::stable_sort(node.waiting.begin(), node.waiting.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
  }
  static void begin(Node& node, std::size_t slot) {
    node.phase = Phase::frame;
    node.seen.clear();
    node.reading = {};
    node.transmitter = false;
    node.is_overload = false;
    node.start = slot;
  }
  static void sample(Node& node) {
    node.transmitter = true;
    node.out = node.waiting.front().first;
    node.current = node.waiting.front().second;
    node.waiting.erase(node.waiting.begin());
    // SOF, identifier and RTR with the stuff bits between them.
    const std::string before_crc = can::slow::before_crc(*node.current);
    std::string field = can::slow::stuffed(before_crc.substr(0, node.current->extended ? 33 : 13));
    if (field.size() > 5 && field.substr(field.size() - 6, 5) == std::string(5, field[field.size() - 2]) &&
        field.back() != field[field.size() - 2]) {
      field.pop_back();  // the stuff bit after RTR is no longer arbitration
    }
    node.arbitration = field.size();
  }

  static char drives(const Node& node) {
    if (node.listen_only) return '1';
    if (node.phase == Phase::active_flag || node.phase == Phase::overload_flag) return '0';
    if (node.phase != Phase::frame) return '1';
    if (node.transmitter) return node.out[node.seen.size()];
    return node.reading.next_is_ack_slot && node.reading.crc_good ? '0' : '1';
  }

  [[nodiscard]] bool is_inverted(std::size_t slot, std::optional<std::size_t> node) const {
    if (!corrupting_) return false;
    return std::count_if(corruptions_.begin(), corruptions_.end(),
                         [&](const Corruption& corruption) {
                           return corruption.attempt == starts.size() && corruption.node == node &&
                                  starts.back() + corruption.bit == slot;
                         }) %
               2 !=
           0;
  }

  void enter(Node& node, Phase phase) {
    node.phase = phase;
    node.bits = 0;
    if (phase == Phase::overload_flag) {
      node.is_overload = true;
      ++overloads;
    }
  }

  void see(Node& node, char level, std::size_t slot, std::optional<std::string>& complete) {
    const bool dominant = level == '0';
    switch (node.phase) {
      case Phase::bus_off: return;
      case Phase::idle:
      case Phase::suspend:
        if (dominant) {
          begin(node, slot);
          return see_frame(node, level, slot, complete);
        }
        if (node.phase == Phase::suspend && ++node.bits == 8) enter(node, Phase::idle);
        return;
      case Phase::frame: return see_frame(node, level, slot, complete);
      case Phase::active_flag:
      case Phase::overload_flag:
        if (!dominant && !node.listen_only) {  // rules d and e
          errors.push_back(node.name + " bit " + std::to_string(slot));
          const bool passive = node.passive();
          count(node, 8);
          begin_flag(node, passive);
          return;
        }
        if (++node.bits == 6) enter(node, Phase::flags_of_others);
        return;
      case Phase::passive_flag:
        if (dominant && node.may_count) {
          node.may_count = false;
          count(node, 8);
        }
        node.bits = level == node.flag_level ? node.bits + 1 : 1;
        node.flag_level = level;
        if (node.phase == Phase::passive_flag && node.bits == 6) enter(node, Phase::flags_of_others);
        return;
      case Phase::flags_of_others:
        if (!dominant) {
          enter(node, Phase::delimiter);
          node.bits = 1;
          return;
        }
        ++node.bits;
        if (node.bits == 1 && !node.is_overload && !node.transmitter) count(node, 8);  // rule b
        if (node.bits % 8 == 0) count(node, 8);                                        // rule f
        return;
      case Phase::delimiter:
        ++node.bits;
        if (dominant && node.bits < 8) return fail(node, "form", slot);
        if (dominant) return enter(node, Phase::overload_flag);
        if (node.bits == 8) enter(node, Phase::intermission);
        return;
      case Phase::intermission: {
        ++node.bits;
        const bool suspends = node.transmitter && node.passive();
        if (!dominant) {
          if (node.bits == 3) enter(node, suspends ? Phase::suspend : Phase::idle);
          return;
        }
        if (node.bits < 3) return enter(node, Phase::overload_flag);
        begin(node, slot);  // the SOF of somebody else, which counts as its own
        see_frame(node, level, slot, complete);
        if (!suspends && !node.waiting.empty() && !node.listen_only) sample(node);
        return;
      }
    }
  }

  void see_frame(Node& node, char level, std::size_t slot, std::optional<std::string>& complete) {
    const std::size_t position = node.seen.size();
    const Reading before = node.reading;
    node.seen += level;
    node.reading = read(node.seen);
    const Reading now = node.reading;
    if (node.transmitter) {
      const char sent = node.out[position];
      if (sent == '0' && level == '1') return fail(node, "bit", slot);
      if (now.place == Reading::Place::ack_slot) {
        if (level == '1') return fail(node, "ack", slot);
      } else if (sent == '1' && level == '0') {
        if (position >= node.arbitration) return fail(node, "bit", slot);
        if (now.stuff_error) return fail(node, "stuff", slot, false);  // rule c, exception 2
        requeue(node);
        node.transmitter = false;  // arbitration lost
      }
    }
    if (now.stuff_error) return fail(node, "stuff", slot);
    const bool acknowledges =
        !node.transmitter && !node.listen_only && before.next_is_ack_slot && before.crc_good;
    switch (now.place) {
      case Reading::Place::stuffed: return;
      case Reading::Place::crc_delimiter: return level == '0' ? fail(node, "form", slot) : void();
      case Reading::Place::ack_slot:
        if (!acknowledges) return;
        if (level == '1') return fail(node, "bit", slot);
        node.rec = node.rec > 127 ? 127 : std::max(node.rec - 1, 0);  // rule h
        return;
      case Reading::Place::ack_delimiter:
        if (!now.crc_good) return fail(node, "crc", slot);
        return level == '0' ? fail(node, "form", slot) : void();
      case Reading::Place::eof: return level == '0' ? fail(node, "form", slot) : void();
      case Reading::Place::last: break;
    }
    if (node.transmitter) {
      node.tec = std::max(node.tec - 1, 0);  // rule g
      node.sent.push_back(*node.current);
    } else {
      node.heard.push_back(frame_of(node.seen));
    }
    const can::Frame frame = node.transmitter ? *node.current : node.heard.back();
    complete =
        std::to_string(frame.identifier) + " " + std::to_string(node.start) + " " + std::to_string(slot + 1);
    enter(node, level == '0' ? Phase::overload_flag : Phase::intermission);
  }

  static void requeue(Node& node) { queue(node, *node.current); }

  void fail(Node& node, const std::string& error, std::size_t slot, bool counts = true) {
    errors.push_back(node.name + " " + error + " " + std::to_string(slot));
    const bool sent = node.sends();
    if (sent) requeue(node);
    const bool passive = node.passive();  // before it counts
    node.may_count = false;
    if (counts && !node.transmitter) {
      count(node, 1);  // rule a
    } else if (counts && passive && error == "ack") {
      node.may_count = true;  // rule c, exception 1
    } else if (counts) {
      count(node, 8);  // rule c
    }
    begin_flag(node, passive);
  }
  void begin_flag(Node& node, bool passive) {
    if (node.phase == Phase::bus_off) return;
    node.is_overload = false;
    node.flag_level = ' ';
    enter(node, passive ? Phase::passive_flag : Phase::active_flag);
  }
  void count(Node& node, int errors_counted) {
    if (node.listen_only) return;
    if (!node.transmitter) {
      node.rec = std::min(node.rec + errors_counted, 255);
      return;
    }
    node.tec = std::min(node.tec + errors_counted, 256);
    if (node.tec == 256) enter(node, Phase::bus_off);
  }

  /// The frame whose bits these are.
  static can::Frame frame_of(const std::string& seen) {
    std::string payload;
    int row = 0;
    char last = ' ';
    for (const char bit : seen) {
      const bool is_stuff_bit = row == 5;
      row = bit == last ? row + 1 : 1;
      last = bit;
      if (!is_stuff_bit) payload += bit;
    }
    const auto number = [&](std::size_t first, std::size_t count) {
      return static_cast<std::uint32_t>(std::stoul(payload.substr(first, count), nullptr, 2));
    };
    can::Frame frame;
    frame.extended = payload[13] == '1';
    frame.identifier = frame.extended ? number(1, 11) << 18 | number(14, 18) : number(1, 11);
    frame.remote = payload[frame.extended ? 32 : 12] == '1';
    const std::size_t dlc = frame.extended ? 35 : 15;
    frame.dlc = static_cast<std::uint8_t>(number(dlc, 4));
    for (std::size_t byte = 0; byte < frame.length(); ++byte) {
      frame.data[byte] = static_cast<std::uint8_t>(number(dlc + 4 + 8 * byte, 8));
    }
    return frame;
  }

  std::vector<Planned> plan_;
  std::vector<Corruption> corruptions_;
  bool corrupting_ = false;
};

}  // namespace canopus::sim::slow
