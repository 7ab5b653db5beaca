// Any bytes as what comes from an slcan adapter, from a multicast group, from a cannelloni and from netlink: frames stay
// well formed, and what was read goes out and comes back the same.

#include <array>
#include <span>
#include <string_view>

#include "canopus/link/cannelloni/cannelloni_records.hpp"
#include "canopus/link/slcan/slcan_text.hpp"
#include "canopus/link/socketcan/netlink.hpp"
#include "canopus/link/udp_multicast/multicast_datagram.hpp"

#include "input.hpp"

using namespace canopus;
using fuzz::expect;

namespace {

void slcan(std::span<const std::uint8_t> bytes) {
  link::SlcanReader reader;
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  while (!rest.empty()) {
    const std::size_t size =
        std::min<std::size_t>(rest.size(), 1 + static_cast<unsigned char>(rest[0]) % 40U);
    reader.receive(rest.substr(0, size), [](const link::SlcanLine& line) {
      if (line.kind != link::SlcanLine::Kind::frame) return;
      fuzz::expect_well_formed(line.frame);
      std::array<char, link::slcan_max_line> out;
      const std::size_t length = link::write_slcan_frame(out, line.frame);
      link::SlcanReader again;
      again.receive({out.data(), length},
                    [&line](const link::SlcanLine& same) { expect(same.frame == line.frame); });
    });
    rest.remove_prefix(size);
  }
}

void multicast(std::span<const std::uint8_t> bytes) {
  const auto message = link::read_multicast_datagram(bytes);
  if (!message || message->kind != link::MulticastMessage::Kind::frame) return;
  fuzz::expect_well_formed(message->frame);
  std::array<std::uint8_t, link::multicast_max_datagram> out;
  const std::size_t length = link::write_multicast_datagram(out, message->frame, message->time);
  const auto again = link::read_multicast_datagram(std::span(out).first(length));
  expect(again.has_value() && again->frame == message->frame);
}

void cannelloni(std::span<const std::uint8_t> bytes) {
  if (link::CannelloniDatagram datagram; link::read_cannelloni_datagram(bytes, datagram)) {
    for (const auto& record : datagram.records) {
      if (record.kind == link::CannelloniRecord::Kind::frame) fuzz::expect_well_formed(record.frame);
    }
  }
  auto rest = bytes;
  while (const auto record = link::next_cannelloni_record(rest)) {
    if (record->kind == link::CannelloniRecord::Kind::wrong) break;
    if (record->kind != link::CannelloniRecord::Kind::frame) continue;
    std::string out;
    link::append_cannelloni_record(out, record->frame);
    std::span<const std::uint8_t> written(reinterpret_cast<const std::uint8_t*>(out.data()), out.size());
    const auto again = link::next_cannelloni_record(written);
    expect(again.has_value() && again->frame == record->frame && written.empty());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  switch (data[0] % 4) {
    case 0: slcan(bytes); break;
    case 1: multicast(bytes); break;
    case 2: cannelloni(bytes); break;
    default:
      for (const auto& message : link::read_link_messages(bytes))
        expect(message.error >= 0 && message.error < 4096);
      break;
  }
  return 0;
}
