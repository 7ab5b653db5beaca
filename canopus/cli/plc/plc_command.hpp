#pragma once
// `canopus plc ...`: reads and writes a PLC over the MELSEC communication protocol or Modbus TCP, our own or a real one.

namespace canopus::cli {

class Command;

/// Adds the subcommand `plc` with read, write, set, reset, watch, run, stop and type. When the user asks for
/// one, parsing runs it and puts the exit code into `exit_code`: 0 done, 1 the PLC refused or could not be
/// reached, 2 the command line makes no sense. Results go to standard output, errors to standard error.
void add_plc_command(Command& app, int& exit_code);

}  // namespace canopus::cli
