#include "scenarios/as_fcopm/card.hpp"

#include <algorithm>

namespace canopus::scenario {

bool FcopmSlave::was_written(std::uint16_t index, std::uint8_t sub, const Bytes& value) const {
  return std::ranges::find(written, std::pair{Object{index, sub}, value}) != written.end();
}

fcopm::SlavePdo fcopm_pdo(std::uint16_t number, std::uint8_t type, const std::vector<int>& bits) {
  fcopm::SlavePdo pdo{.number = number, .type = type};
  std::uint16_t index = 0x2000;
  for (const int each : bits)
    pdo.objects.push_back({.index = index++, .sub = 0, .bits = static_cast<std::uint8_t>(each)});
  return pdo;
}

fcopm::SlaveSetting& FcopmCard::list_only(std::uint8_t node_id) {
  return configuration.slaves.emplace_back(fcopm::SlaveSetting{.node_id = node_id});
}

fcopm::SlaveSetting& FcopmCard::list(std::uint8_t node_id) {
  slaves[node_id].objects[{0x1000, 0}] = {0, 0, 0, 0};
  return list_only(node_id);
}

void FcopmCard::power_on() {
  card.download(configuration);
  card.power_on(now);
  run(1s);
}

void FcopmCard::start(can::Duration wait) {
  power_on();
  run(wait);
  forget();
}

void FcopmCard::run(can::Duration duration) {
  const can::Time end = now + duration;
  settle();
  for (;;) {
    can::Time next = std::max(card.deadline(), now);
    for (const auto& [node, slave] : slaves) next = std::min(next, std::max(slave.next_beat, now));
    if (next > end) break;
    now = next;
    if (card.deadline() <= now) card.tick(now);
    for (auto& [node, slave] : slaves)
      if (slave.next_beat <= now) beat(node, slave);
    settle();
  }
  now = end;
}

void FcopmCard::receive(std::uint32_t identifier, const Bytes& bytes) {
  card.receive(can::data_frame(identifier, bytes), now);
  settle();
}

void FcopmCard::settle() {
  bus.completing.clear();
  while (!bus.sent.empty()) {
    const can::Frame frame = bus.sent.front();
    bus.sent.pop_front();
    frames.push_back({now, frame});
    card.transmitted(frame, now);
    receive(frame);
  }
}

void FcopmCard::receive(const can::Frame& frame) {
  for (auto& [node_id, slave] : slaves) {
    if (!slave.is_there) continue;
    if (frame.identifier == 0x600U + node_id && slave.answers) answer(node_id, slave, frame);
    if (frame.identifier != 0 || (frame.data[1] != 0 && frame.data[1] != node_id)) continue;
    switch (frame.data[0]) {
      case 0x01: slave.state = 0x05; break;
      case 0x02: slave.state = 0x04; break;
      case 0x80: slave.state = 0x7F; break;
      default:
        slave.state = 0x7F;
        slave.next_beat = can::never;
        card.receive(can::data_frame(0x700U + node_id, {0x00}), now);
    }
  }
}

void FcopmCard::beat(std::uint8_t node_id, FcopmSlave& slave) {
  const Bytes& time = slave.objects[{0x1017, 0}];
  const int milliseconds = time.size() == 2 ? time[0] | time[1] << 8 : 0;
  slave.next_beat = milliseconds == 0 ? can::never : now + std::chrono::milliseconds(milliseconds);
  if (milliseconds == 0 || !slave.beats || !slave.is_there) return;
  card.receive(can::data_frame(0x700U + node_id, {slave.state}), now);
}

void FcopmCard::answer(std::uint8_t node_id, FcopmSlave& slave, const can::Frame& frame) {
  const auto index = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
  const FcopmSlave::Object object{index, frame.data[3]};
  Bytes reply{0x60, frame.data[1], frame.data[2], frame.data[3], 0, 0, 0, 0};
  const auto abort = [&](std::uint32_t code) {
    reply[0] = 0x80;
    for (unsigned i = 0; i < 4; ++i) reply[4 + i] = static_cast<std::uint8_t>(code >> 8 * i);
  };
  if (frame.data[0] == 0x40) {
    const auto found = slave.objects.find(object);
    if (found == slave.objects.end()) {
      abort(0x06020000);
    } else {
      reply[0] = static_cast<std::uint8_t>(0x43 | (4 - found->second.size()) << 2);
      std::ranges::copy(found->second, reply.begin() + 4);
    }
  } else if ((frame.data[0] & 0xE3) == 0x23) {
    const Bytes value(frame.data.begin() + 4, frame.data.begin() + 8 - (frame.data[0] >> 2 & 3));
    if (const auto refused = slave.refused.find(object); refused != slave.refused.end()) {
      abort(refused->second);
    } else {
      slave.objects[object] = value;
      slave.written.emplace_back(object, value);
      if (index == 0x1017) slave.next_beat = now + std::chrono::milliseconds(1);
    }
  } else {
    return;
  }
  card.receive(can::data_frame(0x580U + node_id, reply), now);
}

void FcopmCard::request(const Words& words, can::Duration wait) {
  for (std::size_t i = words.size(); i-- > 0;) set_d(25000U + static_cast<std::uint32_t>(i), words[i]);
  run(wait);
}

Words FcopmCard::response(std::size_t count) {
  Words words;
  for (std::size_t i = 0; i < count; ++i) words.push_back(d(24000U + static_cast<std::uint32_t>(i)));
  return words;
}

std::vector<Bytes> FcopmCard::sent(std::uint32_t identifier) const {
  std::vector<Bytes> found;
  for (const FcopmFrame& each : frames)
    if (each.frame.identifier == identifier)
      found.emplace_back(each.frame.bytes().begin(), each.frame.bytes().end());
  return found;
}

std::vector<can::Time> FcopmCard::times(std::uint32_t identifier) const {
  std::vector<can::Time> found;
  for (const FcopmFrame& each : frames)
    if (each.frame.identifier == identifier) found.push_back(each.at);
  return found;
}

}  // namespace canopus::scenario
