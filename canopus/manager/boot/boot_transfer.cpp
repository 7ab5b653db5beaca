#include "canopus/manager/boot/boot_transfer.hpp"

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/sdo/uploaded_value.hpp"

namespace canopus::manager {

BootTransfer::BootTransfer(std::uint8_t node_id, BootHost& host, can::Sink& sink, BootRecord& record,
                           BootTransferListener& listener)
    : node_id_(node_id), host_(&host), record_(&record), listener_(&listener), client_(sink) {
  client_.set_server(node_id);
  alarm_.add_part(retry_);
  alarm_.add_part(client_.alarm());
}

void BootTransfer::read(std::uint16_t index, std::uint8_t sub, can::Time now) {
  begin(Kind::read, index, sub, now);
}

void BootTransfer::write(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data,
                         can::Time now) {
  data_ = data;
  begin(Kind::write, index, sub, now);
}

void BootTransfer::write_program(std::uint16_t index, std::uint8_t sub, const Program& program,
                                 can::Time now) {
  program_ = program;
  begin(Kind::program, index, sub, now);
}

void BootTransfer::begin(Kind kind, std::uint16_t index, std::uint8_t sub, can::Time now) {
  kind_ = kind;
  record_->index = index;
  record_->sub = sub;
  host_->boot_went_on(node_id_, *record_, now);
  repeat(now);
}

void BootTransfer::repeat(can::Time now) {
  waits_for_channel_ = false;
  const MasterOptions& options = host_->boot_options();
  if (uses_blocks() && host_->blocks_running() >= options.blocks_at_once) {
    return repeat_later(options.busy_retry, now);
  }
  if (host_->sdo_channel_free(node_id_, now) && start(now)) return forget();
  repeat_later(options.busy_retry, now);
  waits_for_channel_ = true;
}

void BootTransfer::repeat_later(can::Duration pause, can::Time now) {
  waits_for_channel_ = false;
  retry_ = later(now, pause);
}

void BootTransfer::read_later(can::Duration pause, can::Time now) {
  kind_ = Kind::read;
  repeat_later(pause, now);
}

void BootTransfer::forget() noexcept {
  waits_for_channel_ = false;
  retry_.cancel();
}

void BootTransfer::stop() {
  if (client_.busy()) client_.cancel(canopen::AbortCode::general);
  forget();
}

void BootTransfer::channel_freed(can::Time now) {
  if (waits_for_channel_) repeat(now);
}

bool BootTransfer::uses_blocks() const {
  if (no_blocks_ || kind_ == Kind::read) return false;
  const std::size_t block_from = host_->boot_options().block_from;
  return kind_ == Kind::program || (block_from != 0 && data_.size() >= block_from);
}

bool BootTransfer::start(can::Time now) {
  using Mode = canopen::SdoClient::Mode;
  const MasterOptions& options = host_->boot_options();
  const bool slow = record_->step == BootStep::program_clear || record_->step == BootStep::program_download;
  const can::Duration time_out = slow ? options.program_time_out : options.sdo_time_out;
  in_blocks_ = uses_blocks();
  requested_at_ = now;
  const Mode mode = in_blocks_ ? Mode::block : Mode::segmented;
  switch (kind_) {
    case Kind::read: return client_.upload(record_->index, record_->sub, *this, now, time_out);
    case Kind::write:
      return client_.download(record_->index, record_->sub, data_, *this, now, time_out, mode);
    case Kind::program: break;
  }
  return client_.download(record_->index, record_->sub, *this, program_.size, *this, now, time_out, mode);
}

std::expected<std::size_t, canopen::AbortCode> BootTransfer::read(std::span<std::uint8_t> into) {
  const auto count = program_.bytes->read(into);
  if (count) record_->bytes += static_cast<std::uint32_t>(*count);
  return count;
}

bool BootTransfer::blocks_refused(bool rebooted) const noexcept {
  const bool is_program = kind_ == Kind::program;
  switch (record_->abort_code) {
    case canopen::AbortCode::timed_out: return in_blocks_ && (!is_program || record_->bytes == 0);
    case canopen::AbortCode::command_specifier:
    case canopen::AbortCode::block_size:
    case canopen::AbortCode::sequence_number:
    case canopen::AbortCode::crc:
    case canopen::AbortCode::unsupported_access: return in_blocks_ && !(is_program && rebooted);
    default: return false;
  }
}

std::uint32_t BootTransfer::value() const noexcept {
  // Of the objects that a boot reads 1F51H alone is UNSIGNED8, the others are UNSIGNED32 [CiA 302-3].
  const std::size_t length = record_->index == 0x1F51 ? 1 : 4;
  return can::load_u32(canopen::uploaded_value(client_.data(), client_.is_size_indicated(), length).bytes);
}

void BootTransfer::tick(can::Time now) {
  if (client_.alarm() <= now) {
    if (host_->request_waits(node_id_, now)) client_.count_from(now);
    client_.tick(now);
  }
  if (retry_ > now) return;
  retry_.cancel();
  repeat(now);
}

void BootTransfer::sdo_finished(canopen::SdoClient& client, can::Time now) {
  record_->abort_code = client.abort_code();
  const can::Frame* const answer = client.short_answer();
  record_->answer_length = answer != nullptr ? answer->dlc : BootRecord::whole_answer;
  listener_->transfer_ended(now);
}

}  // namespace canopus::manager
