#include "canopus/cli/files/eds_show.hpp"

#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/plant/file/process_value.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

using canopen::DataType;
using canopen::DictionaryDescription;
using canopen::Entry;
using canopen::ObjectDescription;
using Json = text::Json;

constexpr std::size_t line_width = 80;

/// In which PDOs it may be mapped.
std::string_view mappable(const canopen::EntryDescription& entry) {
  if (entry.rpdo_mappable && entry.tpdo_mappable) return "RPDO TPDO";
  return entry.rpdo_mappable ? "RPDO" : entry.tpdo_mappable ? "TPDO" : "-";
}

/// A value of the file: fixed, or a constant plus the node-ID.
struct Default {
  std::uint64_t value = 0;
  bool adds_node_id = false;
};

class Sheet {
 public:
  explicit Sheet(const eds::DeviceFile& file) : file_(file), dictionary_(*file.dictionary) {}

  void print(Output& out) const;
  [[nodiscard]] Json json() const;

 private:
  /// A sub-index, or all sub-indexes from 01H on of an object with equal sub-indexes.
  struct Row {
    Entry entry;
    std::uint8_t last = 0;
  };
  struct Mapped {
    std::uint16_t index = 0;
    std::uint8_t sub = 0;
    unsigned bits = 0;
  };
  struct Pdo {
    std::string name;  // "TPDO1"
    std::optional<Default> cob_id{};
    std::optional<std::uint8_t> type{};
    std::uint16_t inhibit_time = 0;  // 100 us
    std::uint16_t event_timer = 0;   // ms
    std::vector<Mapped> mapped{};
  };

  [[nodiscard]] std::vector<Row> rows() const;
  [[nodiscard]] std::vector<Pdo> pdos() const;
  [[nodiscard]] Pdo pdo(const ObjectDescription& communication) const;
  [[nodiscard]] std::optional<Default> value(std::uint16_t index, std::uint8_t sub) const;
  [[nodiscard]] std::string default_text(const Entry& entry) const;
  [[nodiscard]] static std::string cob_id_text(const std::optional<Default>& cob_id);
  [[nodiscard]] static std::string type_text(const Pdo& pdo);
  [[nodiscard]] std::string mapped_name(const Mapped& mapped) const;
  void print_head(Output& out) const;

  const eds::DeviceFile& file_;
  const DictionaryDescription& dictionary_;
};

/// A line of at most 80 columns; a longer one is cut and ends with two dots.
void print_cut(Output& out, const std::string& beginning, std::string_view name) {
  std::string text = beginning + text::printable(name);
  if (text::columns_of(text) > line_width) text = std::string(text::clipped(text, line_width - 2)) + "..";
  out.line("{}", text);
}

std::optional<Default> Sheet::value(std::uint16_t index, std::uint8_t sub) const {
  const auto without = eds::default_value(dictionary_, index, sub, 0);
  const auto with = eds::default_value(dictionary_, index, sub, 1);
  if (!without || !with) return std::nullopt;
  return Default{*without, *without != *with};
}

std::vector<Sheet::Row> Sheet::rows() const {
  std::vector<Row> all;
  for (const ObjectDescription& object : dictionary_.objects()) {
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const Entry entry = dictionary_.find(object, static_cast<std::uint8_t>(sub));
      if (!entry) continue;
      const bool stands_for_all = object.uniform && sub == 1;
      all.push_back({entry, stands_for_all ? object.highest_sub : entry.sub});
      if (stands_for_all) break;
    }
  }
  return all;
}

Sheet::Pdo Sheet::pdo(const ObjectDescription& communication) const {
  const bool transmits = communication.index >= 0x1800;
  const unsigned number = (communication.index & 0x1FFU) + 1;
  const auto number_of = [&](std::uint8_t sub) {
    const auto found = value(communication.index, sub);
    return found ? std::optional(found->value) : std::nullopt;
  };
  Pdo pdo{.name = fmt::format("{}{}", transmits ? "TPDO" : "RPDO", number),
          .cob_id = value(communication.index, 1)};
  if (const auto type = number_of(2)) pdo.type = static_cast<std::uint8_t>(*type);
  if (transmits) pdo.inhibit_time = static_cast<std::uint16_t>(number_of(3).value_or(0));
  pdo.event_timer = static_cast<std::uint16_t>(number_of(5).value_or(0));
  const auto mapping = static_cast<std::uint16_t>(communication.index + 0x200);
  const auto count = value(mapping, 0);
  for (std::uint8_t i = 1; count && i <= count->value && i <= 64; ++i) {
    const auto entry = value(mapping, i);
    if (!entry) continue;
    pdo.mapped.push_back({static_cast<std::uint16_t>(entry->value >> 16),
                          static_cast<std::uint8_t>(entry->value >> 8),
                          static_cast<unsigned>(entry->value & 0xFF)});
  }
  return pdo;
}

std::vector<Sheet::Pdo> Sheet::pdos() const {
  std::vector<Pdo> all;
  for (const ObjectDescription& object : dictionary_.objects()) {
    if ((object.index >= 0x1400 && object.index < 0x1600) ||
        (object.index >= 0x1800 && object.index < 0x1A00))
      all.push_back(pdo(object));
  }
  return all;
}

std::string Sheet::default_text(const Entry& entry) const {
  const DataType type = entry.description->type;
  if (canopen::is_variable_length(type)) {
    const auto& bytes = dictionary_.default_slot(entry.offset);
    if (bytes.empty()) return "-";
    if (type != DataType::visible_string) return ascii::counted(bytes.size(), "byte");
    return fmt::format("\"{}\"", std::string(bytes.begin(), bytes.end()));
  }
  const auto found = value(entry.index, entry.sub);
  if (!found) return "-";
  const bool is_plain = canopen::is_signed(type) || !eds::is_number(type) || type == DataType::boolean ||
                        type == DataType::real32 || type == DataType::real64;
  if (is_plain) return plant::show_value(type, found->value);
  return found->adds_node_id ? fmt::format("{:X}H+node", found->value)
                             : fmt::format("{:0{}X}H", found->value, 2 * canopen::byte_length(type));
}

std::string Sheet::cob_id_text(const std::optional<Default>& cob_id) {
  if (!cob_id) return "no COB-ID";
  const bool extended = (cob_id->value & 0x2000'0000) != 0;
  std::string text =
      fmt::format("{:0{}X}H", cob_id->value & (extended ? 0x1FFF'FFFFU : 0x7FFU), extended ? 8 : 3);
  if (cob_id->adds_node_id) text += "+node";
  if ((cob_id->value & 0x8000'0000) != 0) text += ", off";
  return text;
}

std::string Sheet::type_text(const Pdo& pdo) {
  if (!pdo.type) return "";
  const unsigned type = *pdo.type;
  std::string text = type == 0     ? "on SYNC after an event"
                     : type == 1   ? "on every SYNC"
                     : type <= 240 ? fmt::format("on every {}. SYNC", type)
                     : type == 252 ? "on SYNC and RTR"
                     : type == 253 ? "on RTR"
                     : type >= 254 ? "event-driven"
                                   : "reserved";
  text += fmt::format(" (type {})", type);
  if (pdo.inhibit_time != 0) text += fmt::format(", inhibit {:g} ms", pdo.inhibit_time / 10.0);
  if (pdo.event_timer != 0) text += fmt::format(", timer {} ms", pdo.event_timer);
  return text;
}

std::string Sheet::mapped_name(const Mapped& mapped) const {
  const Entry entry = dictionary_.find(mapped.index, mapped.sub);
  if (entry) return std::string(dictionary_.name(entry));
  return mapped.index < 0x0020 && mapped.sub == 0 ? "(filler)" : "(no such object)";
}

void Sheet::print_head(Output& out) const {
  const eds::DeviceInfo& device = file_.device;
  print_cut(out, "product    ", device.product_name);
  print_cut(out, "vendor     ", device.vendor_name);
  if (!device.order_code.empty()) print_cut(out, "order code ", device.order_code);
  if (!file_.file.description.empty()) print_cut(out, "about      ", file_.file.description);
  const eds::Identity identity = eds::identity(file_);
  const auto number = [](const std::optional<std::uint32_t>& value) {
    return value ? fmt::format("{:08X}H", *value) : std::string("-");
  };
  out.line("1000H      device type {}", number(identity.device_type));
  out.line("1018H      vendor-ID {}, product {}, revision {}", number(identity.vendor_id),
           number(identity.product_code), number(identity.revision));
  std::vector<double> rates;
  for (const std::uint32_t rate : device.bit_rates) rates.push_back(rate / 1000.0);
  if (!rates.empty()) out.line("kbit/s     {}", fmt::format("{}", fmt::join(rates, " ")));
  if (device.lss) out.line("LSS        yes");
  if (!file_.commissioning) return;
  out.line("DCF for    node-ID {}, {} kbit/s",
           file_.commissioning->node_id ? std::to_string(*file_.commissioning->node_id) : std::string("-"),
           file_.commissioning->bit_rate / 1000);
}

void Sheet::print(Output& out) const {
  print_head(out);
  out.line("");
  out.line("{:<10} {:<14} {:<6} {:<14} {:<9} {}", "object", "type", "access", "default", "PDO", "name");
  for (const Row& row : rows()) {
    std::string object = canopen::object_text(row.entry.index, row.entry.sub);
    if (row.last != row.entry.sub) object += fmt::format("-{:02X}", row.last);
    std::string value = text::printable(default_text(row.entry));
    if (text::columns_of(value) > 14) value = std::string(text::clipped(value, 12)) + "..";
    const canopen::EntryDescription& entry = *row.entry.description;
    print_cut(
        out,
        fmt::format("{:<10} {:<14} {:<6} {}{} {:<9} ", object, eds::name(entry.type), eds::name(entry.access),
                    value, std::string(14 - text::columns_of(value), ' '), mappable(entry)),
        dictionary_.name(row.entry));
    if (const eds::EntryFacts* facts = file_.find_facts(row.entry.index, row.entry.sub)) {
      for (const std::string& text : {facts->object_description.text(), facts->description.text()}) {
        if (!text.empty()) print_cut(out, std::string(11, ' '), text);
      }
    }
  }
  for (const Pdo& pdo : pdos()) {
    out.line("");
    out.line("{} {}{}{}", pdo.name, cob_id_text(pdo.cob_id), pdo.type ? ", " : "", type_text(pdo));
    if (pdo.mapped.empty()) out.line("  nothing mapped");
    for (const Mapped& mapped : pdo.mapped) {
      print_cut(out,
                fmt::format("  {} {:>3} bit  ", canopen::object_text(mapped.index, mapped.sub), mapped.bits),
                mapped_name(mapped));
    }
  }
}

Json Sheet::json() const {
  const eds::Identity identity = eds::identity(file_);
  Json sheet{{"vendor", file_.device.vendor_name},
             {"product", file_.device.product_name},
             {"order_code", file_.device.order_code},
             {"description", file_.file.description}};
  const auto add = [&](const char* key, const std::optional<std::uint32_t>& number) {
    if (number) sheet[key] = *number;
  };
  add("device_type", identity.device_type);
  add("vendor_id", identity.vendor_id);
  add("product_code", identity.product_code);
  add("revision", identity.revision);
  sheet["bit_rates"] = file_.device.bit_rates;
  sheet["lss"] = file_.device.lss;
  if (file_.commissioning && file_.commissioning->node_id) sheet["node"] = *file_.commissioning->node_id;
  sheet["objects"] = Json::array();
  for (const Row& row : rows()) {
    const canopen::EntryDescription& entry = *row.entry.description;
    Json object{{"object", canopen::object_text(row.entry.index, row.entry.sub)},
                {"name", dictionary_.name(row.entry)},
                {"type", eds::name(entry.type)},
                {"access", eds::name(entry.access)},
                {"rpdo", entry.rpdo_mappable},
                {"tpdo", entry.tpdo_mappable}};
    if (row.last != row.entry.sub) object["last_sub"] = row.last;
    if (canopen::is_variable_length(entry.type)) {
      if (entry.type == DataType::visible_string) {
        const auto& bytes = dictionary_.default_slot(row.entry.offset);
        object["default"] = std::string(bytes.begin(), bytes.end());
      }
    } else if (const auto found = value(row.entry.index, row.entry.sub)) {
      object["default"] = plant::json_value(entry.type, found->value);
      if (found->adds_node_id) object["adds_node_id"] = true;
    }
    if (const eds::EntryFacts* facts = file_.find_facts(row.entry.index, row.entry.sub)) {
      if (!facts->description.empty()) object["description"] = facts->description.text();
      if (!facts->object_description.empty()) object["object_description"] = facts->object_description.text();
    }
    sheet["objects"].push_back(std::move(object));
  }
  sheet["pdos"] = Json::array();
  for (const Pdo& pdo : pdos()) {
    Json shown{{"pdo", pdo.name}};
    if (pdo.cob_id) {
      shown["cob_id"] = pdo.cob_id->value;
      shown["adds_node_id"] = pdo.cob_id->adds_node_id;
      shown["valid"] = (pdo.cob_id->value & 0x8000'0000) == 0;
    }
    if (pdo.type) shown["transmission_type"] = *pdo.type;
    if (pdo.inhibit_time != 0) shown["inhibit_time"] = pdo.inhibit_time;
    if (pdo.event_timer != 0) shown["event_timer"] = pdo.event_timer;
    shown["mapping"] = Json::array();
    for (const Mapped& mapped : pdo.mapped) {
      shown["mapping"].push_back({{"object", canopen::object_text(mapped.index, mapped.sub)},
                                  {"bits", mapped.bits},
                                  {"name", mapped_name(mapped)}});
    }
    sheet["pdos"].push_back(std::move(shown));
  }
  return sheet;
}

}  // namespace

int eds_show(const std::string& file, bool json, Output& out, Output& err) {
  const auto text = file == "-" ? text::read_standard_input() : text::read_file_or_reason(file);
  if (!text) {
    err.line("canopus: {}: {}", file, text.error());
    return 2;
  }
  const eds::ReadResult result = eds::read_device_file(*text);
  if (result.file == nullptr) {
    const eds::Problem& problem = result.problems.front();
    err.line("{}:{}: error: {}", file == "-" ? "<stdin>" : file, problem.line, problem.message);
    return 1;
  }
  const Sheet sheet(*result.file);
  if (json) {
    out.json(sheet.json());
  } else {
    sheet.print(out);
  }
  return 0;
}

}  // namespace canopus::cli
