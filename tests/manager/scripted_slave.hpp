#pragma once
// A CANopen device written by hand for these tests, from the frames of CiA 301 alone: it shares no code with
// what is tested.

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"

namespace canopus::manager::test {

using namespace std::chrono_literals;

class ScriptedSlave {
 public:
  using Sender = std::function<void(const can::Frame&, can::Duration after)>;
  using Key = std::pair<std::uint16_t, std::uint8_t>;

  ScriptedSlave(std::uint8_t node_id, Sender sender) : id(node_id), send_(std::move(sender)) {
    objects[{0x1000, 0}] = {0x91, 0x01, 0x0F, 0x00};
  }

  std::uint8_t id;
  bool present = true;
  bool boots_up = true;  // sends its boot-up message after a reset
  bool answers_guarding = true;
  can::Duration boot_up_delay = 5ms;
  can::Duration answer_delay = 1ms;
  can::Duration heartbeat_after_reset{};  // first heartbeat so long after a boot-up; 0 = none
  std::uint8_t state = 0x7F;
  bool toggle = false;
  std::map<Key, std::vector<std::uint8_t>> objects;
  std::map<Key, std::uint32_t> aborts;
  std::vector<std::pair<Key, std::vector<std::uint8_t>>> written;

  void hear(const can::Frame& frame) {
    if (!present) return;
    if (frame.identifier == 0x000 && (frame.data[1] == id || frame.data[1] == 0)) nmt(frame.data[0]);
    if (frame.identifier == 0x700U + id && frame.remote && answers_guarding) {
      send_(can::data_frame(0x700U + id, {static_cast<std::uint8_t>(state | (toggle ? 0x80 : 0))}),
            answer_delay);
      toggle = !toggle;
    }
    if (frame.identifier == 0x600U + id && !frame.remote) sdo(frame);
  }
  void reset() {
    state = 0x7F;
    toggle = false;
    size_ = 0;
    if (!boots_up) return;
    send_(can::data_frame(0x700U + id, {0x00}), boot_up_delay);
    if (heartbeat_after_reset > can::Duration{}) {
      send_(can::data_frame(0x700U + id, {0x7F}), boot_up_delay + heartbeat_after_reset);
    }
  }

 private:
  void nmt(std::uint8_t command) {
    switch (command) {
      case 0x01: state = 0x05; break;
      case 0x02: state = 0x04; break;
      case 0x80: state = 0x7F; break;
      case 0x81:
      case 0x82: reset(); break;
      default: break;
    }
  }
  void answer(std::initializer_list<std::uint8_t> bytes) {
    std::vector<std::uint8_t> data(bytes);
    data.resize(8);
    send_(can::data_frame(0x580U + id, data), answer_delay);
  }
  void abort(Key key, std::uint32_t code) {
    answer({0x80, static_cast<std::uint8_t>(key.first), static_cast<std::uint8_t>(key.first >> 8), key.second,
            static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8),
            static_cast<std::uint8_t>(code >> 16), static_cast<std::uint8_t>(code >> 24)});
  }
  void sdo(const can::Frame& frame) {
    const auto& d = frame.data;
    const Key key{static_cast<std::uint16_t>(d[1] | d[2] << 8), d[3]};
    const unsigned command = d[0] >> 5;
    if (command == 2) {  // upload
      if (aborts.contains(key)) return abort(key, aborts[key]);
      if (!objects.contains(key)) return abort(key, 0x06020000);
      auto value = objects[key];
      const auto unused = static_cast<std::uint8_t>(4 - value.size());
      value.resize(4);
      answer({static_cast<std::uint8_t>(0x43 | unused << 2), d[1], d[2], d[3], value[0], value[1], value[2],
              value[3]});
    } else if (command == 1) {  // download
      key_ = key;
      if (aborts.contains(key)) return abort(key, aborts[key]);
      if ((d[0] & 0x02) != 0) {
        const std::size_t length = 4U - (d[0] >> 2 & 3);
        store({d.begin() + 4, d.begin() + 4 + static_cast<std::ptrdiff_t>(length)});
      } else {
        segments_.clear();
        size_ = static_cast<std::size_t>(d[4] | d[5] << 8);
      }
      answer({0x60, d[1], d[2], d[3]});
    } else if (command == 0) {  // segment of a download
      const std::size_t length = 7U - (d[0] >> 1 & 7);
      segments_.insert(segments_.end(), d.begin() + 1, d.begin() + 1 + static_cast<std::ptrdiff_t>(length));
      if ((d[0] & 0x01) != 0) store(segments_);
      answer({static_cast<std::uint8_t>(0x20 | (d[0] & 0x10))});
    }
  }
  void store(std::vector<std::uint8_t> value) {
    objects[key_] = value;
    written.emplace_back(key_, std::move(value));
  }

  Sender send_;
  Key key_;
  std::vector<std::uint8_t> segments_;
  std::size_t size_ = 0;
};

}  // namespace canopus::manager::test
