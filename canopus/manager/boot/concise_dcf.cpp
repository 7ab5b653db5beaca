#include "canopus/manager/boot/concise_dcf.hpp"

#include <algorithm>
#include <array>

#include "canopus/can/little_endian.hpp"

namespace canopus::manager {

namespace {

constexpr std::size_t count_length = 4;
constexpr std::size_t head_length = 7;

}  // namespace

ConciseDcfReader::ConciseDcfReader(std::span<const std::uint8_t> file) noexcept {
  if (is_empty_concise_dcf(file)) return;
  if (file.size() < count_length) {
    intact_ = false;
    rest_ = file;
    return;
  }
  announced_ = remaining_ = can::load_u32(file.first(count_length));
  rest_ = file.subspan(count_length);
}

std::optional<ConciseEntry> ConciseDcfReader::next() noexcept {
  if (remaining_ == 0 || !intact_) return std::nullopt;
  if (rest_.size() < head_length) {
    intact_ = false;
    return std::nullopt;
  }
  const std::uint32_t length = can::load_u32(rest_.subspan(3, 4));
  if (rest_.size() - head_length < length) {
    intact_ = false;
    return std::nullopt;
  }
  ConciseEntry entry;
  entry.index = static_cast<std::uint16_t>(can::load_u32(rest_.first(2)));
  entry.sub = rest_[2];
  entry.data = rest_.subspan(head_length, length);
  rest_ = rest_.subspan(head_length + length);
  --remaining_;
  return entry;
}

std::string ConciseDcfReader::damage() const {
  const auto bytes = [](std::size_t count) {
    return std::to_string(count) + (count == 1 ? " byte" : " bytes");
  };
  const auto left = [](std::size_t count) {
    return std::to_string(count) + (count == 1 ? " is left" : " are left");
  };
  if (intact_) return {};
  if (announced_ == 0) return bytes(rest_.size()) + ", but the number of entries alone takes 4";
  const std::string entry = "entry " + std::to_string(announced_ - remaining_ + 1);
  const std::string of = " of " + std::to_string(announced_);
  if (rest_.empty()) return entry + of + " is not there: the file ends before it";
  if (rest_.size() < head_length) {
    return entry + of + " begins with " + bytes(head_length) + " of index, sub-index and size, " +
           left(rest_.size());
  }
  return entry + " says " + bytes(can::load_u32(rest_.subspan(3, 4))) + ", " +
         left(rest_.size() - head_length);
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
                         std::to_string(can::load_u32(file.first(count_length))) + ", at byte " +
                         std::to_string(offset) + ", reaches beyond the end of the file (" +
                         std::to_string(file.size()) + " bytes)");
}

ConciseDcfWriter& ConciseDcfWriter::add(std::uint16_t index, std::uint8_t sub,
                                        std::span<const std::uint8_t> data) {
  can::append_value(file_, index, 2);
  file_.push_back(sub);
  can::append_value(file_, data.size(), 4);
  file_.insert(file_.end(), data.begin(), data.end());
  can::store_value(file_.data(), can::load_as<std::uint32_t>(file_.data()) + 1, count_length);
  return *this;
}

ConciseDcfWriter& ConciseDcfWriter::add(std::uint16_t index, std::uint8_t sub, std::uint64_t value,
                                        unsigned length) {
  std::array<std::uint8_t, 8> bytes{};
  can::store_value(bytes.data(), value, 8);
  return add(index, sub, std::span<const std::uint8_t>(bytes).first(std::min<std::size_t>(length, 8)));
}

}  // namespace canopus::manager
