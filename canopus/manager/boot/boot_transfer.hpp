#pragma once
// The SDO transfers of one slave's boot, one at a time on the slave's default channel. A transfer waits for
// the channel when another user has it, and long values go in blocks as far as the slave knows them and not
// too many others do the same.
//
// Which object it is, how much of a program is on its way and how it ended stands in the boot's record.

#include <cstdint>
#include <expected>
#include <span>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/manager/boot/boot_host.hpp"

namespace canopus::manager {

/// Called when a transfer ended, well or not.
class BootTransferListener {
 public:
  virtual void transfer_ended(can::Time now) = 0;

 protected:
  ~BootTransferListener() = default;
};

class BootTransfer final : private canopen::SdoClientListener, private canopen::ByteSource {
 public:
  /// All must outlive it.
  BootTransfer(std::uint8_t node_id, BootHost& host, can::Sink& sink, BootRecord& record,
               BootTransferListener& listener);

  void read(std::uint16_t index, std::uint8_t sub, can::Time now);
  /// `data` must stay valid until the end.
  void write(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data, can::Time now);
  void write_program(std::uint16_t index, std::uint8_t sub, const Program& program, can::Time now);
  /// The same transfer once more.
  void repeat(can::Time now);
  void repeat_later(can::Duration pause, can::Time now);
  /// Reads the object of the last transfer.
  void read_later(can::Duration pause, can::Time now);
  /// Repeats nothing more.
  void forget() noexcept;
  /// Gives up what is running, too.
  void stop();
  /// The channel, which was not free, is so now.
  void channel_freed(can::Time now);

  /// What failed may go well without blocks: the slave refused them, or does not even say that it does not
  /// know them. `rebooted`: it restarted in the middle of a program, which is no question of blocks.
  [[nodiscard]] bool blocks_refused(bool rebooted) const noexcept;
  /// False: no blocks until it is allowed again.
  void allow_blocks(bool allowed) noexcept { no_blocks_ = !allowed; }
  [[nodiscard]] bool busy() const noexcept { return client_.busy(); }
  /// A block download goes on.
  [[nodiscard]] bool downloads_block() const noexcept { return client_.busy() && in_blocks_; }
  /// What was read last, as a number.
  [[nodiscard]] std::uint32_t value() const noexcept;
  /// When the last request was made, or got out on the bus.
  [[nodiscard]] can::Time requested_at() const noexcept { return requested_at_; }

  void receive(const can::Frame& frame, can::Time now) { client_.receive(frame, now); }
  /// The request got out on the bus.
  void transmitted(can::Time now) {
    client_.count_from(now);
    requested_at_ = now;
  }
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  enum class Kind : std::uint8_t { read, write, program };

  void sdo_finished(canopen::SdoClient& client, can::Time now) override;
  // The program, counted on its way.
  std::expected<std::size_t, canopen::AbortCode> read(std::span<std::uint8_t> into) override;
  void begin(Kind kind, std::uint16_t index, std::uint8_t sub, can::Time now);
  bool start(can::Time now);
  [[nodiscard]] bool uses_blocks() const;

  std::uint8_t node_id_;
  BootHost* host_;
  BootRecord* record_;
  BootTransferListener* listener_;
  canopen::SdoClient client_;
  Kind kind_ = Kind::read;
  std::span<const std::uint8_t> data_;  // what is written
  Program program_;
  bool in_blocks_ = false;          // the present transfer
  bool no_blocks_ = false;          // the slave does not know them
  bool waits_for_channel_ = false;  // else a repetition waits for its pause
  can::Time requested_at_{};
  can::Alarm retry_;
  can::Alarm alarm_;  // with the client's
};

}  // namespace canopus::manager
