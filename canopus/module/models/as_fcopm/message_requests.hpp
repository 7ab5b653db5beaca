#pragma once
// Requests of the PLC program by D25000-25031, answers in D24000-24031: SDO read and write, NMT, emergency messages
// [AS-FCOPM 10.4]. Changing the ReqID, the high byte of D25000, is a request, also when it is changed back in the same scan:
// the program is to clear the area before it fills it. D25000 = 0 requests nothing.
//
// One request per node may be on its way; requests to different nodes may. Each answer carries the ReqID of its
// request, and the area shows the latest one.

#include <array>
#include <bitset>
#include <cstdint>
#include <span>

#include "canopus/manager/nmt/nmt_master.hpp"
#include "canopus/module/models/as_fcopm/codes.hpp"
#include "canopus/module/models/as_fcopm/emergency_log.hpp"
#include "canopus/module/models/as_fcopm/register_table.hpp"

namespace canopus::module::as_fcopm {

class MessageRequests {
 public:
  using Words = std::array<std::uint16_t, message_words>;

  /// Everything must outlive it.
  MessageRequests(manager::NmtMaster& master, std::uint8_t own_node, const EmergencyLog& emergencies)
      : master_(master), own_node_(own_node), emergencies_(emergencies) {}

  /// The program has written D25000.
  void header_written(std::uint16_t value) noexcept;
  /// A scan is over: the words are a request if the ReqID was changed in it.
  void read_request(const Words& request, can::Time now);
  [[nodiscard]] std::uint16_t response(std::size_t word) const noexcept { return response_[word]; }

 private:
  struct Header {
    std::uint8_t id = 0;
    std::uint8_t type = 0;
    std::uint8_t node = 0;
    std::uint8_t size = 0;
  };
  enum Type : std::uint8_t { sdo_read = 1, sdo_write = 2, nmt = 3, read_emergencies = 4 };

  void access(const Header& header, const Words& request, can::Time now);
  void access_done(const Header& header, const manager::SdoResult& result);
  void send_nmt(const Header& header, const Words& request, can::Time now);
  void show_emergencies(const Header& header);
  /// An answer without data: status, and the node.
  void answer(const Header& header, Status status);
  [[nodiscard]] static bool is_slave(std::uint8_t node) noexcept { return node >= 1 && node <= 127; }

  manager::NmtMaster& master_;
  std::uint8_t own_node_;
  const EmergencyLog& emergencies_;
  std::uint8_t last_id_ = 0;
  bool is_asked_ = false;  // the ReqID was changed since the last read_request()
  std::bitset<128> running_;
  Words response_{};
};

}  // namespace canopus::module::as_fcopm
