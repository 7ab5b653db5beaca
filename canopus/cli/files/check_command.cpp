#include "canopus/cli/files/check_command.hpp"

#include <memory>

#include <fmt/ranges.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/cli/files/eds_command.hpp"
#include "canopus/cli/files/given_file.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/sim/lift/units.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::cli {

namespace {

/// "lift 1+2 on hoist: 8 floors, 40 passengers", and its devices.
void print_lift(const plant::LiftSection& lift, Output& out) {
  out.line("lift {} on {}: {}, {}", fmt::format("{}", fmt::join(lift.building.lifts, "+")), lift.bus,
           ascii::counted(lift.building.floors.size(), "floor"),
           ascii::counted(lift.building.passengers.count, "passenger"));
  const auto units = sim::lift::units_of(lift.building.lifts, lift.building.floor_doors);
  for (std::size_t i = 0; i < units.size(); ++i) {
    out.line("  node {}: {}", lift.first_node + i, sim::lift::name(units[i]));
  }
}

}  // namespace

int check_plant(const CheckOptions& options, Output& out, Output& err) {
  class Nobody final : public plant::PlantObserver {
  } no_observer;
  const std::string& path = options.plant;
  const auto plant =
      plant::load_plant(path, no_observer, err, {.allows_native_code = options.allows_native_code});
  if (!plant) return 2;
  for (const text::FileWarning& warning : plant->warnings()) err.line("{}", describe(warning, path));
  for (const std::string& line : plant->connections()) out.line("{}", line);
  const plant::PlantFile& file = plant->file();
  for (const plant::LiftSection& lift : file.lifts) print_lift(lift, out);
  const std::size_t warnings = plant->warnings().size();
  const bool good = warnings == 0 || !options.strict;
  out.line("{}: {}: {}, {}, {}{}", path, good ? "good" : "not good", ascii::counted(file.buses.size(), "bus"),
           ascii::counted(file.devices.size(), "device"), ascii::counted(file.plcs.size(), "PLC"),
           warnings == 0 ? "" : ", " + ascii::counted(warnings, "warning"));
  return good ? 0 : 2;
}

namespace {

/// The file that was named, whatever it is.
int check_file(const CheckOptions& options, Output& out, Output& err) {
  if (kind_of_file(options.plant) == FileKind::device_file)
    return eds_check({.files = {options.plant}}, out, err);
  const GivenPlant plant = given_plant(options.plant);
  if (plant.wrong.empty()) {
    CheckOptions of_plant = options;
    of_plant.plant = plant.path;
    return check_plant(of_plant, out, err);
  }
  err.line("canopus check: {}", plant.wrong);
  return 2;
}

void build_check_command(Command& command, int& exit_code) {
  auto options = std::make_shared<CheckOptions>();
  command
      .add_option("PLANT", options->plant,
                  "Plant file (TOML, see docs/plant-file.md), or a folder with plant.toml; a device file is "
                  "checked as by `canopus eds check`")
      ->required();
  command.add_flag("--strict", options->strict, "Treat warnings as mistakes");
  command.add_flag("--allow-native", options->allows_native_code,
                   "Load programs of PLCs that are shared objects: their code runs, with all your rights");
  command.footer(
      "A mistake is printed as FILE:LINE:COLUMN: what was found and what was expected; the plant does not\n"
      "start with one. A warning, FILE:LINE:COLUMN: warning: ..., is something that was probably not meant;\n"
      "a run says it, too.\n"
      "Exit codes: 0 good, 2 wrong (with --strict: or a warning).");
  command.callback(
      [options, &exit_code] { exit_code = check_file(*options, standard_output(), standard_error()); });
}

}  // namespace

void add_check_command(Command& app, int& exit_code) {
  app.add_subcommand("check", "Check a plant file, and the device files it names, without running it",
                     [&exit_code](Command& command) { build_check_command(command, exit_code); });
}

}  // namespace canopus::cli
