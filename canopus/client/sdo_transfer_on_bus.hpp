#pragma once
// One SDO transfer at a time over a bus of the command line, waited for.

#include <cstdint>
#include <expected>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/link/bus_loop.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::client {

using link::BusLoop;

/// Why a transfer failed.
struct SdoFailure {
  canopen::AbortCode code = canopen::AbortCode::none;  ///< none: the bus, `reason` says what
  std::string reason;  ///< "abort 06020000H: object does not exist", "no answer within 500.0 ms"
};

/// How a transfer went.
struct SdoSpeed {
  enum class Form : std::uint8_t { expedited, segmented, block };
  std::size_t bytes = 0;
  can::Duration time{};  ///< from the request to the last answer
  Form form = Form::expedited;

  /// In kB/s, 1000 bytes each; 0: it took no time.
  [[nodiscard]] double rate() const noexcept;
};
[[nodiscard]] std::string_view name(SdoSpeed::Form form) noexcept;
/// "70000 bytes in 1.23 s, 56.9 kB/s, segmented"
[[nodiscard]] std::string describe(const SdoSpeed& speed);

class SdoOnBus final : public can::Participant, private canopen::SdoClientListener {
 public:
  /// Gets how many bytes have passed, of how many (0 = not known), every now and then.
  using Progress = std::function<void(std::size_t bytes, std::size_t of)>;

  /// `block`: block transfers, also of values that would fit into one frame; a server that does otherwise is
  /// a failure.
  SdoOnBus(BusLoop& bus, std::uint8_t node_id, can::Duration time_out, bool block);
  ~SdoOnBus() override;
  SdoOnBus(const SdoOnBus&) = delete;
  SdoOnBus& operator=(const SdoOnBus&) = delete;

  /// What read() takes, in bytes; at first SdoClient::default_maximum_size.
  void set_limit(std::size_t bytes) noexcept { client_.set_maximum_size(bytes); }
  void set_progress(Progress progress) { progress_ = std::move(progress); }
  std::expected<std::vector<std::uint8_t>, SdoFailure> read(text::ObjectName object);
  std::expected<void, SdoFailure> write(text::ObjectName object, std::span<const std::uint8_t> value);

  /// Of the last transfer that succeeded.
  [[nodiscard]] const SdoSpeed& speed() const noexcept { return speed_; }

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override { client_.tick(now); }

 private:
  void sdo_finished(canopen::SdoClient& client, can::Time now) override;
  std::expected<void, SdoFailure> wait(bool started);
  void begin();
  void note_speed(std::size_t bytes, bool was_expedited);
  [[nodiscard]] canopen::SdoClient::Mode mode() const;

  BusLoop& bus_;
  can::Duration time_out_;
  bool block_;
  Progress progress_;
  canopen::SdoClient client_;
  SdoSpeed speed_;
  can::Time begun_{};
  bool finished_ = false;
  bool was_expedited_ = false;  // the answer to an upload
  bool aborted_by_server_ = false;
  bool switched_ = false;  // asked for blocks, the server answered an upload expedited or in segments
};

/// The words for an abort code; `aborted_by_server`: it came over the bus. `limit`: the client's, which a value exceeds
/// where the code is SdoClient::buffer_too_small.
[[nodiscard]] std::string describe_abort(canopen::AbortCode code, bool aborted_by_server,
                                         can::Duration time_out,
                                         std::size_t limit = canopen::SdoClient::default_maximum_size);

/// As the server got the code: 05040005H for SdoClient::buffer_too_small, which is never on a bus.
[[nodiscard]] canopen::AbortCode abort_on_bus(canopen::AbortCode code) noexcept;

}  // namespace canopus::client
