#include <exception>
#include <string>
#include <vector>

#include "canopus/app/command_line.hpp"
#include "canopus/app/print.hpp"

int main(int argc, char** argv) {
  canopus::app::reserve_standard_descriptors();
  try {
    return canopus::app::run_command_line(std::vector<std::string>(argv + 1, argv + argc));
  } catch (const std::exception& error) {
    canopus::app::print_error("canopus: {}", error.what());
    return 1;
  }
}
