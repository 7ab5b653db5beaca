#include "canopus/text/output.hpp"

#include <algorithm>
#include <functional>
#include <iterator>

#include <fmt/args.h>

namespace canopus::text {

void LineArgument::set_line(const Line& line) { value_ = Safe{&line.text()}; }

Line& Line::add_formatted(std::string_view format, std::span<const LineArgument> arguments) {
  fmt::dynamic_format_arg_store<fmt::format_context> values;
  values.reserve(arguments.size(), 0);
  std::vector<std::string> texts;  // the values refer to them
  texts.reserve(arguments.size());
  for (const LineArgument& argument : arguments) {
    std::visit(
        [&values, &texts]<typename T>(const T& value) {
          if constexpr (std::is_same_v<T, LineArgument::Safe>) {
            values.push_back(std::cref(*value.text));
          } else if constexpr (std::is_same_v<T, std::string_view>) {
            values.push_back(std::cref(texts.emplace_back(printable(value))));
          } else if constexpr (std::is_same_v<T, char>) {
            values.push_back(std::cref(texts.emplace_back(printable({&value, 1}))));
          } else {
            values.push_back(value);
          }
        },
        argument.value_);
  }
  fmt::vformat_to(std::back_inserter(text_), fmt::string_view(format.data(), format.size()), values);
  return *this;
}

Line paint(std::string_view text, std::string_view code, bool colour) {
  Line line;
  line.text_ = colour ? fmt::format("\x1b[{}m{}\x1b[0m", code, printable(text)) : printable(text);
  return line;
}

void Output::line(const Line& line) { write(line.text() + '\n'); }

void Output::json(const Json& object) { write(printable_json(object.dump()) + '\n'); }

void print_errors(std::vector<FileError> errors, const std::string& path, Output& err) {
  constexpr std::size_t enough_errors = 100;
  std::ranges::stable_sort(errors, {}, &FileError::place);
  for (std::size_t i = 0; i < errors.size() && i < enough_errors; ++i)
    err.line("{}", describe(errors[i], path));
  if (errors.size() > enough_errors) {
    err.line("{}: {} more mistakes", path, errors.size() - enough_errors);
  }
}

}  // namespace canopus::text
