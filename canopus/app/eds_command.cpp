#include "canopus/app/eds_command.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <system_error>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "canopus/eds/device_file.hpp"

namespace canopus::app {
namespace {

using Severity = eds::Problem::Severity;

/// The text, or nothing after a word on `err`. More than any device file has is not read: /dev/zero ends too.
std::optional<std::string> read_text(const std::string& file, std::ostream& err) {
  constexpr std::size_t enough = std::size_t{8} << 20;
  std::error_code no_folder;
  std::ifstream opened;
  const bool is_folder = std::filesystem::is_directory(file, no_folder);
  errno = 0;
  if (file != "-" && !is_folder) opened.open(file, std::ios::binary);
  if (is_folder || (file != "-" && !opened)) {
    const int reason = is_folder ? EISDIR : errno != 0 ? errno : EIO;
    err << "canopus: " << file << ": " << std::strerror(reason) << '\n';
    return std::nullopt;
  }
  std::istream& stream = file == "-" ? std::cin : opened;
  std::string text;
  std::array<char, 16384> piece{};
  while (text.size() < enough && (stream.read(piece.data(), piece.size()) || stream.gcount() != 0)) {
    text.append(piece.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) {
    err << "canopus: " << file << ": " << std::strerror(errno != 0 ? errno : EIO) << '\n';
    return std::nullopt;
  }
  return text;
}

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

struct Counts {
  std::size_t warnings = 0;
  std::size_t notes = 0;
};

Counts count(const std::vector<eds::Problem>& problems) {
  Counts counts;
  for (const eds::Problem& problem : problems) {
    if (problem.severity == Severity::warning) ++counts.warnings;
    if (problem.severity == Severity::note) ++counts.notes;
  }
  return counts;
}

void print_problem(std::ostream& out, const std::string& file, const eds::Problem& problem, bool colour) {
  const auto paint = [&](const char* code) { return colour ? code : ""; };
  const char* severity_colour = problem.severity == Severity::error     ? "\x1b[1;31m"
                                : problem.severity == Severity::warning ? "\x1b[1;35m"
                                                                        : "\x1b[1;36m";
  out << paint("\x1b[1m") << file << ':' << problem.line << ':';
  if (problem.column != 0) out << problem.column << ':';
  out << paint("\x1b[0m") << ' ' << paint(severity_colour) << eds::name(problem.severity) << ':'
      << paint("\x1b[0m") << ' ' << problem.message << '\n';
}

void print_text(std::ostream& out, const std::string& file, const eds::ReadResult& result,
                const EdsCheckOptions& options) {
  for (const eds::Problem& problem : result.problems) {
    if (!options.quiet || problem.severity == Severity::error) {
      print_problem(out, file, problem, options.colour);
    }
  }
  if (result.file == nullptr) {
    out << file << ": refused\n";
    return;
  }
  if (options.quiet) return;
  const Counts counts = count(result.problems);
  const eds::PdoCount pdos = eds::count_pdos(*result.file->dictionary);
  out << file << ": accepted, " << counted(counts.warnings, "warning");
  if (counts.notes != 0) out << ", " << counted(counts.notes, "note");
  out << ": " << counted(result.file->dictionary->objects().size(), "object") << ", "
      << counted(pdos.rpdos, "RPDO") << ", " << counted(pdos.tpdos, "TPDO");
  if (const auto type = identity(*result.file).device_type) {
    char text[16];
    std::snprintf(text, sizeof text, "%08XH", static_cast<unsigned>(*type));
    out << ", device type " << text;
  }
  out << '\n';
}

void print_json(std::ostream& out, const std::string& file, const eds::ReadResult& result) {
  nlohmann::ordered_json line;
  line["file"] = file;
  line["accepted"] = result.file != nullptr;
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
  line["problems"] = nlohmann::ordered_json::array();
  for (const eds::Problem& problem : result.problems) {
    nlohmann::ordered_json entry;
    entry["line"] = problem.line;
    if (problem.column != 0) entry["column"] = problem.column;
    entry["severity"] = eds::name(problem.severity);
    entry["message"] = problem.message;
    line["problems"].push_back(std::move(entry));
  }
  out << line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

bool wants_colour() {
  const char* refused = std::getenv("NO_COLOR");  // no-color.org: set and not empty
  const char* terminal = std::getenv("TERM");
  return (refused == nullptr || *refused == '\0') && isatty(STDOUT_FILENO) != 0 && terminal != nullptr &&
         std::string_view(terminal) != "dumb";
}

}  // namespace

int eds_check(const EdsCheckOptions& options, std::ostream& out, std::ostream& err) {
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
      print_json(out, shown, result);
    } else {
      print_text(out, shown, result, options);
    }
    if (result.file == nullptr && exit_code == 0) exit_code = 1;
  }
  return exit_code;
}

void add_eds_command(CLI::App& app, int& exit_code) {
  CLI::App* eds = app.add_subcommand("eds", "Look into device description files (EDS, DCF)");
  eds->require_subcommand(1);
  CLI::App* check = eds->add_subcommand("check", "Say what is wrong with EDS and DCF files, worst first");
  const auto options = std::make_shared<EdsCheckOptions>();
  check->add_option("FILE", options->files, "EDS or DCF files; - is the standard input")->required();
  check->add_flag("-q,--quiet", options->quiet, "Print refused files only, with their errors");
  check->add_flag("--json", options->json, "Print one JSON object per file instead");
  check->footer(
      "Each problem is a line FILE:LINE: SEVERITY: MESSAGE. A warning is something the reader repaired,\n"
      "a note something unusual; neither keeps a file from being used.\n"
      "\n"
      "Exit status: 0 all files accepted, 1 a file refused, 2 wrong usage or a file that cannot be read.\n"
      "Colour goes to terminals only; NO_COLOR switches it off.\n"
      "\n"
      "Example: canopus eds check devices/*.eds");
  check->callback([options, &exit_code] {
    options->colour = !options->json && wants_colour();
    exit_code = eds_check(*options, std::cout, std::cerr);
  });
}

}  // namespace canopus::app
