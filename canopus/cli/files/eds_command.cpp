#include "canopus/cli/files/eds_command.hpp"

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/cli/files/eds_show.hpp"
#include "canopus/cli/files/given_file.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/device_names.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/client/domain_words.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/eds/files/losses.hpp"
#include "canopus/eds/files/xdd_writer.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

using Severity = eds::Problem::Severity;

/// The text, or nothing after an error on `err`.
std::optional<std::string> read_text(const std::string& file, Output& err) {
  if (const FileKind kind = kind_of_file(file);
      kind == FileKind::plant || kind == FileKind::network || kind == FileKind::project) {
    err.line("canopus: {}", describe_given_file(file, kind));
    return std::nullopt;
  }
  const auto text = file == "-" ? text::read_standard_input() : text::read_file_or_reason(file);
  if (text) return *text;
  err.line("canopus: {}: {}", file, text.error());
  return std::nullopt;
}

/// Reads a binary file up to the largest permitted size.
std::optional<std::string> read_bytes(const std::string& file, Output& err) {
  const auto bytes = text::read_file_or_pipe(file);
  if (bytes) return *bytes;
  err.line("canopus: {}", bytes.error());
  return std::nullopt;
}

struct Counts {
  std::size_t losses = 0;
  std::size_t warnings = 0;
  std::size_t notes = 0;
};

Counts count(const std::vector<eds::Problem>& problems) {
  Counts counts;
  for (const eds::Problem& problem : problems) {
    if (problem.severity == Severity::loss) ++counts.losses;
    if (problem.severity == Severity::warning) ++counts.warnings;
    if (problem.severity == Severity::note) ++counts.notes;
  }
  return counts;
}

void print_problem(Output& out, const std::string& file, const eds::Problem& problem, bool colour) {
  const std::string_view severity_colour = problem.severity <= Severity::loss      ? "1;31"
                                           : problem.severity == Severity::warning ? "1;35"
                                                                                   : "1;36";
  const std::string place = problem.column == 0
                                ? fmt::format("{}:{}:", file, problem.line)
                                : fmt::format("{}:{}:{}:", file, problem.line, problem.column);
  out.line("{} {} {}", paint(place, "1", colour),
           paint(fmt::format("{}:", eds::name(problem.severity)), severity_colour, colour), problem.message);
}

void print_text(Output& out, const std::string& file, const eds::ReadResult& result,
                const EdsCheckOptions& options) {
  for (const eds::Problem& problem : result.problems) {
    if (!options.quiet || problem.severity <= Severity::loss) {
      print_problem(out, file, problem, options.colour);
    }
  }
  if (result.file == nullptr) {
    out.line("{}: refused", file);
    return;
  }
  if (options.quiet && !result.has_losses()) return;
  const Counts counts = count(result.problems);
  const eds::PdoCount pdos = eds::count_pdos(*result.file->dictionary);
  Line line("{}: accepted", file);
  if (counts.losses != 0) line.add(" with losses, {}", ascii::counted(counts.losses, "loss"));
  line.add(", {}", ascii::counted(counts.warnings, "warning"));
  if (counts.notes != 0) line.add(", {}", ascii::counted(counts.notes, "note"));
  line.add(": {}, {}, {}", ascii::counted(result.file->dictionary->objects().size(), "object"),
           ascii::counted(pdos.rpdos, "RPDO"), ascii::counted(pdos.tpdos, "TPDO"));
  if (const auto type = identity(*result.file).device_type) line.add(", device type {:08X}H", *type);
  out.line(line);
}

void print_as_json(Output& out, const std::string& file, const eds::ReadResult& result) {
  text::Json line;
  line["file"] = file;
  line["accepted"] = result.file != nullptr;
  line["losses"] = count(result.problems).losses;
  if (result.file != nullptr) {
    const eds::PdoCount pdos = eds::count_pdos(*result.file->dictionary);
    const eds::Identity identity = eds::identity(*result.file);
    line["vendor"] = result.file->device.vendor_name;
    line["product"] = result.file->device.product_name;
    line["objects"] = result.file->dictionary->objects().size();
    line["rpdos"] = pdos.rpdos;
    line["tpdos"] = pdos.tpdos;
    if (identity.device_type) line["device_type"] = *identity.device_type;
    if (identity.vendor_id) line["vendor_id"] = *identity.vendor_id;
    if (identity.product_code) line["product_code"] = *identity.product_code;
    if (identity.revision) line["revision"] = *identity.revision;
  }
  line["problems"] = text::Json::array();
  for (const eds::Problem& problem : result.problems) {
    text::Json entry;
    entry["line"] = problem.line;
    if (problem.column != 0) entry["column"] = problem.column;
    entry["severity"] = eds::name(problem.severity);
    entry["message"] = problem.message;
    line["problems"].push_back(std::move(entry));
  }
  out.json(line);
}

}  // namespace

int eds_check(const EdsCheckOptions& options, Output& out, Output& err) {
  bool is_lossy = false;
  int exit_code = 0;
  for (const std::string& file : options.files) {
    const auto text = read_text(file, err);
    if (!text) {
      exit_code = 2;
      continue;
    }
    const eds::ReadResult result = eds::read_device_file(*text);
    const std::string shown = file == "-" ? "<stdin>" : file;
    if (options.json) {
      print_as_json(out, shown, result);
    } else {
      print_text(out, shown, result, options);
    }
    if (result.file == nullptr && exit_code == 0) exit_code = 1;
    is_lossy = is_lossy || result.has_losses();
  }
  return exit_code == 0 && is_lossy ? 3 : exit_code;
}

int eds_convert(const EdsConvertOptions& options, Output& out, Output& err) {
  const std::string extension = std::filesystem::path(options.to).extension().string();
  const std::string kind = ascii::lower(!options.kind.empty() ? options.kind
                                        : extension.empty()   ? extension
                                                              : extension.substr(1));
  const bool is_xdd = kind == "xdd" || kind == "xdc";
  if (!is_xdd && kind != "eds" && kind != "dcf") {
    err.line(
        "canopus: {}: what shall it be? expected a name that ends in .eds, .dcf, .xdd or .xdc, or "
        "--out-format",
        options.to == "-" ? "standard output" : options.to);
    return 2;
  }
  const auto text = read_text(options.from, err);
  if (!text) return 2;
  const std::string from = options.from == "-" ? "<stdin>" : options.from;
  const eds::ReadResult read = eds::read_device_file(*text);
  for (const eds::Problem& problem : read.problems) {
    if (problem.severity == Severity::note) continue;
    err.line("{}:{}: {}: {}", from, problem.line, eds::name(problem.severity), problem.message);
  }
  if (read.file == nullptr) return 1;
  if (const std::string problem = eds::too_much_to_write(*read.file); !problem.empty()) {
    err.line("{}: error: {}", from, problem);
    return 1;
  }
  const bool is_configured = kind == "dcf" || kind == "xdc";
  if (is_configured != read.file->commissioning.has_value()) {
    err.line("{}: warning: the file {}: what is written is {}", from,
             is_configured ? "is for no node" : "is for a node",
             is_configured ? (is_xdd ? "an XDD" : "an EDS") : (is_xdd ? "an XDC" : "a DCF"));
  }
  eds::WrittenFile written = is_xdd ? eds::write_xdd(*read.file) : eds::write_eds(*read.file);
  for (std::string& lost : eds::beyond_device_file(*text)) written.warnings.push_back(std::move(lost));
  for (const std::string& warning : written.warnings) err.line("{}: warning: {}", from, warning);
  if (options.to == "-") {
    out.content(written.text);
    return 0;
  }
  if (const auto done = write_new_file(options.to, written.text); !done) {
    err.line("canopus: {}", done.error());
    return 1;
  }
  return 0;
}

namespace {

void add_convert(Command& eds, int& exit_code) {
  Command* convert =
      eds.add_subcommand("convert", "Write an EDS or DCF as XDD or XDC, or the other way round");
  const auto options = std::make_shared<EdsConvertOptions>();
  convert->add_option("IN", options->from, "EDS, DCF, XDD or XDC file; - is the standard input")->required();
  convert->add_option("OUT", options->to, "File to write, by its extension; - is the standard output")
      ->required();
  convert->add_option("--out-format", options->kind, "Format of OUT (default: from its extension)")
      ->type_name("FORMAT")
      ->check(one_of_words({"eds", "dcf", "xdd", "xdc"}));
  convert->add_old_spelling({.old = "--to", .now = "--out-format"});
  convert->footer(
      "Objects, values, limits, access and names are kept. What the other format has no place for, and what\n"
      "the reader repaired, is a warning on the standard error. A file that is there is replaced, whole or\n"
      "not at all.\n"
      "\n"
      "Exit status: 0 written, 1 no device can be made of the file, or it cannot be written, 2 wrong usage "
      "or\n"
      "a file that cannot be read.\n"
      "\n"
      "Example: canopus eds convert pump.eds pump.xdd");
  convert->callback([options, &exit_code] {
    const auto convert_file = [&] { return eds_convert(*options, standard_output(), standard_error()); };
    exit_code = options->to == "-" ? convert_file() : run_ignoring_sigpipe(convert_file);
  });
}

struct EdsConciseOptions {
  std::string file;
  std::string device;
  bool json = false;
};

int eds_concise(const EdsConciseOptions& options, Output& out, Output& err) {
  const auto text = options.file == "-" ? read_text(options.file, err) : read_bytes(options.file, err);
  if (!text) return 2;
  std::shared_ptr<const eds::DeviceFile> device;
  if (!options.device.empty()) {
    auto file = device_file_of_names(options.device);
    if (!file) {
      err.line("canopus: --eds: {}", file.error());
      return 2;
    }
    device = std::move(*file);
  }
  const std::vector<std::uint8_t> bytes(text->begin(), text->end());
  const client::DomainWords words =
      client::domain_words(client::concise_dcf_object, bytes, device ? device->dictionary.get() : nullptr);
  if (options.json) {
    out.json(client::json_of(words));
  } else {
    for (const std::string& line : client::lines_of(words)) out.line("{}", line);
  }
  return words.problem.empty() ? 0 : 1;
}

void add_concise(Command& eds, int& exit_code) {
  Command* concise = eds.add_subcommand("concise", "Show a concise DCF, as 1F22H has it, in words");
  const auto options = std::make_shared<EdsConciseOptions>();
  concise->add_option("FILE", options->file, "the concise DCF; - is the standard input")->required();
  concise->add_option("--eds", options->device, "device file of the node that it is for: names and types")
      ->type_name("FILE");
  concise->add_flag("--json", options->json, "Print one JSON object instead");
  concise->footer(
      "Without --eds objects have the names of CiA 301 and CiA 302. From where the file does not fit on its "
      "bytes\n"
      "are shown.\n"
      "\n"
      "Exit status: 0 shown, 1 it is damaged, 2 wrong usage or a file that cannot be read.\n"
      "\n"
      "Example: canopus eds concise node5.cdcf --eds pump.eds");
  concise->callback(
      [options, &exit_code] { exit_code = eds_concise(*options, standard_output(), standard_error()); });
}

void build_eds_command(Command& eds, int& exit_code) {
  eds.require_subcommand(1);
  add_convert(eds, exit_code);
  add_concise(eds, exit_code);
  Command* check = eds.add_subcommand("check", "List the mistakes of device files, the worst first");
  const auto options = std::make_shared<EdsCheckOptions>();
  check->add_option("FILE", options->files, "EDS, DCF, XDD or XDC files; - is the standard input")
      ->required();
  check->add_flag("-q,--quiet", options->quiet,
                  "Print files that are refused or accepted with losses only, and why");
  check->add_flag("--json", options->json, "Print one JSON object per file instead");
  check->footer(
      "Each problem is a line FILE:LINE: SEVERITY: MESSAGE. A loss is something that matters for\n"
      "communication and was left out or replaced: an object, value, type, limit or mapping. A warning is\n"
      "something the reader repaired, a note something unusual. Only an error keeps a file from being used.\n"
      "\n"
      "Exit status: 0 all files accepted, 1 a file refused, 2 wrong usage or a file that cannot be read,\n"
      "3 none of these, but a file accepted with losses.\n"
      "Colour goes to terminals only; NO_COLOR switches it off.\n"
      "\n"
      "Example: canopus eds check devices/*.eds");
  struct ShowOptions {
    std::string file;
    bool json = false;
  };
  const auto shown = std::make_shared<ShowOptions>();
  Command* show =
      eds.add_subcommand("show", "List a device's identity, objects, and PDOs with their mapping");
  show->add_option("FILE", shown->file, "EDS, DCF, XDD or XDC file; - is the standard input")->required();
  show->add_flag("--json", shown->json, "Print one JSON object instead");
  show->footer(
      "PDO: in which the object may be mapped. +node: the node-ID is added. Longer names are cut at 80 "
      "columns.\n"
      "\n"
      "Exit status: 0 shown, 1 no device can be made of the file, 2 wrong usage or a file that cannot be "
      "read.\n"
      "\n"
      "Example: canopus eds show examples/devices/io-block.eds");
  show->callback([shown, &exit_code] {
    exit_code = eds_show(shown->file, shown->json, standard_output(), standard_error());
  });
  check->callback([options, &exit_code] {
    options->colour = !options->json && wants_colour(STDOUT_FILENO);
    exit_code = eds_check(*options, standard_output(), standard_error());
  });
}

}  // namespace

void add_eds_command(Command& app, int& exit_code) {
  app.add_subcommand("eds", "Check, show and convert device files (EDS, DCF, XDD, XDC)",
                     [&exit_code](Command& eds) { build_eds_command(eds, exit_code); });
}

}  // namespace canopus::cli
