#pragma once
// canopus gateway: an ASCII gateway of CiA 309-3 over TCP in front of a bus.

namespace CLI {
class App;
}

namespace canopus::cli {

/// `version` is the program's, for `info version`.
void add_gateway_command(CLI::App& app, int& exit_code, const char* version);

}  // namespace canopus::cli
