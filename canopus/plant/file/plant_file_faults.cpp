#include <algorithm>

#include "canopus/can/frame.hpp"
#include "canopus/plant/file/fault_text.hpp"
#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/sim/bus/faults/termination.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {
namespace {

constexpr std::string_view identifier_expected =
    "an identifier is 0 to 7FFH, or to 1FFFFFFFH with extended = true";

/// { identifier = 0x123, data = [1, 2], extended = false, remote = false, dlc = 0 }
can::Frame read_frame(text::TableReader& table) {
  can::Frame frame;
  frame.extended = table.boolean("extended").value_or(false);
  frame.remote = table.boolean("remote").value_or(false);
  const auto highest = frame.extended ? can::max_extended_identifier : can::max_base_identifier;
  frame.identifier = static_cast<std::uint32_t>(
      table.integer("identifier", 0, highest, identifier_expected, true).value_or(0));
  table.elements("data", [&](const toml::node& element) {
    const auto* byte = element.as_integer();
    if (byte == nullptr || byte->get() < 0 || byte->get() > 255 || frame.dlc == 8) {
      return table.error(text::place_of(element.source()), "data: expected at most 8 numbers from 0 to 255");
    }
    frame.data[frame.dlc++] = static_cast<std::uint8_t>(byte->get());
  });
  if (const auto dlc = table.integer("dlc", 0, 15, "a DLC is 0 to 15"))
    frame.dlc = static_cast<std::uint8_t>(*dlc);
  std::fill(frame.data.begin() + static_cast<std::ptrdiff_t>(frame.length()), frame.data.end(),
            std::uint8_t{0});
  return frame;
}

struct FaultName {
  std::string_view name;
  sim::FaultKind kind;
};
constexpr FaultName fault_names[] = {
    {"drop", sim::FaultKind::drop},
    {"corrupt", sim::FaultKind::corrupt},
    {"duplicate", sim::FaultKind::duplicate},
    {"delay", sim::FaultKind::delay},
    {"babble", sim::FaultKind::babble},
    {"stuck dominant", sim::FaultKind::stuck_dominant},
    {"jam", sim::FaultKind::jam},
    {"cut", sim::FaultKind::cut},
    {"drive", sim::FaultKind::drive},
    {"stuck recessive", sim::FaultKind::stuck_recessive},
    {"late", sim::FaultKind::late},
    {"noise", sim::FaultKind::noise},
    {"overload", sim::FaultKind::overload},
    {"single-shot", sim::FaultKind::single_shot},
    {"early", sim::FaultKind::early},
    {"termination", sim::FaultKind::termination},
};

sim::FaultKind read_fault_kind(text::TableReader& table) {
  const std::string kind = table.text("kind", true).value_or("drop");
  const auto* known = std::ranges::find(fault_names, kind, &FaultName::name);
  if (known != std::end(fault_names)) return known->kind;
  std::vector<std::string_view> names;
  for (const FaultName& name : fault_names) names.push_back(name.name);
  table.error("kind", fmt::format("expected one of {}", fmt::join(names, ", ")));
  return sim::FaultKind::drop;
}

/// Which frames a fault hits.
void read_frames_hit(text::TableReader& table, sim::Fault& fault) {
  fault.extended = table.boolean("extended").value_or(false);
  const auto highest = fault.extended ? can::max_extended_identifier : can::max_base_identifier;
  if (const auto identifier = table.integer("identifier", 0, highest, identifier_expected)) {
    fault.identifier = static_cast<std::uint32_t>(*identifier);
  }
  fault.sender = table.text("sender").value_or("");
  const auto count = [&](std::string_view key, std::uint64_t otherwise) {
    const auto number = table.integer(key, 1, INT64_MAX, "expected 1 or more");
    return number ? static_cast<std::uint64_t>(*number) : otherwise;
  };
  fault.first = count("first", fault.first);
  fault.every = count("every", fault.every);
  fault.count = count("count", fault.count);
  fault.probability = table.number("probability").value_or(1.0);
  if (fault.probability < 0 || fault.probability > 1) table.error("probability", "expected 0 to 1");
}

/// The bits of a bit driver, and their start in a frame.
void read_driver(text::TableReader& table, sim::Fault& fault) {
  if (auto levels = table.parsed("bits", sim::parse_levels, true)) fault.levels = std::move(*levels);
  if (fault.levels.empty()) fault.levels = {sim::DrivenLevel::released};  // the error is reported
  if (const auto bit_time = table.parsed("bit_time", text::parse_duration)) {
    if (*bit_time <= can::Duration{}) table.error("bit_time", "expected a time longer than 0");
    fault.bit_time = *bit_time;
  }
  if (const auto name = table.text("field")) {
    can::FrameField field{};
    if (can::field_of(*name, field) && field <= can::FrameField::intermission) {
      fault.field = field;
    } else {
      std::vector<std::string_view> names;
      for (auto number = 1U; number <= static_cast<unsigned>(can::FrameField::intermission); ++number) {
        names.push_back(can::name(static_cast<can::FrameField>(number)));
      }
      table.error("field", fmt::format("expected one of {}", fmt::join(names, ", ")));
    }
  }
  if (!fault.field && table.find("bit") == nullptr) {
    for (const std::string_view key :
         {"identifier", "sender", "first", "every", "count", "probability", "until"}) {
      if (table.find(key) != nullptr)
        table.error(key, "needs a `field` or `bit` of a frame where the bits begin");
    }
  }
}

/// Noise, overload frames, early frames, termination.
void read_line_fault(text::TableReader& table, sim::Fault& fault) {
  if (fault.kind == sim::FaultKind::noise) {
    fault.bit_error_rate = table.number("bit_error_rate").value_or(0);
    if (!(fault.bit_error_rate > 0 && fault.bit_error_rate <= 1)) {
      table.error("bit_error_rate", "expected a number above 0, up to 1, for example 1e-5");
      fault.bit_error_rate = 1;
    }
  }
  if (fault.kind == sim::FaultKind::overload) {
    const auto frames = table.integer("overload_frames", 1, 2, "expected 1 or 2 overload frames");
    fault.overload_frames = static_cast<unsigned>(frames.value_or(1));
  }
  if (fault.kind == sim::FaultKind::early) {
    const auto bits = table.integer("early_bits", 1, sim::max_early_bits, "expected 1 to 10 bits");
    fault.early_bits = static_cast<unsigned>(bits.value_or(1));
  }
  if (fault.kind == sim::FaultKind::termination) {
    const auto resistors = table.integer("resistors", 0, sim::max_resistors,
                                         "expected 0 to 20 resistors; 2 are as it should be", true);
    fault.resistors = static_cast<unsigned>(resistors.value_or(2));
    fault.length = table.number("length").value_or(-1);
    if (!(fault.length >= 0 && fault.length <= sim::max_line_length)) {
      table.error("length", "expected 0 to 10000 m");
      fault.length = 0;
    }
  }
}

}  // namespace

FaultSection read_fault(text::TableReader& table) {
  FaultSection section{.place = table.place(), .text = table.as_text()};
  sim::Fault& fault = section.fault;
  fault.kind = read_fault_kind(table);
  fault.from = can::Time{} + table.parsed("from", text::parse_duration).value_or(can::Duration{});
  if (const auto until = table.parsed("until", text::parse_duration)) fault.until = can::Time{} + *until;
  if (fault.until <= fault.from) table.error("until", "must be later than from");

  using enum sim::FaultKind;
  if (fault.kind == drop || fault.kind == corrupt || fault.kind == duplicate || fault.kind == delay ||
      fault.kind == drive) {
    read_frames_hit(table, fault);
  } else if (fault.kind != termination) {
    table.elements("ports", [&](const toml::node& element) {
      const auto* name = element.as_string();
      if (name == nullptr) {
        return table.error(text::place_of(element.source()),
                           "ports: expected names of devices, for example [\"encoder\"]");
      }
      fault.ports.push_back(name->get());
    });
  }
  if (fault.kind == drop || fault.kind == corrupt) fault.receiver = table.text("receiver").value_or("");
  if (fault.kind == drive) read_driver(table, fault);
  if (fault.kind == corrupt || fault.kind == drive) {
    if (const auto bit = table.integer("bit", 0, 200, "a bit of a frame is 0 (SOF) to 200")) {
      fault.bit = static_cast<unsigned>(*bit);
    }
  }
  if (fault.kind == delay || fault.kind == late)
    fault.delay = table.parsed("delay", text::parse_duration, true).value_or(can::Duration{1});
  if (fault.kind == babble) {
    const toml::node* frame = table.find("frame");
    if (frame == nullptr || frame->as_table() == nullptr) {
      table.error("frame", "expected a frame, for example { identifier = 0x001, data = [0] }");
    } else {
      text::TableReader inner(*frame->as_table(), "frame", table.errors());
      fault.frame = read_frame(inner);
      inner.finish();
    }
    fault.interval = table.parsed("interval", text::parse_duration).value_or(can::Duration{});
  }
  read_line_fault(table, fault);
  if (fault.kind == jam) {
    const auto capacity = table.integer("capacity", 1, 65535, "expected 1 to 65535 frames");
    fault.capacity = static_cast<std::size_t>(capacity.value_or(16));
  }
  return section;
}

std::expected<FaultSection, std::string> read_fault(std::string_view text) {
  const auto root = text::parse_toml(text);
  if (!root)
    return std::unexpected(fmt::format("line {}: {}", root.error().place.line, root.error().message));
  std::vector<text::FileError> errors;
  text::TableReader table(*root, "fault", errors);
  FaultSection section = read_fault(table);
  table.finish();
  section.text = text;  // as written in the file
  if (errors.empty()) return section;
  return std::unexpected(fmt::format("line {}: {}", errors.front().place.line, errors.front().message));
}

}  // namespace canopus::plant
