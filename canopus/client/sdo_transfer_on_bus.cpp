#include "canopus/client/sdo_transfer_on_bus.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/canopen/service/nmt.hpp"
#include "canopus/text/byte_size.hpp"

namespace canopus::client {
namespace {

using canopen::AbortCode;

class Collector final : public canopen::ByteSink {
 public:
  explicit Collector(const SdoOnBus::Progress& progress) : progress_(progress) {}
  AbortCode write(std::span<const std::uint8_t> bytes) override {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    if (progress_) progress_(bytes_.size(), 0);
    return AbortCode::none;
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  const SdoOnBus::Progress& progress_;
  std::vector<std::uint8_t> bytes_;
};

class Giver final : public canopen::ByteSource {
 public:
  Giver(std::span<const std::uint8_t> bytes, const SdoOnBus::Progress& progress)
      : rest_(bytes), size_(bytes.size()), progress_(progress) {}
  std::expected<std::size_t, AbortCode> read(std::span<std::uint8_t> into) override {
    const std::size_t size = std::min(into.size(), rest_.size());
    std::copy_n(rest_.begin(), size, into.begin());
    rest_ = rest_.subspan(size);
    if (progress_) progress_(size_ - rest_.size(), size_);
    return size;
  }

 private:
  std::span<const std::uint8_t> rest_;
  std::size_t size_;
  const SdoOnBus::Progress& progress_;
};

}  // namespace

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
  return fmt::format("{} byte{} in {}, {:.1f} kB/s, {}", speed.bytes, speed.bytes == 1 ? "" : "s", time,
                     speed.rate(), name(speed.form));
}

SdoOnBus::SdoOnBus(BusLoop& bus, std::uint8_t node_id, can::Duration time_out, bool block)
    : bus_(bus), time_out_(time_out), block_(block), client_(bus) {
  client_.set_server(node_id);
  // Who asks for blocks gets blocks. npm canopen 6 as a server takes the threshold for a part of the block
  // size.
  client_.set_switch_threshold(0);
  alarm().add_part(client_.alarm());
  bus_.add(*this);
}

SdoOnBus::~SdoOnBus() {
  if (client_.busy()) client_.cancel(AbortCode::general);
  bus_.remove(*this);
}

canopen::SdoClient::Mode SdoOnBus::mode() const {
  return block_ ? canopen::SdoClient::Mode::block : canopen::SdoClient::Mode::segmented;
}

void SdoOnBus::receive(const can::Frame& frame, can::Time now) {
  constexpr unsigned initiate_upload = 2;
  constexpr unsigned abort = 4;
  const bool answers = client_.busy() && !frame.extended && !frame.remote && frame.length() == 8 &&
                       frame.identifier == canopen::cob_id::sdo_response + client_.server();
  const unsigned command = frame.data[0] >> 5;
  client_.receive(frame, now);
  if (!answers || client_.busy()) return;  // not what ended the transfer
  // A segment of a block begins with its number, which can look like either command.
  aborted_by_server_ = command == abort && !client_.gave_up();
  switched_ = block_ && command == initiate_upload && client_.abort_code() == AbortCode::command_specifier;
  constexpr unsigned expedited_bit = 0x02;
  was_expedited_ = command == initiate_upload && (frame.data[0] & expedited_bit) != 0;
}

void SdoOnBus::begin() {
  finished_ = aborted_by_server_ = switched_ = was_expedited_ = false;
  begun_ = bus_.now();
}

void SdoOnBus::note_speed(std::size_t bytes, bool was_expedited) {
  using enum SdoSpeed::Form;
  speed_ = {bytes, can::Duration{bus_.now() - begun_},
            block_          ? block
            : was_expedited ? expedited
                            : segmented};
}

void SdoOnBus::sdo_finished(canopen::SdoClient&, can::Time) { finished_ = true; }

std::expected<void, SdoFailure> SdoOnBus::wait(bool started) {
  if (!started) return std::unexpected(SdoFailure{.reason = "the bus takes no frame"});
  switch (bus_.run([this] { return finished_; })) {
    case BusLoop::End::done: break;
    case BusLoop::End::interrupted:
      client_.cancel(AbortCode::general);
      return std::unexpected(SdoFailure{.reason = "interrupted"});
    default: return std::unexpected(SdoFailure{.reason = bus_.failure()});
  }
  const AbortCode code = client_.abort_code();
  if (code == AbortCode::none) return {};
  if (switched_) {
    return std::unexpected(
        SdoFailure{code, "it answers the block upload with an ordinary one; without --block it can be read"});
  }
  std::string reason = describe_abort(code, aborted_by_server_, time_out_, client_.maximum_size());
  const bool unknown = block_ && aborted_by_server_ && code == AbortCode::command_specifier;
  if (unknown) reason += "; without --block it may work";
  return std::unexpected(SdoFailure{code, std::move(reason)});
}

std::expected<std::vector<std::uint8_t>, SdoFailure> SdoOnBus::read(text::ObjectName object) {
  begin();
  Collector collector(progress_);
  const auto result =
      wait(client_.upload(object.index, object.sub, *this, bus_.now(), time_out_, mode(), &collector));
  if (!result) return std::unexpected(result.error());
  auto bytes = collector.take();
  note_speed(bytes.size(), was_expedited_);
  return bytes;
}

std::expected<void, SdoFailure> SdoOnBus::write(text::ObjectName object,
                                                std::span<const std::uint8_t> value) {
  begin();
  constexpr std::size_t expedited = 4;
  const bool is_expedited = !block_ && !value.empty() && value.size() <= expedited;
  std::expected<void, SdoFailure> result;
  if (!block_ && (value.size() <= expedited || !progress_)) {
    result = wait(client_.download(object.index, object.sub, value, *this, bus_.now(), time_out_, mode()));
  } else {
    Giver giver(value, progress_);
    result = wait(client_.download(object.index, object.sub, giver, static_cast<std::uint32_t>(value.size()),
                                   *this, bus_.now(), time_out_, mode()));
  }
  if (result) note_speed(value.size(), is_expedited);
  return result;
}

}  // namespace canopus::client
