#pragma once
// JSON values: written for other programs and read from them. Objects keep their members in the order of
// insertion. Text is parsed by parse_json(), within limits: the depth of foreign input is bounded, so that
// functions over a value may recurse.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace canopus::text {

class Json;
class JsonItem;
struct JsonMember;

/// Something with begin() and end() that is no text: it becomes an array. What is its own element (a path, a JSON value
/// of another library) would become arrays without end.
template <typename List>
concept JsonList = !std::same_as<List, Json> && !std::is_convertible_v<const List&, std::string_view> &&
                   requires(const List& list) {
  list.begin() != list.end();
  list.size();
  requires !std::same_as<std::remove_cvref_t<decltype(*list.begin())>, List>;
};

/// null, true or false, a number, a string, an array or an object. A wrong kind of value (an index into a string,
/// text of a number) is a mistake of the program: std::logic_error.
class Json {
 public:
  template <typename Value>
  class Iterator;
  using iterator_type = Iterator<Json>;
  using const_iterator_type = Iterator<const Json>;

  Json() noexcept;
  Json(std::nullptr_t) noexcept;
  template <std::same_as<bool> Bool>
  Json(Bool value) noexcept : Json(Tagged<bool>{value}) {}
  template <std::unsigned_integral Number>
  requires(!std::same_as<Number, bool>) Json(Number value)
  noexcept : Json(Tagged<std::uint64_t>{value}) {}
  template <std::signed_integral Number>
  Json(Number value) noexcept : Json(Tagged<std::int64_t>{value}) {}
  template <std::floating_point Number>
  Json(Number value) noexcept : Json(Tagged<double>{static_cast<double>(value)}) {}
  Json(const char* value);
  Json(std::string_view value);
  Json(std::string value) noexcept;
  template <JsonList List>
  Json(const List& list) : Json(array()) {
    for (const auto& each : list) push_back(Json(each));
  }
  /// An object when every item is an array of two, the first of them a string; else an array. Of two members with
  /// one key the first is taken.
  Json(std::initializer_list<JsonItem> items);
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(const Json& other);
  Json& operator=(Json&& other) noexcept;
  ~Json();

  [[nodiscard]] static Json array();
  [[nodiscard]] static Json array(std::initializer_list<JsonItem> items);
  [[nodiscard]] static Json object();
  [[nodiscard]] static Json object(std::initializer_list<JsonItem> items);

  [[nodiscard]] bool is_null() const noexcept;
  [[nodiscard]] bool is_boolean() const noexcept;
  [[nodiscard]] bool is_number() const noexcept;
  [[nodiscard]] bool is_number_integer() const noexcept;  ///< with a sign or without
  [[nodiscard]] bool is_number_unsigned()
      const noexcept;  ///< parsed: from 0 on; else made of an unsigned type
  [[nodiscard]] bool is_string() const noexcept;
  [[nodiscard]] bool is_array() const noexcept;
  [[nodiscard]] bool is_object() const noexcept;
  [[nodiscard]] bool is_primitive() const noexcept { return !is_array() && !is_object(); }

  /// bool, a type of number, or std::string. Integers are cut to the type's bits.
  template <typename Value>
  [[nodiscard]] Value get() const {
    if constexpr (std::same_as<Value, bool>) {
      return boolean();
    } else if constexpr (std::floating_point<Value>) {
      return static_cast<Value>(real());
    } else if constexpr (std::integral<Value>) {
      return static_cast<Value>(integer());
    } else {
      static_assert(std::same_as<Value, std::string>);
      return string();
    }
  }
  [[nodiscard]] const std::string& string() const;

  /// Members of an object, elements of an array; null has none, any other value is 1.
  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] bool empty() const noexcept { return size() == 0; }

  /// The member; a new one is null. null becomes an object.
  Json& operator[](std::string_view key);
  const Json& operator[](std::string_view key) const { return at(key); }
  Json& operator[](const char* key) { return (*this)[std::string_view(key)]; }
  const Json& operator[](const char* key) const { return at(key); }
  [[nodiscard]] const Json& at(std::string_view key) const;
  [[nodiscard]] bool contains(std::string_view key) const noexcept;
  /// end() when this is no object, too.
  [[nodiscard]] const_iterator_type find(std::string_view key) const noexcept;
  /// The member if it is one of this kind.
  [[nodiscard]] bool value(std::string_view key, bool otherwise) const;
  [[nodiscard]] std::string value(std::string_view key, const char* otherwise) const;
  /// Takes over the members of another object.
  void update(const Json& other);
  /// The members of every object within, in the order of their keys' octets.
  void sort_members();
  /// The members of an object; of anything else none.
  [[nodiscard]] const std::vector<JsonMember>& items() const noexcept;

  template <std::integral Index>
  Json& operator[](Index index) {
    return element(static_cast<std::size_t>(index));
  }
  template <std::integral Index>
  const Json& operator[](Index index) const {
    return element(static_cast<std::size_t>(index));
  }
  [[nodiscard]] Json& back();
  [[nodiscard]] const Json& back() const;
  /// null becomes an array.
  void push_back(Json value);

  /// The elements of an array, the values of an object's members.
  [[nodiscard]] iterator_type begin() noexcept;
  [[nodiscard]] iterator_type end() noexcept;
  [[nodiscard]] const_iterator_type begin() const noexcept;
  [[nodiscard]] const_iterator_type end() const noexcept;

  /// Its text, on one line without blanks. Octets that are no UTF-8 become U+FFFD, NaN and infinity null.
  [[nodiscard]] std::string dump() const;

  /// Numbers are equal by their value, objects when their members are in the same order.
  friend bool operator==(const Json& left, const Json& right) { return left.equals(right); }

 private:
  friend class JsonBuilder;
  template <typename Value>
  struct Tagged {
    Value value;
  };
  using Array = std::vector<Json>;
  using Object = std::vector<JsonMember>;

  explicit Json(Tagged<bool> value) noexcept;
  explicit Json(Tagged<std::uint64_t> value) noexcept;
  explicit Json(Tagged<std::int64_t> value) noexcept;
  explicit Json(Tagged<double> value) noexcept;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] double real() const;
  [[nodiscard]] std::uint64_t integer() const;  ///< two's complement
  [[nodiscard]] bool equals(const Json& other) const;
  [[nodiscard]] const Json* member(std::string_view key) const noexcept;
  [[nodiscard]] Json& element(std::size_t index);
  [[nodiscard]] const Json& element(std::size_t index) const;
  void write(std::string& out) const;
  [[nodiscard]] static std::string real_text(double value);

  std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, Array, Object> value_;
};

struct JsonMember {
  std::string key;
  Json value;

  bool operator==(const JsonMember& other) const = default;
};

/// One item within braces: a value, or braces again.
class JsonItem {
 public:
  JsonItem() = default;
  JsonItem(std::initializer_list<JsonItem> items) : value_(items) {}
  template <typename Value>
  requires(!std::same_as<std::remove_cvref_t<Value>, JsonItem> && std::constructible_from<Json, Value>)
      JsonItem(Value&& value)
      : value_(std::forward<Value>(value)) {}

  [[nodiscard]] const Json& value() const noexcept { return value_; }
  /// The items of a list are constant, and live no longer than what is made of them.
  [[nodiscard]] Json release() const noexcept { return std::move(value_); }

 private:
  mutable Json value_;
};

/// Through the elements of an array or the values of an object.
template <typename Value>
class Json::Iterator {
 public:
  using Member = std::conditional_t<std::is_const_v<Value>, const JsonMember, JsonMember>;
  using iterator_category = std::forward_iterator_tag;
  using value_type = Json;
  using difference_type = std::ptrdiff_t;
  using pointer = Value*;
  using reference = Value&;

  Iterator() = default;
  explicit Iterator(Value* element) noexcept : element_(element) {}
  explicit Iterator(Member* member) noexcept : member_(member) {}

  reference operator*() const noexcept { return member_ != nullptr ? member_->value : *element_; }
  pointer operator->() const noexcept { return &**this; }
  Iterator& operator++() noexcept {
    if (member_ != nullptr)
      ++member_;
    else
      ++element_;
    return *this;
  }
  Iterator operator++(int) noexcept {
    const Iterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const Iterator& left, const Iterator& right) = default;
  operator Iterator<const Value>() const noexcept requires(!std::is_const_v<Value>) {
    return member_ != nullptr ? Iterator<const Value>(member_) : Iterator<const Value>(element_);
  }

 private:
  Value* element_ = nullptr;
  Member* member_ = nullptr;
};

/// Limits of a text; one beyond them is refused.
struct JsonLimits {
  std::size_t bytes = 16U << 20U;
  std::size_t depth = 64;  ///< arrays and objects within each other
};

/// The value of a whole text; the error gives the reason if there is none. Of members with the same key the
/// last value counts, at the position of the first.
[[nodiscard]] std::expected<Json, std::string> parse_json(std::string_view text, JsonLimits limits = {});

}  // namespace canopus::text
