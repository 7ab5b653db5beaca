#include "canopus/app/live_table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/app/event_printer.hpp"
#include "canopus/app/printable.hpp"

namespace canopus::app {
namespace {

constexpr std::string_view bold = "1";
constexpr std::string_view red = "31";
constexpr std::string_view green = "32";
constexpr std::string_view yellow = "33";
constexpr std::size_t kept_events = 8;

std::string_view state_colour(const NodeStatus& node) {
  if (!node.is_on) return "2";
  if (node.layer2 != module::Layer2State::inactive) return in_operation(node) ? green : yellow;
  switch (node.state) {
    case canopen::NmtState::operational: return green;
    case canopen::NmtState::stopped: return red;
    default: return yellow;
  }
}

/// `text` in lines of at most `columns`, broken between words, the second and further ones indented.
std::vector<std::string> wrap(std::string_view text, std::size_t columns, std::size_t indent) {
  columns = std::max(columns, 2 * indent + 1);
  std::vector<std::string> lines;
  while (!text.empty()) {
    std::string line(lines.empty() ? 0 : indent, ' ');
    const std::size_t room = columns - line.size();
    std::size_t length = text.size();
    if (length > room) {
      const std::size_t blank = text.rfind(' ', room);
      length = blank == std::string_view::npos || blank == 0 ? room : blank;
    }
    lines.push_back(line += text.substr(0, length));
    text.remove_prefix(length);
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  }
  return lines;
}

}  // namespace

std::string LiveTable::paint(std::string_view text, std::string_view code) const {
  return colour_ ? fmt::format("\x1b[{}m{}\x1b[0m", code, text) : std::string(text);
}

void LiveTable::note(can::Time now, std::string text) {
  latest_.push_back(printable(fmt::format("{:>10.3f}  {}", can::seconds(now), text)));
  if (latest_.size() > kept_events) latest_.pop_front();
}

void LiveTable::lss_configured(const NodePlate& node, std::uint32_t bit_rate, can::Time now) {
  note(now, describe_lss(node, bit_rate));
}

void LiveTable::emergency(const NodePlate& node, const canopen::Emergency& message, can::Time now) {
  note(now, fmt::format("{}: EMCY {:04X}H, error register {:02X}H", describe(node), message.code,
                        message.error_register));
}

void LiveTable::unacknowledged(const NodePlate& node, can::Time now) {
  note(now, describe_unacknowledged(node));
}

void LiveTable::nmt_state_changed(const NodePlate& node, canopen::NmtState state, can::Time now) {
  note(now, fmt::format("{}: {}", describe(node), canopen::name(state)));
}

void LiveTable::slave_boot_went_on(const NodePlate& slave, const NodePlate&,
                                   const manager::BootRecord& record, can::Time now) {
  const bool ended = record.step == manager::BootStep::booted || record.step == manager::BootStep::failed;
  if (ended) note(now, fmt::format("{}: {}", describe(slave), manager::describe(record)));
}

void LiveTable::error(std::string_view source, std::string_view message, can::Time now) {
  note(now, fmt::format("{}: {}", source, message));
}

std::vector<std::string> LiveTable::draw_boots(can::Time now, std::size_t rows, unsigned columns) const {
  std::vector<std::string> lines;
  std::size_t left_out = 0;
  for (const SlaveBoot& boot : plant_->boots()) {
    const std::string trouble = describe_trouble(boot, now);
    if (trouble.empty()) continue;
    const bool failed = boot.record.step == manager::BootStep::failed;
    const std::vector<std::string> wrapped = wrap(printable(trouble), columns, 6);
    if (lines.size() + wrapped.size() + 1 > rows) {
      ++left_out;
      continue;
    }
    for (const std::string& line : wrapped) lines.push_back(paint(line, failed ? red : yellow));
  }
  for (const ModuleTrouble& trouble : plant_->troubles()) {
    const std::vector<std::string> wrapped =
        wrap(fmt::format("{}: {}", describe(trouble.module), trouble.text), columns, 6);
    if (lines.size() + wrapped.size() > rows) break;
    for (const std::string& line : wrapped) lines.push_back(paint(line, red));
  }
  if (left_out > 0) {
    lines.push_back(fmt::format("and {} slave{} more not booted", left_out, left_out == 1 ? "" : "s"));
  }
  return lines;
}

std::string LiveTable::draw(can::Time now, can::Duration lag, TableSize size) {
  const std::vector<NodeStatus> nodes = plant_->nodes();
  counts_.resize(nodes.size());
  const double span = can::seconds(can::Time{} + (now - counted_at_));
  if (span >= 1) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      counts_[i].rate = static_cast<double>(nodes[i].pdos - counts_[i].pdos) / span;
      counts_[i].pdos = nodes[i].pdos;
    }
    counted_at_ = now;
  }

  std::vector<std::string> lines;
  lines.push_back(
      paint(fmt::format("{:<40.40} {:>10.1f} s   {}", printable(plant_->name()), can::seconds(now),
                        lag > std::chrono::milliseconds(20) ? fmt::format("LATE by {}", describe(lag))
                                                            : fmt::format("late by {}", describe(lag))),
            bold));
  for (std::size_t i = 0; i < plant_->bus_count(); ++i) {
    const sim::Bus& bus = plant_->bus(i);
    const sim::BusLoad load = bus.load(now);
    const std::string errors = fmt::format("{} error frames", load.error_frames);
    lines.push_back(
        fmt::format("{:<16.16} {:>5} kbit/s   load {:>5.1f} %   peak {:>5.1f} %   {:>9} frames   {}",
                    printable(bus.name()), bus.bit_rate() / 1000, load.now * 100, load.peak * 100,
                    load.frames, load.error_frames == 0 ? errors : paint(errors, red)));
  }
  lines.emplace_back();
  lines.push_back(
      paint(fmt::format("{:>4}  {:<28}  {:<16} {:>8}  {}", "Node", "Name", "NMT state", "PDO/s", "Last EMCY"),
            bold));
  const std::vector<std::string> boots = draw_boots(now, size.rows / 3, size.columns);
  const std::size_t below = 2 + boots.size() + (boots.empty() ? 0 : 1) +
                            std::min<std::size_t>(latest_.size(), kept_events) + (doors_.empty() ? 0 : 1);
  const std::size_t room = size.rows > lines.size() + below + 1 ? size.rows - lines.size() - below - 1 : 1;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (i + 1 == room && nodes.size() > room) {
      lines.push_back(fmt::format("      and {} more", nodes.size() - i));
      break;
    }
    const NodeStatus& node = nodes[i];
    const std::string state = fmt::format("{:<16}", state_name(node));
    const std::string number =
        node.plate.node_id >= 1 && node.plate.node_id <= 127 ? fmt::format("{}", node.plate.node_id) : "-";
    const std::string emergency = node.emergencies == 0 ? "-" : fmt::format("{:04X}H", node.last_emergency);
    lines.push_back(fmt::format("{:>4}  {:<28.28}  {} {:>8.0f}  {}", number, printable(node.plate.name),
                                paint(state, state_colour(node)), counts_[i].rate, emergency));
  }
  lines.emplace_back();
  if (!boots.empty()) {
    lines.insert(lines.end(), boots.begin(), boots.end());
    lines.emplace_back();
  }
  for (const std::string& event : latest_) lines.emplace_back(clipped(event, size.columns));
  if (!doors_.empty()) {
    std::string doors;
    for (const std::string& door : doors_) doors += door + "   ";
    lines.push_back(doors + "Ctrl-C stops");
  }
  if (lines.size() >= size.rows) lines.resize(size.rows - 1);
  std::string picture;
  for (const std::string& line : lines) picture += line + "\x1b[K\n";
  return picture;
}

}  // namespace canopus::app
