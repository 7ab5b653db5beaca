#pragma once
// Common to the readers of all formats: the input, the channels, the count of what is left out. Also the
// functions that create them; open_trace() detects the format.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "canopus/trace/file/channel_names.hpp"
#include "canopus/trace/file/trace_input.hpp"
#include "canopus/trace/file/trace_reader.hpp"

namespace canopus::trace {

using NextRecord = std::expected<std::optional<TraceRecord>, std::string>;
using OpenedReader = std::expected<std::unique_ptr<TraceReader>, std::string>;

class ReaderBase : public TraceReader {
 public:
  [[nodiscard]] FileFormat format() const noexcept final { return format_; }
  [[nodiscard]] std::size_t channel_count() const noexcept final { return channels_.size(); }
  [[nodiscard]] std::string_view channel(std::size_t number) const noexcept final {
    return channels_.name(number);
  }
  [[nodiscard]] const LeftOut& left_out() const noexcept final { return left_out_; }

 protected:
  ReaderBase(TraceInput input, FileFormat format) : input_(std::move(input)), format_(format) {}
  TraceInput input_;
  ChannelNames channels_{};
  LeftOut left_out_{};

 private:
  FileFormat format_;
};

/// Class of an error frame whose format has none: CAN_ERR_BUSERROR, as asc2log has it.
inline constexpr std::uint32_t unspecified_error = 0x80;

/// Puts class (29 bits of the identifier) and data of a SocketCAN error frame into the record.
inline void set_error_frame(TraceRecord& record, std::uint32_t error_class) {
  record.error_frame = true;
  record.frame.identifier = error_class & can::max_extended_identifier;
  record.frame.extended = record.frame.identifier > can::max_base_identifier;
}

[[nodiscard]] OpenedReader open_candump(TraceInput input);
[[nodiscard]] OpenedReader open_pcap(TraceInput input);
[[nodiscard]] OpenedReader open_pcapng(TraceInput input);
[[nodiscard]] OpenedReader open_asc(TraceInput input);
[[nodiscard]] OpenedReader open_trc(TraceInput input);
[[nodiscard]] OpenedReader open_csv(TraceInput input);
[[nodiscard]] OpenedReader open_blf(TraceInput input);
[[nodiscard]] OpenedReader open_busmaster(TraceInput input);
[[nodiscard]] OpenedReader open_microchip(TraceInput input);
[[nodiscard]] OpenedReader open_carbus(TraceInput input);
[[nodiscard]] OpenedReader open_canhacker(TraceInput input);

/// As open_trace(), from any input.
[[nodiscard]] OpenedReader open_reader(TraceInput input, std::optional<FileFormat> format = std::nullopt);

}  // namespace canopus::trace
