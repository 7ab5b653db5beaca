#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "canopus/app/eds_command.hpp"
#include "canopus/app/lss_command.hpp"
#include "canopus/app/master_command.hpp"
#include "canopus/app/module_command.hpp"
#include "canopus/app/nmt_command.hpp"
#include "canopus/app/plc_command.hpp"
#include "canopus/app/run_command.hpp"
#include "canopus/app/scan_command.hpp"
#include "canopus/app/sdo_command.hpp"
#include "canopus/app/version.hpp"

int main(int argc, char** argv) {
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
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "canopus: %s\n", error.what());
    return 1;
  }
  return exit_code;
}
