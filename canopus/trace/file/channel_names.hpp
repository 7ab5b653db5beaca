#pragma once
// The channels of a trace, numbered in the order in which it names them.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace canopus::trace {

class ChannelNames {
 public:
  static constexpr std::size_t max_channels = 4096;
  static constexpr std::size_t max_name = 128;  ///< bytes; a longer name is cut

  /// The number of this name, which is new if need be; nothing when there are too many.
  std::optional<std::uint16_t> number_of(std::string_view name) {
    name = name.substr(0, max_name);
    if (last_ < names_.size() && names_[last_] == name) return last_;
    if (const auto found = numbers_.find(name); found != numbers_.end()) return last_ = found->second;
    if (names_.size() == max_channels) return std::nullopt;
    last_ = static_cast<std::uint16_t>(names_.size());
    names_.emplace_back(name);
    numbers_.emplace(names_.back(), last_);
    return last_;
  }
  [[nodiscard]] std::size_t size() const noexcept { return names_.size(); }
  /// Empty for a number that is none.
  [[nodiscard]] std::string_view name(std::size_t number) const noexcept {
    return number < names_.size() ? std::string_view(names_[number]) : std::string_view{};
  }

 private:
  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view name) const noexcept {
      return std::hash<std::string_view>{}(name);
    }
  };
  std::vector<std::string> names_{};
  std::unordered_map<std::string, std::uint16_t, Hash, std::equal_to<>> numbers_{};
  std::uint16_t last_ = 0;
};

}  // namespace canopus::trace
