#include "canopus/cli/run/table_body.hpp"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "canopus/plant/events/event_printer.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::cli {
namespace {

/// The fault of a node, worst first, or a state to remember.
enum class Severity : std::uint8_t {
  bus_off,
  failed,  ///< its boot, or the module has an error
  lost,    ///< a slave that is not booted
  error_passive,
  not_operational,
  emergency,  ///< its last EMCY is no "error reset"
  off,
  forced,  ///< values of the device are not its own
  none,
};

struct Entry {
  const plant::NodeStatus* status = nullptr;  ///< none: a slave that is no node of the plant
  plant::NodeLabel label{};
  double pdo_rate = 0;
  Severity severity = Severity::none;
  std::vector<TableSpan> reasons{};
};

/// The columns of the table for a terminal's width. 0: left out.
struct Columns {
  static constexpr std::size_t gap = 2;
  static constexpr std::size_t number = 4;
  static constexpr std::size_t state = 15;
  static constexpr std::size_t can = 7;
  std::size_t bus = 0;
  std::size_t name = 0;
  std::size_t emergency = 0;
  std::size_t controller = 0;
  std::size_t rate = 0;
};

Columns columns_for(const TableState& state, const std::vector<Entry>& entries, std::size_t columns) {
  Columns table;
  std::size_t name = 4;
  std::size_t bus = 3;
  for (const Entry& entry : entries)
    name = std::max(name, text::columns_of(text::printable(entry.label.name)));
  for (const TableState::Bus& one : state.buses)
    bus = std::max(bus, text::columns_of(text::printable(one.name)));
  name = std::min<std::size_t>(name, columns < 120 ? 28 : 60);
  bus = std::min<std::size_t>(bus, 10);
  const std::size_t fixed = Columns::number + Columns::gap + Columns::state;
  const std::size_t least_name = std::min<std::size_t>(name, 12);
  std::size_t taken = fixed + Columns::gap + least_name;
  const auto add = [&](std::size_t& column, std::size_t width) {
    if (taken + Columns::gap + width > columns) return;
    column = width;
    taken += Columns::gap + width;
  };
  if (state.buses.size() > 1) add(table.bus, bus);
  add(table.emergency, 9);
  add(table.controller, Columns::can);
  add(table.rate, 6);
  if (columns >= taken) {
    table.name = std::min(name, least_name + columns - taken);
  } else if (columns >= fixed + Columns::gap + 4) {
    table.name = columns - fixed - Columns::gap;
  }
  return table;
}

TableStyle state_style(const Entry& entry) {
  if (entry.status == nullptr || entry.severity <= Severity::failed) {
    return entry.severity == Severity::lost ? TableStyle::warning : TableStyle::error;
  }
  if (!entry.status->is_on) return TableStyle::faint;
  if (in_operation(*entry.status)) return TableStyle::good;
  return entry.status->state == canopen::NmtState::stopped ? TableStyle::error : TableStyle::warning;
}

std::string_view controller_name(can::ErrorState state) {
  switch (state) {
    case can::ErrorState::error_active: return "-";
    case can::ErrorState::error_passive: return "passive";
    case can::ErrorState::bus_off: return "bus-off";
  }
  return "-";
}

/// Without a column for the controller its fault is shown in place of the state.
std::string_view state_text(const Entry& entry, const Columns& columns) {
  if (entry.status == nullptr) return "not booted";
  if (columns.controller == 0 && entry.severity == Severity::bus_off) return "bus-off";
  if (columns.controller == 0 && entry.severity == Severity::error_passive) return "error passive";
  return state_name(*entry.status);
}

TableLine row(const Entry& entry, const Columns& columns) {
  const auto gap = std::string(Columns::gap, ' ');
  const bool has_number = entry.label.node_id >= 1 && entry.label.node_id <= 127;
  TableLine line{{fmt::format("{:>4}  ", has_number ? fmt::format("{}", entry.label.node_id) : "-")}};
  if (columns.bus != 0) line.push_back({padded(entry.label.bus, columns.bus) + gap});
  if (columns.name != 0) {
    line.push_back({padded(entry.label.name.empty() ? "-" : entry.label.name, columns.name) + gap});
  }
  line.push_back({padded(state_text(entry, columns), Columns::state), state_style(entry)});
  const plant::NodeStatus* status = entry.status;
  if (columns.emergency != 0) {
    std::string text = "-";
    if (status != nullptr && status->emergencies != 0) {
      text = fmt::format("{:04X}H", status->last_emergency);
      if (status->emergencies > 1 && status->emergencies < 100) {
        text += fmt::format(" x{}", status->emergencies);
      }
    }
    line.push_back({gap + padded(text, columns.emergency),
                    entry.severity == Severity::emergency ? TableStyle::warning : TableStyle::plain});
  }
  if (columns.controller != 0) {
    const can::ErrorState state = status == nullptr ? can::ErrorState::error_active : status->error_state;
    line.push_back({gap + padded(controller_name(state), columns.controller),
                    state == can::ErrorState::error_active    ? TableStyle::plain
                    : state == can::ErrorState::error_passive ? TableStyle::warning
                                                              : TableStyle::error});
  }
  if (columns.rate != 0) {
    line.push_back({gap + (status == nullptr ? std::string(columns.rate - 1, ' ') + "-"
                                             : fmt::format("{:>6.0f}", entry.pdo_rate))});
  }
  return line;
}

TableLine titles(const Columns& columns) {
  std::string text = "Node  ";
  if (columns.bus != 0) text += padded("Bus", columns.bus) + "  ";
  if (columns.name != 0) text += padded("Name", columns.name) + "  ";
  text += padded("NMT state", Columns::state);
  if (columns.emergency != 0) text += "  " + padded("Last EMCY", columns.emergency);
  if (columns.controller != 0) text += "  " + padded("CAN", columns.controller);
  if (columns.rate != 0) text += "   PDO/s";
  return {{text, TableStyle::bold}};
}

void add(Entry& entry, Severity severity, std::string reason, TableStyle style) {
  entry.severity = std::min(entry.severity, severity);
  if (!reason.empty()) entry.reasons.push_back({std::move(reason), style});
}

/// Evaluates the state of the node and of its controller.
void evaluate(Entry& entry) {
  const plant::NodeStatus& status = *entry.status;
  const auto counters = [&](std::string_view state) {
    return fmt::format("{}: TEC {}, REC {}", state, status.transmit_errors, status.receive_errors);
  };
  if (status.is_on && status.error_state == can::ErrorState::bus_off) {
    add(entry, Severity::bus_off, counters("bus-off"), TableStyle::error);
  } else if (status.is_on && status.error_state == can::ErrorState::error_passive) {
    add(entry, Severity::error_passive, counters("error passive"), TableStyle::warning);
  }
  if (!status.is_on) {
    add(entry, Severity::off, {}, TableStyle::faint);
  } else if (status.is_cut_off) {
    add(entry, Severity::not_operational, std::string(condition_name(status)), TableStyle::error);
  } else if (!in_operation(status)) {
    add(entry, Severity::not_operational, {}, TableStyle::warning);
  }
  constexpr std::uint16_t first_error = 0x1000;  // below: error reset or no error [CiA 301 7.2.7]
  if (status.emergencies != 0 && status.last_emergency >= first_error) {
    add(entry, Severity::emergency, {}, TableStyle::warning);
  }
}

void add_leds(Entry& entry, const plant::ModuleStatus& module) {
  for (const module::Led& led : module.leds) {
    if (!led.error || led.pattern == module::LedPattern::off) continue;
    add(entry, Severity::failed, fmt::format("LED {}: {}", led.name, module::name(led.pattern)),
        TableStyle::error);
  }
}

class Entries {
 public:
  explicit Entries(const TableState& state) : state_(state) {
    for (const TableState::Node& node : state.nodes) {
      places_.emplace(std::pair(node.status.label.bus, node.status.label.node_id), all_.size());
      all_.push_back(
          {.status = &node.status, .label = node.status.label, .pdo_rate = node.pdo_rate, .reasons = {}});
      evaluate(all_.back());
    }
    for (const plant::ModuleTrouble& trouble : state.troubles) {
      if (Entry* entry = find(trouble.module)) {
        add(*entry, Severity::failed, trouble.text, TableStyle::error);
      }
    }
    for (const plant::ModuleStatus& status : state.modules) {
      if (Entry* entry = find(status.label)) add_leds(*entry, status);
    }
    for (const plant::ForcedObject& forced : state.forced) {
      if (Entry* entry = find(forced.device)) {
        add(*entry, Severity::forced, describe_value(forced), TableStyle::warning);
      }
    }
    for (const plant::SlaveBoot& boot : state.boots) add_boot(boot);
    std::ranges::stable_sort(all_, {}, &Entry::severity);
  }
  [[nodiscard]] const std::vector<Entry>& all() const { return all_; }

 private:
  Entry* find(const plant::NodeLabel& label) {
    const auto found = std::ranges::find_if(all_, [&](const Entry& entry) {
      return entry.label.bus == label.bus && entry.label.name == label.name &&
             entry.label.node_id == label.node_id;
    });
    return found == all_.end() ? nullptr : &*found;
  }
  void add_boot(const plant::SlaveBoot& boot) {
    const auto key = std::pair(boot.slave.bus, boot.slave.node_id);
    if (boot.record.step == manager::BootStep::booted) {
      const auto found = places_.find(key);
      const plant::NodeStatus* const status = found == places_.end() ? nullptr : all_[found->second].status;
      if (boot.record.halted_by == 0 || status == nullptr || in_operation(*status)) return;
    }
    const auto [place, is_new] = places_.emplace(key, all_.size());
    if (is_new) all_.push_back({.label = boot.slave, .reasons = {}});
    const bool failed = boot.record.step == manager::BootStep::failed;
    add(all_[place->second], failed ? Severity::failed : Severity::lost,
        manager::explain(boot.record, state_.now), failed ? TableStyle::error : TableStyle::warning);
  }

  const TableState& state_;
  std::vector<Entry> all_;
  std::map<std::pair<std::string_view, std::uint8_t>, std::size_t> places_;
};

constexpr std::size_t indent = 6;

bool has_room_for_reasons(std::size_t columns) { return columns >= 4 * indent; }

/// The lines of what is wrong with a node.
std::vector<TableSpan> reason_lines(const Entry& entry, std::size_t columns) {
  std::vector<TableSpan> lines;
  for (const TableSpan& reason : entry.reasons) {
    for (std::string& text : wrapped(reason.text, columns - indent, 0)) {
      lines.push_back({std::string(indent, ' ') + text, reason.style});
    }
  }
  return lines;
}

}  // namespace

struct TableBody::Impl {
  Impl(const TableState& state, std::size_t all_columns, std::size_t room)
      : entries(state), columns(all_columns), table(columns_for(state, entries.all(), all_columns)) {
    const auto& all = entries.all();
    const auto well = std::ranges::find(all, Severity::none, &Entry::severity);
    const auto in_trouble = static_cast<std::size_t>(well - all.begin());
    in_full = has_room_for_reasons(columns) && add_in_full(in_trouble, room);
    if (!in_full) {
      lines.clear();
      for (std::size_t i = 0; i < in_trouble; ++i) {
        lines.push_back({i, is_row});
        if (has_room_for_reasons(columns) && !all[i].reasons.empty()) lines.push_back({i, 0});
      }
    }
    for (std::size_t i = in_trouble; i < all.size(); ++i) lines.push_back({i, is_row});
  }

  static constexpr std::size_t is_row = static_cast<std::size_t>(-1);
  struct Place {
    std::size_t entry;
    std::size_t reason;  ///< is_row, or a number in `reasons` (in full) or of the entry's own reasons
  };

  /// False: that would be too many lines.
  bool add_in_full(std::size_t in_trouble, std::size_t room) {
    const std::size_t others = entries.all().size() - in_trouble;
    for (std::size_t i = 0; i < in_trouble; ++i) {
      lines.push_back({i, is_row});
      for (TableSpan& reason : reason_lines(entries.all()[i], columns)) {
        lines.push_back({i, reasons.size()});
        reasons.push_back(std::move(reason));
      }
      if (lines.size() > room - room / 3 && lines.size() + others > room) return false;
    }
    return true;
  }

  Entries entries;
  std::size_t columns;
  Columns table;
  std::vector<Place> lines;
  bool in_full = false;
  std::vector<TableSpan> reasons;
  std::vector<TableLine> appended;
};

TableBody::TableBody(const TableState& state, std::size_t columns, std::size_t room)
    : impl_(std::make_unique<Impl>(state, columns, room)) {}

TableBody::~TableBody() = default;

TableLine TableBody::titles() const { return cli::titles(impl_->table); }

std::size_t TableBody::size() const noexcept { return impl_->lines.size() + impl_->appended.size(); }

TableLine TableBody::line(std::size_t number) const {
  if (number >= impl_->lines.size()) return impl_->appended[number - impl_->lines.size()];
  const Impl::Place place = impl_->lines[number];
  const Entry& entry = impl_->entries.all()[place.entry];
  if (place.reason == Impl::is_row) return row(entry, impl_->table);
  if (impl_->in_full) return {impl_->reasons[place.reason]};
  const TableSpan& worst = entry.reasons[place.reason];
  return {{std::string(indent, ' ') + fitted(worst.text, impl_->columns - indent), worst.style}};
}

std::size_t TableBody::nodes(std::size_t first, std::size_t end) const {
  std::size_t count = 0;
  for (std::size_t i = first; i < std::min(end, impl_->lines.size()); ++i) {
    count += impl_->lines[i].reason == Impl::is_row ? 1 : 0;
  }
  return count;
}

void TableBody::append(TableLine line) { impl_->appended.push_back(std::move(line)); }

std::size_t in_operation(const TableState& state) {
  return static_cast<std::size_t>(
      std::ranges::count_if(state.nodes, [](const auto& node) { return in_operation(node.status); }));
}

}  // namespace canopus::cli
