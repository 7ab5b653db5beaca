// canopus plc dump, load and names: ranges of a PLC as CSV, and the names of words.

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/module_words.hpp"
#include "canopus/cli/plc/plc_access.hpp"
#include "canopus/client/plc_point.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::cli {

namespace {

using client::PlcPoint;

constexpr std::string_view header = "address,value";
constexpr std::uint32_t most_points = 1U << 20U;  // of one range

struct Range {
  PlcPoint first;
  std::uint32_t count = 1;
};

/// "D100..D199", or one address.
std::expected<Range, std::string> parse_range(const std::string& text, const PlcArguments& arguments) {
  const std::size_t dots = text.find("..");
  const auto first = plc_point(text.substr(0, dots), arguments);
  if (!first) return std::unexpected(first.error());
  if (dots == std::string::npos) return Range{*first, 1};
  const auto last = plc_point(text.substr(dots + 2), arguments);
  if (!last) return std::unexpected(last.error());
  if (!first->is_in_one_row_with(*last) || last->at.number < first->at.number) {
    return std::unexpected(fmt::format("'{}' is no range; expected for example D100..D199", text));
  }
  if (last->at.number - first->at.number >= most_points) {
    return std::unexpected(fmt::format("'{}' has more than {} points", text, most_points));
  }
  return Range{*first, last->at.number - first->at.number + 1};
}

/// Consecutive points, to write in one request.
struct Block {
  PlcPoint first;
  std::vector<std::uint16_t> values;
};

/// A line "D100,1234", added to the blocks. The error names what was expected.
std::expected<void, std::string> read_line(std::string_view line, const PlcArguments& arguments,
                                           std::vector<Block>& blocks) {
  const std::size_t comma = line.find(',');
  if (comma == std::string_view::npos) return std::unexpected(std::string("expected ADDRESS,VALUE"));
  const auto point = plc_point(line.substr(0, comma), arguments);
  if (!point) return std::unexpected(point.error());
  const std::string_view text = line.substr(comma + 1);
  std::uint16_t value = 0;
  if (point->is_bit()) {
    const auto bit = client::parse_plc_bit(text);
    if (!bit) return std::unexpected(bit.error());
    value = *bit ? 1 : 0;
  } else {
    const auto word = client::parse_plc_word(text);
    if (!word) return std::unexpected(word.error());
    value = *word;
  }
  const bool follows = !blocks.empty() && blocks.back().first.is_in_one_row_with(*point) &&
                       blocks.back().first.at.number + blocks.back().values.size() == point->at.number;
  if (!follows) blocks.push_back({*point, {}});
  blocks.back().values.push_back(value);
  return {};
}

std::expected<std::vector<Block>, std::string> read_blocks(const std::string& text, const std::string& name,
                                                           const PlcArguments& arguments) {
  std::vector<Block> blocks;
  std::string_view rest = text;
  for (unsigned number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || (number == 1 && line == header)) continue;
    if (const auto read = read_line(line, arguments, blocks); !read) {
      return std::unexpected(fmt::format("{}:{}: {}", name, number, text::printable(read.error())));
    }
  }
  return blocks;
}

}  // namespace

int dump_plc(const PlcArguments& arguments) {
  std::vector<Range> ranges;
  for (const std::string& text : arguments.values) {
    const auto range = parse_range(text, arguments);
    if (!range) return plc_failed(usage, range.error());
    ranges.push_back(*range);
  }
  return with_client(arguments, [&](client::PlcClient& client) {
    std::vector<std::string> lines{std::string(header)};
    for (const Range& range : ranges) {
      const auto values = read_values(client, range.first, range.count);
      if (!values) return plc_failed(refused, values.error());
      for (std::uint32_t i = 0; i < range.count; ++i) {
        const std::uint16_t value = (*values)[i];
        const std::string text = !range.first.is_bit() ? std::to_string(value) : value != 0 ? "ON" : "OFF";
        lines.push_back(shown_address(range.first, arguments, i) + ',' + text);
      }
    }
    if (arguments.file.empty()) {
      for (const std::string& line : lines) print_line("{}", line);
      return done;
    }
    std::string text;
    for (const std::string& line : lines) text += line + '\n';
    const auto written = write_new_file(arguments.file, text);
    return written ? done : plc_failed(refused, written.error());
  });
}

int load_plc(const PlcArguments& arguments) {
  std::string text;
  const std::string name = arguments.file == "-" ? "standard input" : arguments.file;
  if (arguments.file == "-") {
    text.assign(std::istreambuf_iterator<char>(std::cin), {});
  } else {
    auto read = text::read_file_or_reason(arguments.file);
    if (!read) return plc_failed(usage, fmt::format("{}: {}", name, read.error()));
    text = std::move(*read);
  }
  const auto blocks = read_blocks(text, name, arguments);
  if (!blocks) return plc_failed(usage, blocks.error());
  return with_client(arguments, [&](client::PlcClient& client) {
    std::size_t points = 0;
    for (const Block& block : *blocks) {
      int code = done;
      if (block.first.is_bit()) {
        const std::vector<std::uint8_t> bits(block.values.begin(), block.values.end());
        code = write_and_verify(client, block.first, arguments, std::span<const std::uint8_t>(bits));
      } else {
        code = write_and_verify(client, block.first, arguments, std::span<const std::uint16_t>(block.values));
      }
      if (code != done) return code;
      points += block.values.size();
    }
    print_line("{} written", ascii::counted(points, "point"));
    return done;
  });
}

int list_plc_names() {
  for (const plant::CatalogueEntry& entry : plant::module_catalogue()) {
    for (const NamedWords& words : named_words(entry)) {
      const std::string last = words.count() == 1 ? "" : fmt::format("..G{}", words.last);
      print_line("{:<12} G{}{:<10}  {}", entry.data_sheet->model, words.first, last, words.name);
    }
  }
  return done;
}

}  // namespace canopus::cli
