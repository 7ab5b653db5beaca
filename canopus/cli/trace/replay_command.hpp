#pragma once
// canopus replay FILE --bus ADDRESS: sends the frames of a trace, as canplayer does.

namespace CLI {
class App;
}

namespace canopus::cli {

void add_replay_command(CLI::App& app, int& exit_code);

}  // namespace canopus::cli
