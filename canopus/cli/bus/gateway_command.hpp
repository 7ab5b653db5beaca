#pragma once
// canopus gateway: an ASCII gateway of CiA 309-3 over TCP in front of a bus.

namespace canopus::cli {

class Command;

/// `version` is the program's, for `info version`.
void add_gateway_command(Command& app, int& exit_code, const char* version);

}  // namespace canopus::cli
