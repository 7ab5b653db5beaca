#pragma once
// Records as the bytes of a trace file of any format. Nothing is allocated for a record of a channel that has
// been there before.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "canopus/trace/file/channel_names.hpp"
#include "canopus/trace/file/file_format.hpp"
#include "canopus/trace/file/trace_record.hpp"

namespace canopus::trace {

/// 2.1 is written by PCAN-View. The others have no channels; 1.1 is what PCAN-Explorer 4 and 5 read, with times of 0.1 ms;
/// 1.0 has times of 1 ms and no direction.
enum class TrcVersion : std::uint8_t { v1_0, v1_1, v2_0, v2_1 };
struct TrcVersionName {
  TrcVersion version;
  std::string_view name;
};
inline constexpr std::array trc_version_names{
    TrcVersionName{TrcVersion::v1_0, "1.0"}, TrcVersionName{TrcVersion::v1_1, "1.1"},
    TrcVersionName{TrcVersion::v2_0, "2.0"}, TrcVersionName{TrcVersion::v2_1, "2.1"}};

class TraceEncoder {
 public:
  /// `format` is one that is written [FormatName].
  explicit TraceEncoder(FileFormat format, TrcVersion trc_version = TrcVersion::v2_1)
      : format_(format), trc_version_(trc_version) {}

  /// The beginning of a file before its first record. All results stay valid until the next call.
  [[nodiscard]] std::string_view begin() noexcept;
  /// The record, with a description of its channel or a head with the time of the first one before it where
  /// the format has that. record.channel is ignored.
  [[nodiscard]] std::string_view encode(std::string_view channel, const TraceRecord& record) noexcept;
  /// The end of a file.
  [[nodiscard]] std::string_view end() noexcept;

 private:
  // a head of TRC with its record
  static constexpr std::size_t room = 4096;

  [[nodiscard]] std::uint32_t number_of(std::string_view channel) noexcept;
  std::size_t put_head(can::Time first) noexcept;
  std::size_t put_asc(char* out, std::uint32_t channel, const TraceRecord& record) noexcept;
  std::size_t put_trc(char* out, std::uint32_t channel, const TraceRecord& record) noexcept;
  std::size_t put_trc_1_0(char* out, const TraceRecord& record) noexcept;
  std::size_t put_trc_1_1(char* out, const TraceRecord& record) noexcept;
  static std::size_t put_csv(char* out, std::string_view channel, const TraceRecord& record) noexcept;
  [[nodiscard]] std::span<std::uint8_t> octets(std::size_t from) noexcept {
    return std::span(reinterpret_cast<std::uint8_t*>(buffer_.data()), buffer_.size()).subspan(from);
  }

  FileFormat format_;
  TrcVersion trc_version_;
  std::array<char, room> buffer_{};
  ChannelNames channels_{};
  std::vector<std::uint32_t> numbers_{};  // of the channels, for formats that number them from 1
  std::optional<can::Time> start_{};      // of the times in ASC and TRC
  std::uint64_t messages_ = 0;
};

}  // namespace canopus::trace
