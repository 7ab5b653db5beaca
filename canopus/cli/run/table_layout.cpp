#include "canopus/cli/run/table_layout.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/cli/run/table_body.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using Lines = std::vector<TableLine>;

/// Most lines for the parts above and below the body.
struct Shares {
  explicit Shares(std::size_t rows)
      : buses(rows < 3 ? 0 : std::max<std::size_t>(1, rows / 6)),
        signals(rows < 7 ? 0 : std::max<std::size_t>(1, rows / 6)),
        titles(rows < 6 ? 0 : 1),
        messages(rows < 8 ? 0 : std::max<std::size_t>(1, rows / 6)),
        footer(rows < 4 ? 0 : rows / 2),
        gap(rows < 20 ? 0 : 1) {}
  std::size_t buses;
  std::size_t signals;
  std::size_t titles;
  std::size_t messages;
  std::size_t footer;
  std::size_t gap;  ///< blank lines between the parts
};

TableLine title(const TableState& state, std::size_t columns) {
  const std::size_t up = in_operation(state);
  const std::size_t all = state.nodes.size();
  const bool is_late = state.lag > std::chrono::milliseconds(20);
  std::vector<TableField> fields;
  fields.push_back({fmt::format("{}{}{} operational", up, columns < 60 ? "/" : " of ", all), 0,
                    up == all ? TableStyle::good : TableStyle::warning});
  fields.push_back({fmt::format("{:>8.1f} s", can::seconds(state.now)), 1});
  const std::string_view late = !is_late ? "late by" : columns < 60 ? "LATE" : "LATE by";
  fields.push_back({fmt::format("{} {}", late, text::describe_duration(state.lag)), is_late ? 0U : 2U,
                    is_late ? TableStyle::error : TableStyle::plain});
  const std::size_t name = std::max<std::size_t>(columns / 3, text::columns_of(text::printable(state.plant)));
  return line_of_fields(state.plant, name, std::move(fields), columns, TableStyle::bold);
}

TableLine bus_line(const TableState::Bus& bus, std::size_t name_columns, std::size_t columns) {
  const can::BusLoad& load = bus.load;
  std::vector<TableField> fields;
  fields.push_back({fmt::format("{:>4} kbit/s", bus.bit_rate / 1000), 1});
  fields.push_back({fmt::format("load {:>5.1f} %", load.now * 100), 0});
  fields.push_back({ascii::counted(load.error_frames, "error frame"), load.error_frames == 0 ? 3U : 1U,
                    load.error_frames == 0 ? TableStyle::plain : TableStyle::error});
  fields.push_back({fmt::format("peak {:>5.1f} %", load.peak * 100), 2});
  fields.push_back({ascii::counted(load.frames, "frame"), 4});
  return line_of_fields(bus.name, name_columns, std::move(fields), columns);
}

/// One line per bus; of too many first those with error frames.
Lines bus_lines(const TableState& state, std::size_t columns, std::size_t most) {
  std::size_t name_columns = 0;
  std::vector<const TableState::Bus*> buses;
  for (const TableState::Bus& bus : state.buses) {
    name_columns = std::max(name_columns, text::columns_of(text::printable(bus.name)));
    buses.push_back(&bus);
  }
  if (buses.size() > most) {
    std::ranges::stable_partition(buses,
                                  [](const TableState::Bus* bus) { return bus->load.error_frames != 0; });
  }
  Lines lines;
  for (const TableState::Bus* bus : buses) {
    lines.push_back(bus_line(*bus, std::min<std::size_t>(name_columns, 16), columns));
  }
  // The latest error of each bus, the longest line there is: only where that leaves room for all of them.
  const auto in_error = [](const TableState::Bus* bus) { return !bus->last_error.empty(); };
  if (lines.size() + static_cast<std::size_t>(std::ranges::count_if(buses, in_error)) > most) return lines;
  for (std::size_t i = buses.size(); i-- > 0;) {
    if (!in_error(buses[i])) continue;
    const std::string text = fitted("  last error " + text::printable(buses[i]->last_error), columns);
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(i) + 1, {{text, TableStyle::error}});
  }
  return lines;
}

/// "plc1 U0  X00 X02  Y03   G25 = 33281 (8201H)", in several lines where it has to be.
Lines signal_lines(const plant::ModuleStatus& module, std::size_t columns) {
  std::string text = module.plc.empty() ? std::string() : text::printable(module.plc) + " ";
  text += fmt::format("U{:X}", module.head / 16);
  Lines lines;
  const auto add = [&](std::string_view gap, const std::string& word) {
    if (text::columns_of(text) + gap.size() + text::columns_of(word) <= columns) {
      text += std::string(gap) + word;
      return;
    }
    lines.push_back({{std::exchange(text, "  " + word)}});
  };
  const auto add_signals = [&](char device, std::uint32_t signals) {
    std::string_view gap = "  ";
    for (unsigned number = 0; number < 32; ++number) {
      if ((signals >> number & 1U) == 0) continue;
      add(gap, fmt::format("{}{:02X}", device, module.head + number));
      gap = " ";
    }
  };
  if (!module.is_on) {
    add("  ", "off");
  } else if (module.cpu == module::CpuState::stop) {
    add("  ", "CPU in STOP");
  }
  add_signals('X', module.inputs);
  add_signals('Y', module.outputs);
  std::string_view gap = "   ";
  for (const plant::ModuleStatus::Word& word : module.words) {
    add(gap, fmt::format("G{} = {} ({:04X}H)", word.address, word.value, word.value));
    gap = "  ";
  }
  lines.push_back({{text}});
  return lines;
}

Lines all_signal_lines(const TableState& state, std::size_t columns) {
  Lines lines;
  for (const plant::ModuleStatus& module : state.modules) {
    for (TableLine& line : signal_lines(module, columns)) lines.push_back(std::move(line));
  }
  return lines;
}

/// At most this number of lines; if some are hidden, the last one is their number.
Lines at_most(Lines lines, std::size_t most, std::size_t columns) {
  if (lines.size() <= most) return lines;
  const std::size_t more = lines.size() - most;
  lines.resize(most);
  if (most == 0) return lines;
  const std::string note = fmt::format(" … {} more", more);
  const std::size_t width = text::columns_of(note);
  if (width + 8 > columns) return lines;
  lines.back() = fitted(std::move(lines.back()), columns - width);
  lines.back().push_back({note});
  return lines;
}

/// The latest errors and warnings, the newest one at the end.
Lines message_lines(const TableState& state, std::size_t columns, std::size_t most) {
  Lines lines;
  const std::uint64_t count = state.errors + state.warnings;
  if (count == 0 || most == 0) return lines;
  const std::string_view kind = state.warnings == 0 ? "error" : state.errors == 0 ? "warning" : "message";
  std::uint64_t shown = 0;
  for (std::size_t i = state.messages.size(); i-- > 0;) {
    const RunMessage& message = state.messages[i];
    std::string text = most == 1 && count > 1
                           ? fmt::format("{}: {}", ascii::counted(count, kind), message.text)
                           : fmt::format("{:.3f}  {}", can::seconds(message.time), message.text);
    const std::size_t reserved = count > shown + 1 && most > 1 ? 1 : 0;  // for how many more there are
    const std::size_t room = most - std::min(most, lines.size() + reserved);
    if (room == 0) break;
    std::vector<std::string> pieces = wrapped(text, columns, 6);
    if (pieces.size() > room && shown != 0) break;
    if (pieces.size() > room) {  // the newest one must be visible
      pieces.resize(room);
      std::string& end = pieces.back();
      end = std::string(text::clipped(end, columns - 1)) + "…";
    }
    Lines block;
    for (std::string& piece : pieces) {
      block.push_back({{std::move(piece), message.is_error ? TableStyle::error : TableStyle::warning}});
    }
    lines.insert(lines.begin(), block.begin(), block.end());
    ++shown;
  }
  if (count > shown && most > 1) {
    const bool is_printed = std::ranges::all_of(state.messages, &RunMessage::is_printed);
    std::string more = "… " + ascii::counted(count - shown, fmt::format("more {}", kind));
    if (!is_printed) more += ", printed when the run ends";
    lines.insert(lines.begin(), {{fitted(more, columns)}});
  }
  return lines;
}

Lines footer_lines(const TableState& state, bool help, std::size_t columns, std::size_t most) {
  Lines lines;
  std::string servers;
  for (const std::string& server : state.servers) servers += "   " + server;
  if (!help) {
    lines.push_back({{fitted((state.has_keys ? "q ends   ? help" : "Ctrl-C ends") + servers, columns)}});
  } else {
    std::vector<std::string> texts{
        "Up Down PageUp PageDown Home End: scroll   q or Ctrl-C: end the run   Ctrl-Z: suspend it   ?: close "
        "this help"};
    texts.insert(texts.end(), state.servers.begin(), state.servers.end());
    for (const std::string& text : texts) {
      for (std::string& line : wrapped(text, columns, 2)) lines.push_back({{std::move(line)}});
    }
  }
  return at_most(std::move(lines), most, columns);
}

/// The text for the hidden nodes above and below the visible part of the body.
std::string more_text(const TableBody& body, std::size_t first, std::size_t end) {
  const std::size_t above = body.nodes(0, first);
  const std::size_t below = body.nodes(end, body.size());
  if (above != 0 && below != 0) return fmt::format("… {} above, {} more nodes", above, below);
  if (below != 0) return "… " + ascii::counted(below, "more node");
  if (end < body.size()) return "… " + ascii::counted(body.size() - end, "more line");
  return fmt::format("… {} above", ascii::counted(above, "node"));
}

/// The part of the body that is shown, with what else there is.
Lines body_lines(const TableBody& body, TablePicture& picture, std::size_t height, std::size_t columns) {
  Lines lines;
  const bool all = body.size() <= height;
  const std::size_t shown = all ? body.size() : std::max<std::size_t>(1, height - 1);
  picture.page = std::max<std::size_t>(1, shown);
  picture.last = body.size() - shown;
  picture.first = std::min(picture.first, picture.last);
  const std::size_t end = picture.first + shown;
  for (std::size_t i = picture.first; i < end; ++i) lines.push_back(body.line(i));
  if (all) return lines;
  const std::string more = more_text(body, picture.first, end);
  if (height > 1) {
    lines.push_back({{fitted(more, columns)}});
  } else if (text::columns_of(more) + 8 <= columns) {
    lines.back() = fitted(std::move(lines.back()), columns - text::columns_of(more) - 1);
    lines.back().push_back({" " + more});
  }
  return lines;
}

void append(Lines& lines, Lines more) {
  lines.insert(lines.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// The latest events in what is left of the body, behind a blank line, and blank lines.
void fill(Lines& lines, const TableState& state, std::size_t height, std::size_t columns) {
  constexpr std::size_t most = 8;
  const std::size_t shown = std::min({state.events.size(), most, height - std::min<std::size_t>(height, 1)});
  const std::size_t end = lines.size() + height;
  if (shown > 0) lines.emplace_back();
  for (std::size_t i = state.events.size() - shown; i < state.events.size(); ++i) {
    lines.push_back({{fitted(state.events[i], columns)}});
  }
  lines.resize(end);
}

}  // namespace

TablePicture lay_out(const TableState& state, TableView view, TableSize size) {
  const std::size_t rows = std::max(1U, size.rows);
  const std::size_t columns = std::max(1U, size.columns);
  const Shares shares(rows);
  TablePicture picture{.first = view.first};
  Lines& lines = picture.lines;

  const Lines buses = bus_lines(state, columns, shares.buses);
  const Lines signals = all_signal_lines(state, columns);
  const Lines footer = footer_lines(state, view.help, columns, shares.footer);
  lines.push_back(title(state, columns));
  append(lines, at_most(buses, shares.buses, columns));
  append(lines, at_most(signals, shares.signals, columns));
  if (shares.gap != 0) lines.emplace_back();

  const std::size_t around = lines.size() + shares.titles + footer.size();
  const std::size_t room = rows > around ? rows - around : 0;  // for the body and the messages
  Lines messages =
      message_lines(state, columns, std::min(shares.messages, room - std::min<std::size_t>(room, 1)));
  const auto body_room = [&] {
    const std::size_t below = messages.size() + (messages.empty() ? 0 : shares.gap);
    return room - std::min(room, below);
  };
  TableBody body(state, columns, body_room());
  // Lines that did not fit above are at the end.
  if (signals.size() > shares.signals) {
    for (const TableLine& line : signals) body.append(line);
  }
  if (buses.size() > shares.buses) {
    for (const TableLine& line : buses) body.append(line);
  }
  // Room that the body leaves is for more of the messages, then for other events.
  if (body.size() < body_room()) {
    constexpr std::size_t most = 12;
    const std::size_t more = messages.size() + body_room() - body.size();
    messages = message_lines(state, columns, std::max(messages.size(), std::min(most, more)));
  }
  const std::size_t height = body_room();
  if (shares.titles != 0) lines.push_back(body.titles());
  if (height > 0) append(lines, body_lines(body, picture, height, columns));
  fill(lines, state, height - std::min(height, body.size()), columns);
  if (!messages.empty() && shares.gap != 0) lines.emplace_back();
  append(lines, std::move(messages));
  append(lines, footer);
  for (TableLine& line : lines) line = fitted(std::move(line), columns);
  if (lines.size() > rows) lines.resize(rows);
  return picture;
}

}  // namespace canopus::cli
