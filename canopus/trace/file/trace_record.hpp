#pragma once
// One record of a trace of any format.

#include <cstdint>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"

namespace canopus::trace {

/// A recorded frame. The name of its channel is TraceReader::channel(record.channel).
struct TraceRecord {
  can::Time time{};           ///< since the zero of the file: often 1970, or the start of the recording
  std::uint16_t channel = 0;  ///< counted from 0 in the order in which the file names them
  bool transmitted = false;   ///< sent by the recording program itself ("Tx"), in formats that record this
  bool error_frame = false;   ///< `frame` holds class (identifier) and data of a SocketCAN error frame
  can::Frame frame{};

  friend bool operator==(const TraceRecord&, const TraceRecord&) = default;
};

}  // namespace canopus::trace
