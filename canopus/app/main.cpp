#include <exception>
#include <sstream>
#include <string>

#include <CLI/CLI.hpp>

#include "canopus/app/check_command.hpp"
#include "canopus/app/eds_command.hpp"
#include "canopus/app/lss_command.hpp"
#include "canopus/app/master_command.hpp"
#include "canopus/app/module_command.hpp"
#include "canopus/app/nmt_command.hpp"
#include "canopus/app/plc_command.hpp"
#include "canopus/app/print.hpp"
#include "canopus/app/run_command.hpp"
#include "canopus/app/scan_command.hpp"
#include "canopus/app/sdo_command.hpp"
#include "canopus/app/version.hpp"

namespace {

/// Help, the version, or what is wrong with the command line.
int explain(const CLI::App& app, const CLI::ParseError& reason) {
  std::ostringstream help, complaint;
  const int code = app.exit(reason, help, complaint);
  const auto print = [](canopus::app::Output& out, const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) out.line("{}", line);
  };
  print(canopus::app::standard_output(), help.str());
  print(canopus::app::standard_error(), complaint.str());
  return code == 0 ? 0 : 2;
}

int run(int argc, char** argv) {
  CLI::App app{"Canopus: CANopen communication modules of PLCs, and whole CANopen plants, as software",
               "canopus"};
  app.set_version_flag("-V,--version", std::string("canopus ") + canopus::app::version());
  app.require_subcommand(1);
  app.footer("`canopus COMMAND --help` tells more about a command.");
  int exit_code = 0;
  canopus::app::add_run_command(app, exit_code);
  canopus::app::add_check_command(app, exit_code);
  canopus::app::add_plc_command(app, exit_code);
  canopus::app::add_eds_command(app, exit_code);
  canopus::app::add_module_command(app, exit_code);
  canopus::app::add_scan_command(app, exit_code);
  canopus::app::add_sdo_command(app, exit_code);
  canopus::app::add_nmt_command(app, exit_code);
  canopus::app::add_lss_command(app, exit_code);
  canopus::app::add_master_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return explain(app, error);
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    canopus::app::print_error("canopus: {}", error.what());
    return 1;
  }
}
