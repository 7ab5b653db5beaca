#include "canopus/module/models/as_fcopm/message_requests.hpp"

#include <algorithm>
#include <utility>

#include "canopus/module/interface/word_bytes.hpp"

namespace canopus::module::as_fcopm {

namespace {

constexpr std::uint16_t word_of(unsigned high_byte, unsigned low_byte) {
  return static_cast<std::uint16_t>(high_byte << 8 | low_byte);
}

constexpr std::uint8_t command = 1;
constexpr std::uint8_t address_size = 4;  // index, sub-index and a reserved byte
constexpr std::uint8_t nmt_size = 4;
constexpr std::uint8_t written = 0x60;
constexpr std::uint8_t aborted = 0x80;
constexpr unsigned emergency_size = 2 + 8 * EmergencyLog::most_stored;
constexpr std::uint8_t all_nodes = 0x80;  // of NmtMaster::request_nmt()

/// [10.3.2] Reply code of a read; 0: no such length.
constexpr std::uint8_t reply_code(std::size_t bytes) {
  switch (bytes) {
    case 1: return 0x4F;
    case 2: return 0x4B;
    case 4: return 0x43;
    default: return 0;
  }
}

/// What 1F82H calls an NMT service, the own node left out; 0: there is no such service [10.4.2].
constexpr std::uint8_t request_of(std::uint8_t service) {
  switch (service) {
    case 0x01: return 0x85;
    case 0x02: return 0x84;
    case 0x80: return 0x8F;
    case 0x81: return 0x86;
    case 0x82: return 0x87;
    default: return 0;
  }
}

}  // namespace

void MessageRequests::header_written(std::uint16_t value) noexcept {
  is_asked_ = is_asked_ || high_byte(value) != last_id_;
  last_id_ = high_byte(value);
}

void MessageRequests::read_request(const Words& request, can::Time now) {
  if (!std::exchange(is_asked_, false)) return;
  if (request[0] == 0) {
    if (running_.none()) response_.fill(0);  // "No data transmission request"
    return;
  }
  const Header header{.id = high_byte(request[0]),
                      .type = high_byte(request[2]),
                      .node = low_byte(request[2]),
                      .size = low_byte(request[1])};
  if (low_byte(request[0]) != command) return answer(header, Status::illegal_command);
  switch (header.type) {
    case sdo_read:
    case sdo_write: return access(header, request, now);
    case nmt: return send_nmt(header, request, now);
    case read_emergencies: return show_emergencies(header);
    default: return answer(header, Status::illegal_type);
  }
}

void MessageRequests::answer(const Header& header, Status status) {
  response_.fill(0);
  response_[0] = word_of(header.id, static_cast<unsigned>(status));
  response_[2] = header.node;
}

void MessageRequests::access(const Header& header, const Words& request, can::Time now) {
  const bool reads = header.type == sdo_read;
  if (!is_slave(header.node) || header.node == own_node_) return answer(header, Status::wrong_node);
  const unsigned bytes = reads ? 0U : static_cast<unsigned>(header.size) - address_size;
  const bool size_is_good = reads ? header.size == address_size : (bytes == 1 || bytes == 2 || bytes == 4);
  if (!size_is_good) return answer(header, Status::illegal_length);
  if (running_[header.node]) return answer(header, Status::busy);
  const std::uint16_t index = request[3];
  const std::uint8_t sub = low_byte(request[4]);
  const std::array<std::uint8_t, 4> value{low_byte(request[5]), high_byte(request[5]), low_byte(request[6]),
                                          high_byte(request[6])};
  running_.set(header.node);
  answer(header, Status::transmitting);
  const auto done = [this, header](const manager::SdoResult& result, can::Time) {
    access_done(header, result);
  };
  const canopen::AbortCode refused =
      reads ? master_.read_object(header.node, index, sub, done, now)
            : master_.write_object(header.node, index, sub, std::span(value).first(bytes), done, now);
  if (refused == canopen::AbortCode::none) return;
  // The master itself is Stopped: no SDO goes out.
  running_.reset(header.node);
  answer(header, Status::time_out);
}

void MessageRequests::access_done(const Header& header, const manager::SdoResult& result) {
  running_.reset(header.node);
  if (result.abort_code == canopen::AbortCode::timed_out ||
      result.abort_code == canopen::AbortCode::device_state)
    return answer(header, Status::time_out);
  std::uint8_t code = written;
  std::array<std::uint8_t, 4> data{};
  std::size_t length = 0;
  Status status = Status::success;
  if (result.abort_code != canopen::AbortCode::none) {
    status = Status::error_message;
    code = aborted;
    length = data.size();
    const auto abort = static_cast<std::uint32_t>(result.abort_code);
    for (std::size_t i = 0; i < length; ++i) data[i] = static_cast<std::uint8_t>(abort >> 8 * i);
  } else if (header.type == sdo_read) {
    code = reply_code(result.data.size());
    if (code == 0) return answer(header, Status::illegal_response_length);
    length = result.data.size();
    std::ranges::copy(result.data, data.begin());
  }
  answer(header, status);
  response_[1] = static_cast<std::uint16_t>(address_size + length);
  response_[2] = word_of(code, header.node);
  response_[3] = result.index;
  response_[4] = result.sub;
  response_[5] = word_of(data[1], data[0]);
  response_[6] = word_of(data[3], data[2]);
}

void MessageRequests::send_nmt(const Header& header, const Words& request, can::Time now) {
  const std::uint8_t service = request_of(low_byte(request[3]));
  const std::uint8_t node = low_byte(request[4]);
  if (header.size != nmt_size) return answer(header, Status::illegal_length);
  if (header.node > 127 || header.node != node || (node != 0 && node == own_node_))
    return answer(header, Status::wrong_node);
  if (service == 0) return answer(header, Status::illegal_command);
  if (node != 0 && running_[node]) return answer(header, Status::busy);
  const auto refused = master_.request_nmt(node == 0 ? all_nodes : node, service, now);
  answer(header, refused == canopen::AbortCode::none ? Status::success : Status::busy);
}

void MessageRequests::show_emergencies(const Header& header) {
  if (header.size != 0) return answer(header, Status::illegal_length);
  if (!is_slave(header.node)) return answer(header, Status::wrong_node);
  if (running_[header.node]) return answer(header, Status::busy);
  const EmergencyLog::Messages& messages = emergencies_.of(header.node);
  answer(header, Status::success);
  response_[1] = emergency_size;
  response_[2] = word_of(read_emergencies, header.node);
  response_[3] = word_of(messages.total, messages.stored);
  for (std::size_t i = 0; i < messages.stored; ++i) {
    const EmergencyLog::Bytes& bytes = messages.latest[i];
    for (std::size_t word = 0; word < 4; ++word)
      response_[4 + 4 * i + word] = word_of(bytes[2 * word + 1], bytes[2 * word]);
  }
}

}  // namespace canopus::module::as_fcopm
