#pragma once
// A CANopen device written by hand for these tests, from the frames of CiA 301 alone: it shares no code with
// what is tested.

#include <algorithm>
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
  std::map<Key, int> silences;                        // so many requests are not answered
  bool indicates_size = true;                         // else the bytes behind a value are no zeros
  std::map<Key, std::size_t> lengths;                 // of an answer, which is shorter than 8 bytes
  bool knows_blocks = true;                           // SDO block download
  std::function<std::uint32_t(const Key&)> on_write;  // after a value was stored; returns an abort code or 0
  std::function<void(const Key&)> on_read;            // before a value is read
  std::vector<std::pair<Key, std::vector<std::uint8_t>>> written;

  void receive(const can::Frame& frame) {
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
    in_block_ = false;
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
    if (in_block_) return block_segment(frame);
    const Key key{static_cast<std::uint16_t>(d[1] | d[2] << 8), d[3]};
    const unsigned command = d[0] >> 5;
    if (command != 0 && command != 3 && command != 4 && (d[0] & 0xE1) != 0xC1 && silences[key] > 0) {
      --silences[key];
      return;
    }
    if (command == 2) {  // upload
      if (on_read) on_read(key);
      if (aborts.contains(key)) return abort(key, aborts[key]);
      if (!objects.contains(key)) return abort(key, 0x06020000);
      auto value = objects[key];
      if (value.size() > 4) {
        segments_ = value;
        return answer({0x41, d[1], d[2], d[3], static_cast<std::uint8_t>(value.size())});
      }
      const auto unused = static_cast<std::uint8_t>(4 - value.size());
      value.resize(4, indicates_size ? 0 : 0xAA);
      const auto first = static_cast<std::uint8_t>(indicates_size ? 0x43 | unused << 2 : 0x42);
      if (lengths.contains(key)) {
        std::vector<std::uint8_t> whole{first, d[1], d[2], d[3], value[0], value[1], value[2], value[3]};
        whole.resize(lengths[key]);
        return send_(can::data_frame(0x580U + id, whole), answer_delay);
      }
      answer({first, d[1], d[2], d[3], value[0], value[1], value[2], value[3]});
    } else if (command == 1) {  // download
      key_ = key;
      if (aborts.contains(key)) return abort(key, aborts[key]);
      if ((d[0] & 0x02) != 0) {
        const std::size_t length = 4U - (d[0] >> 2 & 3);
        if (!store({d.begin() + 4, d.begin() + 4 + static_cast<std::ptrdiff_t>(length)})) return;
      } else {
        segments_.clear();
      }
      answer({0x60, d[1], d[2], d[3]});
    } else if (command == 0) {  // segment of a download
      const std::size_t length = 7U - (d[0] >> 1 & 7);
      segments_.insert(segments_.end(), d.begin() + 1, d.begin() + 1 + static_cast<std::ptrdiff_t>(length));
      if ((d[0] & 0x01) != 0 && !store(segments_)) return;
      answer({static_cast<std::uint8_t>(0x20 | (d[0] & 0x10))});
    } else if (command == 3) {  // segment of an upload
      std::vector<std::uint8_t> data{static_cast<std::uint8_t>(d[0] & 0x10)};
      const std::size_t length = std::min<std::size_t>(7, segments_.size());
      data.insert(data.end(), segments_.begin(), segments_.begin() + static_cast<std::ptrdiff_t>(length));
      segments_.erase(segments_.begin(), segments_.begin() + static_cast<std::ptrdiff_t>(length));
      if (segments_.empty()) data[0] = static_cast<std::uint8_t>(data[0] | (7 - length) << 1 | 1);
      data.resize(8);
      send_(can::data_frame(0x580U + id, data), answer_delay);
    } else if (command == 6 && (d[0] & 1) == 0) {  // block download
      if (!knows_blocks) return abort(key, 0x05040001);
      if (aborts.contains(key)) return abort(key, aborts[key]);
      key_ = key;
      segments_.clear();
      in_block_ = true;
      sequence_ = 0;
      answer({0xA4, d[1], d[2], d[3], block_size});
    } else if (command == 6) {  // end of it
      segments_.resize(segments_.size() - (d[0] >> 2 & 7));
      if ((d[1] | d[2] << 8) != crc(segments_)) return abort(key_, 0x05040004);
      if (store(segments_)) answer({0xA1});
    }
  }
  void block_segment(const can::Frame& frame) {
    const auto& d = frame.data;
    if (d[0] == 0x80) {
      in_block_ = false;
      return;
    }
    if ((d[0] & 0x7F) != sequence_ + 1) return;
    ++sequence_;
    segments_.insert(segments_.end(), d.begin() + 1, d.begin() + 8);
    const bool last = (d[0] & 0x80) != 0;
    if (!last && sequence_ != block_size) return;
    answer({0xA2, sequence_, block_size});
    sequence_ = 0;
    in_block_ = !last;
  }
  // x^16 + x^12 + x^5 + 1, bit by bit.
  static int crc(const std::vector<std::uint8_t>& bytes) {
    unsigned sum = 0;
    for (const std::uint8_t byte : bytes) {
      sum ^= static_cast<unsigned>(byte) << 8;
      for (int bit = 0; bit < 8; ++bit) sum = (sum & 0x8000U) != 0 ? sum << 1 ^ 0x1021U : sum << 1;
      sum &= 0xFFFFU;
    }
    return static_cast<int>(sum);
  }
  bool store(std::vector<std::uint8_t> value) {
    objects[key_] = value;
    written.emplace_back(key_, std::move(value));
    const std::uint32_t refusal = on_write ? on_write(key_) : 0;
    if (refusal != 0) abort(key_, refusal);
    return refusal == 0;
  }

  static constexpr std::uint8_t block_size = 127;

  Sender send_;
  Key key_;
  std::vector<std::uint8_t> segments_;
  bool in_block_ = false;
  std::uint8_t sequence_ = 0;
};

}  // namespace canopus::manager::test
