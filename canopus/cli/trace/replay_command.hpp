#pragma once
// canopus replay FILE --bus ADDRESS: sends the frames of a trace, as canplayer does.

namespace canopus::cli {

class Command;

void add_replay_command(Command& app, int& exit_code);

}  // namespace canopus::cli
