#include "canopus/manager/concise_dcf.hpp"

#include <algorithm>
#include <array>

namespace canopus::manager {

namespace {

constexpr std::size_t count_length = 4;
constexpr std::size_t head_length = 7;

std::uint32_t little_endian(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) value = value << 8 | bytes[i - 1];
  return value;
}

}  // namespace

ConciseDcfReader::ConciseDcfReader(std::span<const std::uint8_t> file) noexcept {
  if (is_empty_concise_dcf(file)) return;
  if (file.size() < count_length) {
    intact_ = false;
    return;
  }
  remaining_ = little_endian(file.first(count_length));
  rest_ = file.subspan(count_length);
}

std::optional<ConciseEntry> ConciseDcfReader::next() noexcept {
  if (remaining_ == 0 || !intact_) return std::nullopt;
  if (rest_.size() < head_length) {
    intact_ = false;
    return std::nullopt;
  }
  const std::uint32_t length = little_endian(rest_.subspan(3, 4));
  if (rest_.size() - head_length < length) {
    intact_ = false;
    return std::nullopt;
  }
  ConciseEntry entry;
  entry.index = static_cast<std::uint16_t>(little_endian(rest_.first(2)));
  entry.sub = rest_[2];
  entry.data = rest_.subspan(head_length, length);
  rest_ = rest_.subspan(head_length + length);
  --remaining_;
  return entry;
}

bool is_empty_concise_dcf(std::span<const std::uint8_t> file) noexcept {
  return file.empty() || (file.size() == 1 && file[0] == 0) ||
         (file.size() >= count_length &&
          std::ranges::all_of(file.first(count_length), [](std::uint8_t byte) { return byte == 0; }));
}

std::expected<std::uint32_t, std::string> check_concise_dcf(std::span<const std::uint8_t> file) {
  ConciseDcfReader reader(file);
  std::uint32_t entries = 0;
  std::size_t offset = count_length;
  while (const auto entry = reader.next()) {
    ++entries;
    offset += head_length + entry->data.size();
  }
  if (reader.intact()) return entries;
  if (file.size() < count_length) {
    return std::unexpected("concise DCF: " + std::to_string(file.size()) +
                           " bytes, but the number of entries alone takes 4");
  }
  return std::unexpected("concise DCF: entry " + std::to_string(entries + 1) + " of " +
                         std::to_string(little_endian(file.first(count_length))) + ", at byte " +
                         std::to_string(offset) + ", reaches beyond the end of the file (" +
                         std::to_string(file.size()) + " bytes)");
}

ConciseDcfWriter& ConciseDcfWriter::add(std::uint16_t index, std::uint8_t sub,
                                        std::span<const std::uint8_t> data) {
  const auto put = [this](std::uint64_t value, unsigned length) {
    for (unsigned i = 0; i < length; ++i) file_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  };
  put(index, 2);
  put(sub, 1);
  put(data.size(), 4);
  file_.insert(file_.end(), data.begin(), data.end());
  for (std::size_t i = 0; i < count_length && ++file_[i] == 0; ++i) {
  }
  return *this;
}

ConciseDcfWriter& ConciseDcfWriter::add(std::uint16_t index, std::uint8_t sub, std::uint64_t value,
                                        unsigned length) {
  std::array<std::uint8_t, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  return add(index, sub, std::span<const std::uint8_t>(bytes).first(std::min<std::size_t>(length, 8)));
}

}  // namespace canopus::manager
