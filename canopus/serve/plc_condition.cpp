#include "canopus/serve/plc_condition.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/client/plc_point.hpp"

namespace canopus::serve {

namespace {

constexpr std::string_view expected_form = "expected for example \"X1\", \"D100 >= 5\" or \"U0\\G601 == 5\"";

std::string why_refused(plc::AccessError error, const plc::melsec::Target& target, unsigned io_base) {
  const std::string address = client::plc_address(target, 0, io_base);
  switch (error) {
    case plc::AccessError::no_device: return fmt::format("the CPU has no {}", address);
    case plc::AccessError::no_module:
      return fmt::format("{}: there is no module at this head address, or it has no supply", address);
    case plc::AccessError::beyond_buffer:
      return fmt::format("{} is beyond the module's buffer memory", address);
    case plc::AccessError::wrong_unit:
    case plc::AccessError::out_of_range: break;
  }
  return fmt::format("{} is beyond the CPU's last one", address);
}

}  // namespace

std::expected<PlcCondition, std::string> PlcCondition::parse(std::string_view text, const plc::Rack& rack) {
  // The longer ones first: "<=" begins with "<".
  static constexpr std::array<std::pair<std::string_view, Comparison>, 6> comparisons{{
      {"==", Comparison::equal},
      {"!=", Comparison::not_equal},
      {"<=", Comparison::less_or_equal},
      {">=", Comparison::greater_or_equal},
      {"<", Comparison::less},
      {">", Comparison::greater},
  }};
  PlcCondition condition;
  const std::size_t at = text.find_first_of("=!<>");
  const unsigned io_base = rack.model().number_base(plc::Device::x);
  const auto address = client::parse_plc_address(ascii::trim(text.substr(0, at)), io_base);
  if (!address) return std::unexpected(address.error());
  condition.target_ = *address;
  condition.is_bit_ = !address->is_buffer && plc::device_info(address->device).is_bit;
  const auto known = address->is_buffer ? rack.check_buffer(address->head_address, address->number, 1)
                                        : rack.check(address->device, address->number, 1);
  if (!known) return std::unexpected(why_refused(known.error(), *address, io_base));
  if (at == std::string_view::npos) {
    if (condition.is_bit_) return condition;
    return std::unexpected(
        fmt::format("\"{}\" is a word and needs a comparison; {}", ascii::trim(text), expected_form));
  }
  const auto* found = std::ranges::find_if(
      comparisons, [&](const auto& each) { return text.substr(at).starts_with(each.first); });
  if (found == comparisons.end()) {
    return std::unexpected(fmt::format("\"{}\" has none of == != < <= > >=; {}", text, expected_form));
  }
  condition.comparison_ = found->second;
  const std::string_view constant = ascii::trim(text.substr(at + found->first.size()));
  if (condition.is_bit_) {
    const auto bit = client::parse_plc_bit(constant);
    if (!bit) return std::unexpected(bit.error());
    condition.constant_ = *bit ? 1 : 0;
    return condition;
  }
  const auto word = client::parse_plc_word(constant);
  if (!word) return std::unexpected(word.error());
  condition.is_signed_ = constant.starts_with('-');
  condition.constant_ = condition.is_signed_ ? static_cast<std::int16_t>(*word) : std::int32_t{*word};
  return condition;
}

bool PlcCondition::holds(plc::Rack& rack, can::Time now) const {
  std::int32_t value = 0;
  if (is_bit_) {
    std::uint8_t bit = 0;
    if (!rack.read_bits(target_.device, target_.number, {&bit, 1}, now)) return false;
    value = bit;
  } else {
    std::uint16_t word = 0;
    const auto read = target_.is_buffer
                          ? rack.read_buffer(target_.head_address, target_.number, {&word, 1}, now)
                          : rack.read_words(target_.device, target_.number, {&word, 1}, now);
    if (!read) return false;
    value = is_signed_ ? static_cast<std::int16_t>(word) : std::int32_t{word};
  }
  switch (comparison_) {
    case Comparison::equal: return value == constant_;
    case Comparison::not_equal: return value != constant_;
    case Comparison::less_or_equal: return value <= constant_;
    case Comparison::greater_or_equal: return value >= constant_;
    case Comparison::less: return value < constant_;
    case Comparison::greater: return value > constant_;
  }
  return false;
}

}  // namespace canopus::serve
