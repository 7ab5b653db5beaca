#pragma once
// EMCY producer [CiA 301 7.2.7]: eight bytes with the identifier of 1014H (default 080H + node-ID, bit 31 =
// off): bytes 0-1 error code, 2 error register 1001H, 3-7 manufacturer specific. It is sent once when an
// error appears and, with code 0000H, when errors are gone, in Pre-operational and Operational, at least
// 1015H times 100 us apart. 1003H holds the last codes, newest at sub-index 01H, sub-index 00H their number;
// writing 0 there deletes them.
//
// Two sources: the application (raise(), reset(), which refuse what cannot be sent now) and the node's own
// services (error_began(), error_ended(), whose messages wait for the end of the inhibit time; bit 4 of 1001H
// stands for them and falls when the last of them has ended).
//
// Checks: 1003:00 other than 0 06090030H, other sub-indexes 06010002H, reading an empty one 08000024H;
// 1014H: COB-ID rules.

#include <array>
#include <span>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

class EmcyProducer final : public ObjectHandler {
 public:
  explicit EmcyProducer(NodeContext& node);

  /// Reads 1014H and 1015H; no error is active.
  void start();
  void stop();

  /// Bits are OR-ed into 1001H (and bit 0 for any code from 0100H on). False, and nothing changes, while
  /// 1015H runs or in Stopped.
  bool raise(std::uint16_t code, std::uint8_t error_register, std::span<const std::uint8_t, 5> manufacturer,
             can::Time now);
  /// Takes every entry with this code and these first two bytes out of 1003H. When that leaves none, 1001H is cleared
  /// and code 0000H sent.
  void forget(std::uint16_t code, std::span<const std::uint8_t, 5> manufacturer, can::Time now);
  /// Clears 1001H, sends code 0000H. False as above.
  bool reset(can::Time now);

  void error_began(const CommunicationError& error, can::Time now);
  void error_ended(const CommunicationError& error, can::Time now);
  void tick(can::Time now);
  [[nodiscard]] TimerQueue::Number timer() const noexcept { return timer_; }

  AbortCode before_read(ObjectDictionary&, const Entry&, can::Time) override;
  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>, can::Time) override;
  void after_write(ObjectDictionary&, const Entry&, can::Time) override;

 private:
  using Message = std::array<std::uint8_t, 8>;
  static constexpr std::uint8_t generic_error = 0x01;
  static constexpr std::uint8_t communication_error = 0x10;

  void read();
  void remember(std::uint16_t code, std::uint8_t first, std::uint8_t second);
  /// As 1003H shows an error with these first two manufacturer bytes.
  [[nodiscard]] std::uint32_t history_field(std::uint16_t code, std::uint8_t first,
                                            std::uint8_t second) const noexcept;
  void history_emptied(can::Time now);
  void send(const Message& message, can::Time now);
  void send_or_wait(const CommunicationError& error, can::Time now);
  [[nodiscard]] bool inhibited(can::Time now) const noexcept { return now < inhibited_until_; }

  NodeContext& node_;
  TimerQueue::Number timer_;
  CobId cob_id_;
  can::Duration inhibit_time_{};
  can::Time inhibited_until_{};
  std::array<Message, 4> waiting_{};  // messages of services during the inhibit time, oldest first
  std::uint8_t waiting_count_ = 0;
  std::uint16_t active_errors_ = 0;  // of services
};

}  // namespace canopus::canopen
