#pragma once
// The card as slave: 8 + 8 PDOs of 32 words each way [AS-FCOPM 10.1.1, 10.1.2, 10.7].

#include <array>

#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/module/models/as_fcopm/register_table.hpp"
#include "canopus/module/models/as_fcopm/role.hpp"

namespace canopus::module::as_fcopm {

class SlaveRole final : public Role, private canopen::NodeListener, private canopen::ObjectHandler {
 public:
  static constexpr std::uint16_t pdos = 8;

  /// `sink` must outlive it.
  SlaveRole(std::shared_ptr<const canopen::DictionaryDescription> objects, std::uint8_t node_id,
            can::Sink& sink, const Profile& profile);

  [[nodiscard]] const canopen::Node& node() const noexcept override { return node_; }
  void start(can::Time now) override { node_.power_on(now); }
  void stop(can::Time now) override;
  void bus_off(can::Time now) override { node_.communication_error(now); }
  void cpu_failed(bool failed, can::Time now) override;
  [[nodiscard]] std::uint16_t read(BufferAddress address) const noexcept override;
  void write(BufferAddress address, std::uint16_t value, can::Time now) override;
  [[nodiscard]] OwnCode code() const noexcept override;
  [[nodiscard]] OwnCode download_code() const noexcept override { return OwnCode::slave_downloading; }

  void receive(const can::Frame& frame, can::Time now) override { node_.receive(frame, now); }
  void transmitted(const can::Frame& frame, can::Time now) override { node_.transmitted(frame, now); }
  void tick(can::Time now) override;

 private:
  /// The error register has 0, 1 (generic) and 80H (internal) alone [10.3.2], in messages and in 1001H.
  class Outlet final : public can::Sink {
   public:
    Outlet(can::Sink& sink, std::uint8_t node_id) : sink_(sink), node_id_(node_id) {}
    bool send(const can::Frame& frame) override;

   private:
    can::Sink& sink_;
    std::uint8_t node_id_;
  };
  using Content = std::array<std::uint16_t, 4>;

  // NodeListener
  void nmt_state_changed(canopen::NmtState state, can::Time now) override;
  void reset_done(canopen::NmtCommand which, can::Time now) override;
  void rpdo_received(std::uint16_t number, can::Time now) override;
  void rpdo_length_wrong(std::uint16_t number, std::uint16_t code, can::Time now) override;
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) override;
  void heartbeat_lost(std::uint8_t node_id, can::Time now) override;
  void object_written(const canopen::Entry& entry, can::Time now) override;
  // ObjectHandler: 1001H
  canopen::AbortCode before_read(canopen::ObjectDictionary& objects, const canopen::Entry& entry,
                                 can::Time now) override;

  void send_changes(can::Time now);
  [[nodiscard]] Content content(std::uint16_t number) const noexcept;

  Outlet outlet_;
  canopen::Node node_;
  can::Alarm next_scan_;
  std::array<Content, pdos> sent_{};
  std::array<std::uint16_t, slave_words> outputs_{};
  unsigned wrong_lengths_ = 0;  // bit n: RxPDO n + 1
  unsigned taken_longer_ = 0;   // likewise: its data come although there were more
  bool heartbeat_is_lost_ = false;
  bool cpu_has_failed_ = false;
};

}  // namespace canopus::module::as_fcopm
