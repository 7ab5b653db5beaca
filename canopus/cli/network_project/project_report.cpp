// A project, and optionally its bus, as one HTML page.

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/cli/bus/scan_command.hpp"
#include "canopus/cli/network_project/bus_objects.hpp"
#include "canopus/cli/network_project/network_check.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/client/sdo_value.hpp"
#include "canopus/network_project/network_load.hpp"
#include "canopus/network_project/pdo_link.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::cli {
namespace {

/// An HTML page in one file, without scripts and without anything from elsewhere. Every text is escaped.
class ReportPage {
 public:
  explicit ReportPage(std::string_view title);

  void heading(std::string_view text);
  void paragraph(std::string_view text);
  void begin_table(const std::vector<std::string>& columns);
  /// `mark`: "", "good", "bad" or "note": the style of the row.
  void row(const std::vector<std::string>& cells, std::string_view mark = "");
  void end_table();
  /// The whole page.
  [[nodiscard]] std::string text() const;

 private:
  void add(std::string_view tag, std::string_view text);
  std::string body_;
  std::string title_;
};

constexpr std::string_view style =
    "body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:75rem;padding:0 "
    "1rem;color-scheme:light dark}"
    "h1{font-size:1.6rem}h2{font-size:1.15rem;margin-top:2rem}"
    "table{border-collapse:collapse;width:100%;font-size:.9rem}"
    "th,td{text-align:left;vertical-align:top;padding:.25rem .6rem;border-bottom:1px solid #8885}"
    "th{font-weight:600}tr.bad td{background:#f003}tr.note td{opacity:.75}tr.good td{background:#0a03}"
    "@media print{body{margin:0;max-width:none}}";

/// Names come from strangers' files.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text::printable(text)) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  }
  return result;
}

ReportPage::ReportPage(std::string_view title) : title_(escaped(title)) { add("h1", title); }

void ReportPage::add(std::string_view tag, std::string_view text) {
  body_ += fmt::format("<{}>{}</{}>\n", tag, escaped(text), tag);
}

void ReportPage::heading(std::string_view text) { add("h2", text); }

void ReportPage::paragraph(std::string_view text) { add("p", text); }

void ReportPage::begin_table(const std::vector<std::string>& columns) {
  body_ += "<table>\n<thead><tr>";
  for (const std::string& column : columns)
    body_ += fmt::format("<th scope=\"col\">{}</th>", escaped(column));
  body_ += "</tr></thead>\n<tbody>\n";
}

void ReportPage::row(const std::vector<std::string>& cells, std::string_view mark) {
  body_ += mark.empty() ? std::string("<tr>") : fmt::format("<tr class=\"{}\">", mark);
  for (const std::string& cell : cells) body_ += fmt::format("<td>{}</td>", escaped(cell));
  body_ += "</tr>\n";
}

void ReportPage::end_table() { body_ += "</tbody>\n</table>\n"; }

std::string ReportPage::text() const {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n"
      "{}</body>\n</html>\n",
      title_, style, body_);
}

using client::FoundNode;
using master::ComparedValue;
using network_project::NetworkProject;
using network_project::Pdo;
using network_project::ProjectNode;

std::string hexadecimal(std::optional<std::uint32_t> value) {
  return value ? fmt::format("{:08X}H", *value) : std::string("-");
}

void add_nodes(ReportPage& page, const NetworkProject& project) {
  page.heading("Nodes");
  page.begin_table({"node", "name", "reference", "product", "vendor", "device type", "vendor-ID",
                    "product code", "revision", "DCF", "note"});
  for (const ProjectNode& node : project.nodes()) {
    const eds::Identity identity = node.device == nullptr ? eds::Identity{} : eds::identity(*node.device);
    const bool is_good = node.device != nullptr;
    page.row({fmt::format("{}{}", node.id(), node.listed.present ? "" : " (not present)"), node.listed.name,
              node.listed.reference, is_good ? node.device->device.product_name : node.unreadable,
              is_good ? node.device->device.vendor_name : "", hexadecimal(identity.device_type),
              hexadecimal(identity.vendor_id), hexadecimal(identity.product_code),
              hexadecimal(identity.revision), node.path, project.notes().note(node.id())},
             is_good ? "" : "bad");
  }
  page.end_table();
}

void add_load(ReportPage& page, const network_project::NetworkLoad& load) {
  page.heading("Load");
  if (load.bit_rate == 0) return page.paragraph("No bit rate is known, so no load can be calculated.");
  page.paragraph(fmt::format(
      "{} kbit/s: {:.1f} % by timers and SYNC, {:.1f} % when all values change, each frame with the "
      "most stuff bits. SDO, EMCY and NMT come on top.",
      load.bit_rate / 1000, load.steady * 100, load.most * 100));
  page.begin_table({"node", "frame", "CAN-ID", "bytes", "a second, by timers", "a second, at most"});
  for (const network_project::CyclicFrame& frame : load.frames) {
    page.row({fmt::format("{}", frame.node_id), frame.what, network_project::describe_can_id(frame.cob_id),
              fmt::format("{}", frame.length), fmt::format("{:.1f}", frame.steady),
              frame.most ? fmt::format("{:.1f}", *frame.most) : "no limit"});
  }
  page.end_table();
}

std::string named_object(const ProjectNode& node, std::uint16_t index, std::uint8_t sub) {
  const canopen::Entry entry =
      node.device == nullptr ? canopen::Entry{} : node.device->dictionary->find(index, sub);
  return fmt::format("{} {}", eds::object_text(index, sub),
                     entry ? network_project::object_title(*node.device, entry) : "");
}

void add_process_data(ReportPage& page, const NetworkProject& project) {
  page.heading("Process data");
  page.begin_table({"from", "signal", "PDO", "CAN-ID", "bits", "to", "signal", "PDO"});
  const auto links = find_links(project);
  for (const network_project::SignalLink& link : links) {
    const ProjectNode& from = *project.find(link.from.node_id);
    const ProjectNode& to = *project.find(link.to.node_id);
    page.row({from.shown_name(), named_object(from, link.from.index, link.from.sub),
              fmt::format("TPDO{}", link.tpdo), network_project::describe_can_id(link.cob_id),
              fmt::format("{} to {}", link.first_bit, link.first_bit + link.bits - 1), to.shown_name(),
              named_object(to, link.to.index, link.to.sub), fmt::format("RPDO{}", link.rpdo)});
  }
  // PDOs without a counterpart in the project.
  for (const ProjectNode& node : project.nodes()) {
    for (const Pdo& pdo : node.pdos) {
      const bool is_linked = std::ranges::any_of(links, [&](const network_project::SignalLink& link) {
        return pdo.transmit ? link.from.node_id == node.id() && link.tpdo == pdo.number
                            : link.to.node_id == node.id() && link.rpdo == pdo.number;
      });
      if (!pdo.is_active() || is_linked) continue;
      const std::string mapping = network_project::describe_mapping(pdo);
      const std::string can_id = network_project::describe_can_id(pdo.cob_id);
      const std::string bits = fmt::format("0 to {}", pdo.bits() - 1);
      if (pdo.transmit) {
        page.row({node.shown_name(), mapping, pdo.name(), can_id, bits, "-", "", ""}, "note");
      } else {
        page.row({"-", "", "", can_id, bits, node.shown_name(), mapping, pdo.name()}, "note");
      }
    }
  }
  page.end_table();
}

void add_findings(ReportPage& page, const NetworkProject& project) {
  page.heading("Check");
  const auto findings = review_network(project);
  if (findings.empty()) return page.paragraph("Nothing was found.");
  page.begin_table({"kind", "where", "what"});
  for (const network_project::Finding& finding : findings) {
    const bool is_note = finding.severity == eds::Problem::Severity::note;
    page.row({std::string(eds::name(finding.severity)),
              finding.line == 0 ? finding.path : fmt::format("{}:{}", finding.path, finding.line),
              finding.message},
             is_note ? "note" : "bad");
  }
  page.end_table();
}

void add_found(ReportPage& page, const NetworkProject& project, const std::vector<FoundNode>& found) {
  page.heading("On the bus");
  page.begin_table(
      {"node", "name", "state", "device type", "vendor-ID", "product code", "revision", "serial number", ""});
  for (const ProjectNode& node : project.nodes()) {
    const bool is_there =
        std::ranges::any_of(found, [&](const FoundNode& one) { return one.node_id == node.id(); });
    if (!is_there && node.listed.present) {
      page.row({fmt::format("{}", node.id()), node.listed.name, "-", "", "", "", "", "",
                "is in the project, and does not answer"},
               "bad");
    }
  }
  for (const FoundNode& node : found) {
    const bool is_known = project.find(node.node_id) != nullptr;
    page.row({fmt::format("{}", node.node_id), node.name.value_or("-"),
              std::string(node.state ? canopen::name(*node.state) : "unknown"), hexadecimal(node.device_type),
              hexadecimal(node.vendor), hexadecimal(node.product), hexadecimal(node.revision),
              hexadecimal(node.serial), is_known ? "" : "is not in the project"},
             is_known ? "" : "bad");
  }
  page.end_table();
}

std::string shown_value(const std::vector<std::uint8_t>& bytes, canopen::DataType type) {
  if (bytes.empty()) return "-";
  const auto value = client::show_value(bytes, type);
  return value ? *value : client::show_bytes(bytes);
}

/// False: something differs, or a node did not answer.
bool add_differences(ReportPage& page, const NetworkProject& project, const std::vector<FoundNode>& found,
                     BusLoop& bus, can::Duration time_out) {
  page.heading("Project and devices");
  page.begin_table({"node", "object", "project", "device", ""});
  bool is_good = true;
  for (const ProjectNode& node : project.nodes()) {
    const bool is_there = std::ranges::any_of(
        found, [&](const FoundNode& one) { return one.node_id == node.id() && one.answers_sdo; });
    if (!node.listed.present) continue;
    if (!is_there || node.device == nullptr) {
      is_good = false;
      continue;
    }
    BusObjects objects(bus, node.id(), time_out);
    auto values = master::compare_identity(*node.device, objects);
    ObjectProgress progress(bus, node.shown_name());
    std::ranges::move(master::compare_configuration(*node.device, node.id(), objects, progress.function()),
                      std::back_inserter(values));
    std::size_t wrong = 0;
    for (const ComparedValue& value : values) {
      const bool is_unasked =
          std::ranges::all_of(value.wanted, [](std::uint8_t byte) { return byte == 0; }) &&
          value.object.index == 0x1000;
      if (value.state == ComparedValue::State::same || is_unasked) continue;
      ++wrong;
      page.row({node.shown_name(), named_object(node, value.object.index, value.object.sub),
                shown_value(value.wanted, value.type), shown_value(value.found, value.type), value.reason},
               "bad");
    }
    is_good = is_good && wrong == 0;
    if (wrong == 0)
      page.row(
          {node.shown_name(), "all of " + ascii::counted(values.size(), "value"), "the same", "the same", ""},
          "good");
  }
  page.end_table();
  return is_good;
}

}  // namespace

static int write_report(const ProjectArguments& arguments) {
  return with_network(arguments, [&](const ProjectFolder& folder, const NetworkProject& project) {
    const std::string& name = project.network().name;
    ReportPage page(name.empty() ? folder.shown_list() : name);
    page.paragraph(fmt::format("CANopen network of {}, {}", folder.shown_list(),
                               ascii::counted(project.nodes().size(), "node")));
    add_nodes(page, project);
    add_findings(page, project);
    add_process_data(page, project);
    add_load(page, reckon_load(project));
    int code = project_code::done;
    if (arguments.with_devices) {
      code = with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
        std::vector<FoundNode> found;
        if (const int scanned = scan_bus(bus, {}, time_out, found); scanned != exit_code::done)
          return scanned;
        add_found(page, project, found);
        bus.need({link::IdentifierFilter::function(canopen::cob_id::sdo_response)});
        return add_differences(page, project, found, bus, time_out) ? project_code::done
                                                                    : project_code::different;
      });
      if (code != project_code::done && code != project_code::different) return code;
    }
    if (const auto written = write_new_file(arguments.file, page.text()); !written) {
      return project_failed(project_code::file, written.error());
    }
    if (!arguments.bus.json) print_line("{}: written", arguments.file);
    return code;
  });
}

int report_network(const ProjectArguments& arguments) {
  return run_ignoring_sigpipe([&] { return write_report(arguments); });
}

}  // namespace canopus::cli
