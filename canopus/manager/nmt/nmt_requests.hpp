#pragma once
// What the application asks of the NMT master: request NMT (1F82H), request node guarding (1F83H) and changes
// of 1F80H, 1F81H and 1F90H [CiA 302-2; ME3CAN1-Q 4.8.5 to 4.8.10], as objects and as calls.

#include <cstdint>
#include <span>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/manager/nmt/error_control.hpp"
#include "canopus/manager/nmt/master_context.hpp"
#include "canopus/manager/nmt/start_up.hpp"

namespace canopus::manager {

class NmtRequests final : public canopen::ObjectHandler {
 public:
  /// Attaches itself to the objects.
  NmtRequests(MasterContext& master, StartUp& start_up, ErrorControl& error_control);

  /// NmtMaster::request_nmt() and request_guarding().
  canopen::AbortCode request_nmt(std::uint8_t node_id, std::uint8_t value, can::Time now);
  canopen::AbortCode request_guarding(std::uint8_t node_id, std::uint8_t value, can::Time now);
  /// What 1F82H reads.
  [[nodiscard]] std::uint8_t node_state(std::uint8_t node_id) const noexcept;

 private:
  canopen::AbortCode before_read(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                 can::Time now) override;
  canopen::AbortCode before_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                  std::span<const std::uint8_t> value, can::Time now) override;
  void after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                   can::Time now) override;

  [[nodiscard]] canopen::AbortCode check_nmt(std::uint8_t node_id, std::uint8_t value) const noexcept;
  [[nodiscard]] canopen::AbortCode check_guarding(std::uint8_t node_id, std::uint8_t value) const noexcept;
  void perform_nmt(std::uint8_t node_id, std::uint8_t value, can::Time now);
  /// MasterOptions::slaves_request_nmt.
  void perform_nmt_as_slave(std::uint8_t node_id, canopen::NmtCommand command, can::Time now);
  void perform_guarding(std::uint8_t node_id, std::uint8_t value, can::Time now);

  MasterContext& master_;
  StartUp& start_up_;
  ErrorControl& error_control_;
};

}  // namespace canopus::manager
