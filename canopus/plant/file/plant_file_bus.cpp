// Connections of a bus to the outside of the plant, and to the plant's other buses.

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {
namespace {

constexpr std::string_view simulated = "sim";
constexpr std::string_view replay = "replay:";
constexpr std::string_view range_expected =
    "expected hexadecimal identifiers such as \"181\" or \"180-1FF\"; with 8 digits they have 29 bits";

struct ReadRange {
  IdentifierRange range{};
  bool extended = false;
};

/// As candump writes identifiers: 8 digits have 29 bits.
std::optional<ReadRange> read_range(std::string_view text) {
  const std::size_t dash = text.find('-');
  const std::string_view first = text.substr(0, dash);
  const std::string_view last = dash == std::string_view::npos ? first : text.substr(dash + 1);
  constexpr std::size_t extended_digits = 8;
  if (first.empty() || (first.size() == extended_digits) != (last.size() == extended_digits))
    return std::nullopt;
  const auto low = ascii::parse_number<std::uint32_t>(first, 16);
  const auto high = ascii::parse_number<std::uint32_t>(last, 16);
  const bool extended = first.size() == extended_digits;
  const std::uint32_t most = extended ? can::max_extended_identifier : can::max_base_identifier;
  if (!low || !high || *low > *high || *high > most) return std::nullopt;
  return ReadRange{{*low, *high}, extended};
}

bool contains(const std::vector<IdentifierRange>& ranges, std::uint32_t identifier) noexcept {
  return std::ranges::any_of(ranges, [=](const IdentifierRange& range) {
    return range.first <= identifier && identifier <= range.last;
  });
}

}  // namespace

bool BridgeSection::passes(const can::Frame& frame) const noexcept {
  if (identifiers.empty() && extended.empty()) return true;
  return contains(frame.extended ? extended : identifiers, frame.identifier);
}

std::expected<void, std::string> set_link(BusSection& bus, std::string_view text) {
  bus.link = text;
  bus.address.reset();
  bus.replay.clear();
  bus.replay_channel.clear();
  if (text == simulated) return {};
  if (text.starts_with(replay)) {
    const std::size_t hash = text.rfind('#');
    if (hash != std::string_view::npos) bus.replay_channel = text.substr(hash + 1);
    bus.replay = text.substr(replay.size(), hash == std::string_view::npos ? hash : hash - replay.size());
    if (bus.replay.empty())
      return std::unexpected("\"replay:\" has no file; expected replay:FILE or replay:FILE#CHANNEL");
  } else {
    auto address = link::parse_bus_address(text);
    if (!address) return std::unexpected(address.error() + "; or \"sim\", or \"replay:FILE\"");
    bus.address = std::move(*address);
  }
  if (bus.faults.empty()) return {};
  return std::unexpected(
      fmt::format("only a simulated bus can be disturbed, and there is a fault in line {}; expected "
                  "\"sim\"",
                  bus.faults.front().place.line));
}

LineSection::Node read_line_node(text::TableReader& table, const LineSection& line) {
  LineSection::Node section{.place = table.place()};
  section.node.port = table.text("port", true).value_or("");
  const auto number = [&](std::string_view key, double least, double most, const std::string& expected) {
    const auto found = table.number(key);
    if (found && (*found < least || *found > most)) table.error(key, expected);
    return found;
  };
  section.node.place = number("place", 0, line.length, fmt::format("expected 0 to {:g} m", line.length));
  section.node.stub = number("stub", 0, 100, "expected 0 to 100 m");
  section.node.clock_ppm = number("clock_ppm", -100'000, 100'000, "expected -100000 to 100000 ppm");
  return section;
}

void read_line(text::TableReader& table, BusSection& bus) {
  table.table("line", "bus.line", "expected a table, written as [bus.line]", [&](text::TableReader& inner) {
    LineSection& line = bus.line.emplace(LineSection{.place = inner.place()});
    const auto number = [&](std::string_view key, double most, std::string_view expected, double& value) {
      const auto found = inner.number(key);
      if (!found) return;
      if (*found < 0 || *found > most) return inner.error(key, expected);
      value = *found;
    };
    if (inner.find("length") == nullptr)
      inner.error("length", "expected the length of the line, 0 to 10000 m");
    number("length", 10'000, "expected 0 to 10000 m", line.length);
    number("stub", 100, "expected 0 to 100 m", line.stub);
    number("nanoseconds_per_metre", 10, "expected 0 to 10 ns", line.nanoseconds_per_metre);
    number("clock_ppm", 100'000, "expected 0 to 100000 ppm", line.clock_ppm);
    line.transceiver_delay =
        inner.parsed("transceiver_delay", text::parse_duration).value_or(line.transceiver_delay);
    const auto quanta = [&](std::string_view key, unsigned& value) {
      const auto found = inner.integer(key, 1, 8, "expected 1 to 8 time quanta");
      if (found) value = static_cast<unsigned>(*found);
    };
    sim::BitTiming timing;
    quanta("propagation", timing.propagation);
    quanta("phase1", timing.phase1);
    quanta("phase2", timing.phase2);
    quanta("jump_width", timing.jump_width);
    timing.triple_sampling = inner.boolean("triple_sampling").value_or(false);
    if (const std::string_view wrong = sim::problem(timing); !wrong.empty()) {
      return inner.error(inner.place(), fmt::format("the bit timing cannot be: {}", wrong));
    }
    line.timing = timing;
    line.is_exact = inner.boolean("exact").value_or(false);
    inner.tables("node", "bus.line.node",
                 [&](text::TableReader& node) { line.nodes.push_back(read_line_node(node, line)); });
    if (!line.nodes.empty() && !line.is_exact) {
      inner.error("node", "needs exact = true: otherwise nodes have no place");
    }
  });
}

void read_link(text::TableReader& table, BusSection& bus) {
  bus.link_place = table.place("link");
  const auto text = table.text("link");
  if (!text) return;
  if (const auto good = set_link(bus, *text); !good) {
    table.error(bus.link_place, fmt::format("link = {}", good.error()));
  }
}

BridgeSection read_bridge(text::TableReader& table) {
  BridgeSection bridge{.place = table.place()};
  bridge.from = table.text("from", true).value_or("");
  bridge.to = table.text("to", true).value_or("");
  bridge.both_ways = table.boolean("both_ways").value_or(false);
  const toml::node* node = table.find("identifiers");
  if (node == nullptr) return bridge;
  const auto* list = node->as_array();
  if (list == nullptr || list->empty()) {
    table.error("identifiers", range_expected);
    return bridge;
  }
  for (const toml::node& item : *list) {
    const auto* word = item.as_string();
    const auto range = word == nullptr ? std::nullopt : read_range(word->get());
    if (!range) {
      table.error(text::place_of(item.source()),
                  fmt::format("identifiers: {}, found {}", range_expected, text::describe_found(item)));
      continue;
    }
    (range->extended ? bridge.extended : bridge.identifiers).push_back(range->range);
  }
  return bridge;
}

}  // namespace canopus::plant
