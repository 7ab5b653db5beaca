#include <exception>
#include <string>
#include <vector>

#include "canopus/cli/app/command_line.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/web/commands/child_process.hpp"

int main(int argc, char** argv) {
  canopus::web::end_with_parent();
  canopus::cli::reserve_standard_descriptors();
  try {
    return canopus::cli::run_command_line(std::vector<std::string>(argv + 1, argv + argc));
  } catch (const std::exception& error) {
    canopus::cli::print_error("canopus: {}", error.what());
    return 1;
  }
}
