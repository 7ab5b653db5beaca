#include "canopus/text/json.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace canopus::text {
namespace {

bool is_member(const Json& value) { return value.is_array() && value.size() == 2 && value[0].is_string(); }

template <typename Value, typename Variant>
Value& expected_of(Variant& variant, const char* what) {
  if (auto* const found = std::get_if<std::remove_const_t<Value>>(&variant)) return *found;
  throw std::logic_error(what);
}

constexpr const char* no_object = "JSON: expected an object";
constexpr const char* no_array = "JSON: expected an array";

}  // namespace

Json::Json() noexcept : value_(nullptr) {}
Json::Json(std::nullptr_t) noexcept : value_(nullptr) {}
Json::Json(const char* value) : value_(std::string(value)) {}
Json::Json(std::string_view value) : value_(std::string(value)) {}
Json::Json(std::string value) noexcept : value_(std::move(value)) {}
Json::Json(Tagged<bool> value) noexcept : value_(value.value) {}
Json::Json(Tagged<std::uint64_t> value) noexcept : value_(value.value) {}
Json::Json(Tagged<std::int64_t> value) noexcept : value_(value.value) {}
Json::Json(Tagged<double> value) noexcept : value_(value.value) {}

Json::Json(std::initializer_list<JsonItem> items) : value_(nullptr) {
  const bool is_of_members =
      std::ranges::all_of(items, [](const JsonItem& item) { return is_member(item.value()); });
  *this = is_of_members ? object(items) : array(items);
}

Json::Json(const Json& other) = default;
Json::Json(Json&& other) noexcept : value_(std::move(other.value_)) { other.value_ = nullptr; }
Json& Json::operator=(const Json& other) {
  Json copy(other);  // which may be part of this value
  value_ = std::move(copy.value_);
  return *this;
}
Json& Json::operator=(Json&& other) noexcept {
  Json moved(std::move(other));
  value_ = std::move(moved.value_);
  return *this;
}
Json::~Json() = default;

Json Json::array() {
  Json made;
  made.value_ = Array();
  return made;
}

Json Json::array(std::initializer_list<JsonItem> items) {
  Array elements;
  elements.reserve(items.size());
  for (const JsonItem& item : items) elements.push_back(item.release());
  Json made;
  made.value_ = std::move(elements);
  return made;
}

Json Json::object() {
  Json made;
  made.value_ = Object();
  return made;
}

Json Json::object(std::initializer_list<JsonItem> items) {
  Json made = object();
  Object& members = std::get<Object>(made.value_);
  members.reserve(items.size());
  for (const JsonItem& item : items) {
    Json member = item.release();
    if (!is_member(member)) throw std::logic_error("JSON: expected a key and a value");
    std::string key = std::get<std::string>(std::move(member.element(0).value_));
    if (!made.contains(key)) members.push_back({std::move(key), std::move(member.element(1))});
  }
  return made;
}

bool Json::is_null() const noexcept { return std::holds_alternative<std::nullptr_t>(value_); }
bool Json::is_boolean() const noexcept { return std::holds_alternative<bool>(value_); }
bool Json::is_number() const noexcept {
  return is_number_integer() || std::holds_alternative<double>(value_);
}
bool Json::is_number_integer() const noexcept {
  return is_number_unsigned() || std::holds_alternative<std::int64_t>(value_);
}
bool Json::is_number_unsigned() const noexcept { return std::holds_alternative<std::uint64_t>(value_); }
bool Json::is_string() const noexcept { return std::holds_alternative<std::string>(value_); }
bool Json::is_array() const noexcept { return std::holds_alternative<Array>(value_); }
bool Json::is_object() const noexcept { return std::holds_alternative<Object>(value_); }

bool Json::boolean() const { return expected_of<const bool>(value_, "JSON: expected true or false"); }

const std::string& Json::string() const {
  return expected_of<const std::string>(value_, "JSON: expected a string");
}

double Json::real() const {
  if (const auto* const number = std::get_if<double>(&value_)) return *number;
  if (const auto* const number = std::get_if<std::int64_t>(&value_)) return static_cast<double>(*number);
  return static_cast<double>(expected_of<const std::uint64_t>(value_, "JSON: expected a number"));
}

std::uint64_t Json::integer() const {
  if (const auto* const number = std::get_if<std::int64_t>(&value_))
    return static_cast<std::uint64_t>(*number);
  return expected_of<const std::uint64_t>(value_, "JSON: expected an integer");
}

std::size_t Json::size() const noexcept {
  if (is_null()) return 0;
  if (const auto* const array = std::get_if<Array>(&value_)) return array->size();
  return is_object() ? items().size() : 1;
}

const Json* Json::member(std::string_view key) const noexcept {
  const auto& members = items();
  const auto found = std::ranges::find(members, key, &JsonMember::key);
  return found == members.end() ? nullptr : &found->value;
}

Json& Json::operator[](std::string_view key) {
  if (is_null()) value_ = Object();
  auto& members = expected_of<Object>(value_, no_object);
  const auto found = std::ranges::find(members, key, &JsonMember::key);
  if (found != members.end()) return found->value;
  return members.emplace_back(std::string(key), Json()).value;
}

const Json& Json::at(std::string_view key) const {
  if (const Json* const found = member(key)) return *found;
  throw std::logic_error("JSON: no member " + std::string(key));
}

bool Json::contains(std::string_view key) const noexcept { return member(key) != nullptr; }

Json::const_iterator_type Json::find(std::string_view key) const noexcept {
  const auto& members = items();
  const auto found = std::ranges::find(members, key, &JsonMember::key);
  if (found == members.end()) return end();
  return const_iterator_type(members.data() + (found - members.begin()));
}

bool Json::value(std::string_view key, bool otherwise) const {
  const Json* const found = member(key);
  return found != nullptr && found->is_boolean() ? found->boolean() : otherwise;
}

std::string Json::value(std::string_view key, const char* otherwise) const {
  const Json* const found = member(key);
  return found != nullptr && found->is_string() ? found->string() : otherwise;
}

void Json::update(const Json& other) {
  for (const auto& [key, value] : expected_of<const Object>(other.value_, no_object)) (*this)[key] = value;
}

void Json::sort_members() {
  if (auto* const members = std::get_if<Object>(&value_)) std::ranges::sort(*members, {}, &JsonMember::key);
  for (Json& each : *this) each.sort_members();
}

const std::vector<JsonMember>& Json::items() const noexcept {
  static const Object none;
  const auto* const members = std::get_if<Object>(&value_);
  return members == nullptr ? none : *members;
}

const Json& Json::element(std::size_t index) const {
  const auto& elements = expected_of<const Array>(value_, no_array);
  if (index >= elements.size()) throw std::logic_error("JSON: no such element of an array");
  return elements[index];
}

Json& Json::element(std::size_t index) { return const_cast<Json&>(std::as_const(*this).element(index)); }

Json& Json::back() { return expected_of<Array>(value_, no_array).back(); }
const Json& Json::back() const { return expected_of<const Array>(value_, no_array).back(); }

void Json::push_back(Json value) {
  if (is_null()) value_ = Array();
  expected_of<Array>(value_, no_array).push_back(std::move(value));
}

Json::iterator_type Json::begin() noexcept {
  if (auto* const members = std::get_if<Object>(&value_)) return iterator_type(members->data());
  if (auto* const elements = std::get_if<Array>(&value_)) return iterator_type(elements->data());
  return {};
}

Json::iterator_type Json::end() noexcept {
  if (auto* const members = std::get_if<Object>(&value_))
    return iterator_type(members->data() + members->size());
  if (auto* const elements = std::get_if<Array>(&value_))
    return iterator_type(elements->data() + elements->size());
  return {};
}

Json::const_iterator_type Json::begin() const noexcept {
  if (is_object()) return const_iterator_type(items().data());
  if (const auto* const elements = std::get_if<Array>(&value_)) return const_iterator_type(elements->data());
  return {};
}

Json::const_iterator_type Json::end() const noexcept {
  if (is_object()) return const_iterator_type(items().data() + items().size());
  if (const auto* const elements = std::get_if<Array>(&value_))
    return const_iterator_type(elements->data() + elements->size());
  return {};
}

bool Json::equals(const Json& other) const {
  if (!is_number() || !other.is_number()) return value_ == other.value_;
  if (is_number_integer() && other.is_number_integer()) {
    const auto is_negative = [](const Json& number) {
      const auto* const value = std::get_if<std::int64_t>(&number.value_);
      return value != nullptr && *value < 0;
    };
    return is_negative(*this) == is_negative(other) && integer() == other.integer();
  }
  return real() == other.real();
}

}  // namespace canopus::text
