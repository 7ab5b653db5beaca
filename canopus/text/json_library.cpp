// Functions that use nlohmann-json: parsing, and the digits of real numbers. Only this file includes it.

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canopus/text/json.hpp"

namespace canopus::text {

/// Makes a value of the parser's events. false ends the parser: the text is read no further.
class JsonBuilder {
 public:
  explicit JsonBuilder(std::size_t depth) : depth_(depth) {}

  bool null() { return add(Json()); }
  bool boolean(bool value) { return add(Json(value)); }
  bool number_integer(std::int64_t value) { return add(Json(value)); }
  bool number_unsigned(std::uint64_t value) { return add(Json(value)); }
  bool number_float(double value, const std::string& /*text*/) { return add(Json(value)); }
  bool string(std::string& value) { return add(Json(std::move(value))); }
  bool binary(const std::vector<std::uint8_t>& /*value*/) { return false; }
  bool start_array(std::size_t /*size*/) { return open(Json::array()); }
  bool end_array() { return close(); }
  bool start_object(std::size_t /*size*/) { return open(Json::object()); }
  bool end_object() {
    keep_last_of_each(std::get<Json::Object>(open_.back()->value_));
    return close();
  }
  bool key(std::string& value) {
    std::get<Json::Object>(open_.back()->value_).push_back({std::move(value), Json()});
    return true;
  }
  template <typename Exception>
  bool parse_error(std::size_t position, const std::string& /*token*/, const Exception& /*error*/) {
    error_ = fmt::format("no JSON from octet {} on", position);
    return false;
  }

  [[nodiscard]] Json release() { return std::move(root_); }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  /// Where the next value goes: behind the last element, or into the member of the last key read.
  Json& place(Json value) {
    if (open_.empty()) return root_ = std::move(value);
    if (auto* const members = std::get_if<Json::Object>(&open_.back()->value_))
      return members->back().value = std::move(value);
    auto& elements = std::get<Json::Array>(open_.back()->value_);
    return elements.emplace_back(std::move(value));
  }
  bool add(Json value) {
    place(std::move(value));
    return true;
  }
  bool open(Json value) {
    if (open_.size() >= depth_) {
      error_ = fmt::format("more than {} arrays and objects within each other", depth_);
      return false;
    }
    open_.push_back(&place(std::move(value)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }
  static void keep_last_of_each(Json::Object& members);

  std::size_t depth_;
  Json root_;
  std::vector<Json*> open_;  // each within the one before, as its last value
  std::string error_;
};

/// In a time that does not grow with the square of their number.
void JsonBuilder::keep_last_of_each(Json::Object& members) {
  std::vector<std::size_t> order(members.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) -> const std::string& { return members[i].key; });
  std::vector<bool> is_again(members.size());
  for (std::size_t i = 1, first = 0; i < order.size(); ++i) {
    if (members[order[i]].key != members[order[first]].key) {
      first = i;
      continue;
    }
    members[order[first]].value = std::move(members[order[i]].value);
    is_again[order[i]] = true;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (is_again[i]) continue;
    if (kept != i) members[kept] = std::move(members[i]);
    ++kept;
  }
  members.erase(members.begin() + static_cast<std::ptrdiff_t>(kept), members.end());
}

std::expected<Json, std::string> parse_json(std::string_view text, JsonLimits limits) {
  if (text.size() > limits.bytes) return std::unexpected(fmt::format("more than {} octets", limits.bytes));
  JsonBuilder builder(limits.depth);
  if (!nlohmann::json::sax_parse(text, &builder)) return std::unexpected(builder.error());
  return builder.release();
}

/// Digits that read back as the same number, but not always the fewest: std::to_chars would write one of a thousand
/// times of events in another way.
std::string Json::real_text(double value) { return nlohmann::json(value).dump(); }

}  // namespace canopus::text
