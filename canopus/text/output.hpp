#pragma once
// Lines that are safe to print, and where they go: every text in a line is made printable, so that a name in a device file cannot
// clear the screen or forge a line. JSON lines likewise.
//
//   out.line("{}: {} objects", file, count);

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "canopus/text/file_error.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::text {

class Line;

/// An argument for a {} in a line: text, a number, another line. It lasts as long as the call it is made for.
class LineArgument {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): it is made of what print_line() is given.
  template <typename T>
  LineArgument(const T& value) {
    if constexpr (std::is_same_v<T, Line>) {
      set_line(value);
    } else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, char>) {
      value_ = value;
    } else if constexpr (std::is_convertible_v<const T&, std::string_view>) {
      value_ = std::string_view(value);
    } else if constexpr (std::is_floating_point_v<T>) {
      value_ = value;
    } else if constexpr (std::is_signed_v<T>) {
      value_ = static_cast<std::int64_t>(value);
    } else {
      static_assert(std::is_unsigned_v<T>, "a line is made of text, numbers and other lines");
      value_ = static_cast<std::uint64_t>(value);
    }
  }

 private:
  friend class Line;
  struct Safe {
    const std::string* text;  ///< of a line: printable already
  };
  void set_line(const Line& line);
  std::variant<std::string_view, Safe, char, bool, std::int64_t, std::uint64_t, float, double> value_;
};

/// A line, or a part of one, that is safe to print: no text in it controls the terminal. Colours come from
/// paint() alone.
class Line {
 public:
  Line() = default;
  template <typename... T>
  explicit Line(fmt::format_string<const T&...> format, const T&... arguments) {
    add(format, arguments...);
  }
  template <typename... T>
  Line& add(fmt::format_string<const T&...> format, const T&... arguments) {
    const std::array<LineArgument, sizeof...(T)> list{LineArgument(arguments)...};
    const fmt::string_view text(format);
    return add_formatted({text.data(), text.size()}, list);
  }
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  friend Line paint(std::string_view text, std::string_view code, bool colour);
  Line& add_formatted(std::string_view format, std::span<const LineArgument> arguments);
  std::string text_;
};

/// The text between the escape sequence "\x1b[<code>m" and its end, or the text alone.
[[nodiscard]] Line paint(std::string_view text, std::string_view code, bool colour);

/// Somewhere lines go.
class Output {
 public:
  Output() = default;
  virtual ~Output() = default;
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  void line(const Line& line);
  template <typename... T>
  void line(fmt::format_string<const T&...> format, const T&... arguments) {
    line(Line(format, arguments...));
  }
  /// The object in one line.
  void json(const Json& object);
  /// A file's content as it is. Not for what people read.
  void content(std::string_view bytes) { write(bytes); }

 protected:
  virtual void write(std::string_view text) = 0;
};

/// Keeps what is printed.
class TextOutput final : public Output {
 public:
  [[nodiscard]] const std::string& text() const noexcept { return text_; }
  void clear() { text_.clear(); }

 private:
  void write(std::string_view text) override { text_ += text; }
  std::string text_;
};

/// Calls a function with what is printed.
class FunctionOutput final : public Output {
 public:
  explicit FunctionOutput(std::function<void(std::string_view)> write) : write_(std::move(write)) {}

 private:
  void write(std::string_view text) override { write_(text); }
  std::function<void(std::string_view)> write_;
};

/// The first hundred in the order of the file, and how many more there are.
void print_errors(std::vector<FileError> errors, const std::string& path, Output& err);

}  // namespace canopus::text

namespace fmt {

template <>
struct formatter<canopus::text::Line> : formatter<std::string_view> {
  auto format(const canopus::text::Line& line, format_context& context) const {
    return formatter<std::string_view>::format(line.text(), context);
  }
};

}  // namespace fmt
