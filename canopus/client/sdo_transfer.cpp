#include "canopus/client/sdo_transfer.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/hex.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/text/byte_size.hpp"

namespace canopus::client {

using canopen::AbortCode;

AbortCode abort_on_bus(AbortCode code) noexcept {
  return code == canopen::SdoClient::buffer_too_small ? AbortCode::out_of_memory : code;
}

std::string describe_abort(AbortCode code, bool aborted_by_server, can::Duration time_out,
                           std::size_t limit) {
  if (code == canopen::SdoClient::buffer_too_small) {
    return fmt::format("the value is longer than the limit of {}", text::describe_byte_size(limit));
  }
  if (code == AbortCode::timed_out && !aborted_by_server) {
    return fmt::format("no answer within {}", text::describe_duration(time_out));
  }
  return fmt::format("{}abort {:08X}H: {}", aborted_by_server ? "" : "given up with ",
                     static_cast<std::uint32_t>(code), canopen::describe(code));
}

std::string describe_short_answer(const can::Frame& answer) {
  const auto bytes = answer.bytes();
  return fmt::format("its answer has {}, expected 8{}{}", ascii::counted(bytes.size(), "byte"),
                     bytes.empty() ? "" : ": ", ascii::hex_bytes(bytes, " "));
}

double SdoSpeed::rate() const noexcept {
  const double seconds = can::seconds(can::Time{time});
  return seconds > 0 ? static_cast<double>(bytes) / seconds / 1000 : 0;
}

std::string_view name(SdoSpeed::Form form) noexcept {
  switch (form) {
    case SdoSpeed::Form::expedited: return "expedited";
    case SdoSpeed::Form::segmented: return "segmented";
    case SdoSpeed::Form::block: return "block";
  }
  return "";
}

std::string describe(const SdoSpeed& speed) {
  const double seconds = can::seconds(can::Time{speed.time});
  const std::string time =
      seconds < 1 ? fmt::format("{:.1f} ms", 1000 * seconds) : fmt::format("{:.2f} s", seconds);
  return fmt::format("{} in {}, {:.1f} kB/s, {}", ascii::counted(speed.bytes, "byte"), time, speed.rate(),
                     name(speed.form));
}

AbortCode SdoTransfer::Collector::write(std::span<const std::uint8_t> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
  if (progress_) progress_(bytes.size(), 0);
  return AbortCode::none;
}

std::expected<std::size_t, AbortCode> SdoTransfer::Source::read(std::span<std::uint8_t> into) {
  const std::size_t size = std::min(into.size(), rest_.size());
  std::copy_n(rest_.begin(), size, into.begin());
  rest_ = rest_.subspan(size);
  if (progress_) progress_(size_ - rest_.size(), size_);
  return size;
}

SdoTransfer::SdoTransfer(can::Sink& bus, std::uint8_t node_id, can::Duration time_out, bool block)
    : time_out_(time_out), block_(block), client_(bus) {
  client_.set_server(node_id);
  // Who asks for blocks gets blocks. npm canopen 6 as a server takes the threshold for a part of the block
  // size.
  client_.set_switch_threshold(0);
}

canopen::SdoClient::Mode SdoTransfer::mode() const {
  return block_ ? canopen::SdoClient::Mode::block : canopen::SdoClient::Mode::segmented;
}

void SdoTransfer::receive(const can::Frame& frame, can::Time now) {
  constexpr unsigned initiate_upload = 2;
  constexpr unsigned abort = 4;
  const bool answers = client_.busy() && !frame.extended && !frame.remote && frame.length() == 8 &&
                       frame.identifier == canopen::cob_id::sdo_response + client_.server();
  const unsigned command = frame.data[0] >> 5;
  client_.receive(frame, now);
  if (answers && !client_.busy()) {  // it ended the transfer
    // A segment of a block begins with its number, which can look like either command.
    aborted_by_server_ = command == abort && !client_.gave_up();
    switched_ = block_ && command == initiate_upload && client_.abort_code() == AbortCode::command_specifier;
    constexpr unsigned expedited_bit = 0x02;
    if (!written_) is_expedited_ = command == initiate_upload && (frame.data[0] & expedited_bit) != 0;
  }
  conclude();
}

void SdoTransfer::tick(can::Time now) {
  client_.tick(now);
  conclude();
}

/// What ended the transfer is known now.
void SdoTransfer::conclude() {
  using enum SdoSpeed::Form;
  if (!ended_ || std::exchange(is_finished_, true)) return;
  if (client_.abort_code() == AbortCode::none) {
    speed_ = {written_.value_or(collector_.bytes.size()), can::Duration{*ended_ - begun_},
              block_          ? block
              : is_expedited_ ? expedited
                              : segmented,
              written_ || client_.is_size_indicated()};
  }
}

void SdoTransfer::begin(can::Time now) {
  is_finished_ = aborted_by_server_ = switched_ = is_expedited_ = false;
  collector_.bytes.clear();
  written_.reset();
  ended_.reset();
  begun_ = now;
}

void SdoTransfer::sdo_finished(canopen::SdoClient&, can::Time now) { ended_ = now; }

bool SdoTransfer::read(text::ObjectName object, can::Time now) {
  begin(now);
  return client_.upload(object.index, object.sub, *this, now, time_out_, mode(), &collector_);
}

bool SdoTransfer::write(text::ObjectName object, std::span<const std::uint8_t> value, can::Time now) {
  begin(now);
  constexpr std::size_t expedited = 4;
  written_ = value.size();
  is_expedited_ = !block_ && !value.empty() && value.size() <= expedited;
  if (!block_ && (value.size() <= expedited || !progress_))
    return client_.download(object.index, object.sub, value, *this, now, time_out_, mode());
  source_.emplace(value, progress_);
  return client_.download(object.index, object.sub, *source_, static_cast<std::uint32_t>(value.size()), *this,
                          now, time_out_, mode());
}

void SdoTransfer::cancel() {
  if (client_.busy()) client_.cancel(AbortCode::general);
}

std::expected<std::vector<std::uint8_t>, SdoFailure> SdoTransfer::result() {
  const AbortCode code = client_.abort_code();
  if (code == AbortCode::none) return std::exchange(collector_.bytes, {});
  if (const can::Frame* answer = client_.short_answer())
    return std::unexpected(SdoFailure{code, describe_short_answer(*answer)});
  if (switched_) {
    return std::unexpected(
        SdoFailure{code, "it answers the block upload with an ordinary one; without --block it can be read"});
  }
  std::string reason = describe_abort(code, aborted_by_server_, time_out_, client_.maximum_size());
  const bool unknown = block_ && aborted_by_server_ && code == AbortCode::command_specifier;
  if (unknown) reason += "; without --block it may work";
  return std::unexpected(SdoFailure{code, std::move(reason)});
}

}  // namespace canopus::client
