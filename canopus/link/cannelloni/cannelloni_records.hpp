#pragma once
// The records of cannelloni, CAN over UDP or TCP, without any I/O. All numbers are big-endian:
//
//   datagram   02 00 | sequence u8 | count u16 | records
//   record     identifier u32 (bit 31 extended, 30 remote, 29 error frame) | length u8 | data (none when remote)
//   CAN FD     bit 7 of the length, and one byte of flags behind it
//
// Over TCP both sides first send the greeting, then records. [cannelloni 1.1 doc/udp_format.md, tcp_format]

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/frame.hpp"

namespace canopus::link {

inline constexpr std::string_view cannelloni_greeting = "CANNELLONIv1";
inline constexpr std::size_t cannelloni_header = 5;       ///< bytes
inline constexpr std::size_t cannelloni_max_record = 13;  ///< of a classical frame
/// Records that fit into a datagram of an Ethernet.
inline constexpr std::size_t cannelloni_max_count = 100;

void append_cannelloni_record(std::string& out, const can::Frame& frame);
/// Makes `out` a datagram of up to cannelloni_max_count frames.
void write_cannelloni_datagram(std::string& out, std::uint8_t sequence, std::span<const can::Frame> frames);

struct CannelloniRecord {
  enum class Kind : std::uint8_t {
    frame,
    error_frame,  ///< its identifier is the class (can_error.hpp)
    fd_frame,     ///< skipped
    wrong,        ///< unreadable; the start of the next one is unknown
  };
  Kind kind = Kind::wrong;
  can::Frame frame{};
};

/// Takes a record off the front. None: more bytes are needed; at most 70 belong to one.
[[nodiscard]] std::optional<CannelloniRecord> next_cannelloni_record(
    std::span<const std::uint8_t>& bytes) noexcept;

/// The numbers of the datagrams that come.
class CannelloniSequence {
 public:
  enum class Finding : std::uint8_t {
    in_order,
    lost,           ///< lost() datagrams
    another_order,  ///< an older one
    started_anew,   ///< a second older one behind the first: this is their count from now on
  };
  Finding classify(std::uint8_t sequence) noexcept;
  [[nodiscard]] unsigned lost() const noexcept { return lost_; }
  void restart() noexcept { *this = {}; }

 private:
  std::optional<std::uint8_t> expected_;
  std::optional<std::uint8_t> behind_;  // what follows the older one that came last
  unsigned lost_ = 0;
};

/// The readable contents of a datagram.
struct CannelloniDatagram {
  std::uint8_t sequence = 0;
  std::vector<CannelloniRecord> records{};
  std::string_view mistake{};  ///< what is wrong behind the records, empty if nothing is
};
/// False: it is no datagram of cannelloni.
[[nodiscard]] bool read_cannelloni_datagram(std::span<const std::uint8_t> bytes,
                                            CannelloniDatagram& datagram);

}  // namespace canopus::link
