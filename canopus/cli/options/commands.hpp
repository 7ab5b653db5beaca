#pragma once
// Commands of the program, each in a source of its name: command_line.cpp adds them. When the user enters one, parsing runs it and puts
// the exit code into `exit_code`.

#include <string_view>

namespace canopus::cli {

class Command;

/// `canopus run PLANT.toml`.
void add_run_command(Command& app, int& exit_code);
/// `canopus web PROJECT`: the page in the browser for a CiA 306 project and its bus.
void add_web_command(Command& app, int& exit_code);
/// `canopus plc ...`: reads and writes a PLC over the MELSEC communication protocol or Modbus TCP, our own or a real one. Exit codes: 0
/// done, 1 the PLC refused or could not be reached, 2 the command line makes no sense.
void add_plc_command(Command& app, int& exit_code);
/// `canopus device`: reads and forces values of the simulated devices of a running plant.
void add_device_command(Command& app, int& exit_code);
/// `canopus sdo read|write`: objects of a node on a bus.
void add_sdo_command(Command& app, int& exit_code);
/// `canopus nmt start|stop|preop|reset|reset-comm NODE|all`: NMT commands on a bus.
void add_nmt_command(Command& app, int& exit_code);
/// `canopus gateway`: an ASCII gateway of CiA 309-3 over TCP in front of a bus. `version` is the program's, for `info version`.
void add_gateway_command(Command& app, int& exit_code, const char* version);
/// `canopus lss ...`: finding devices, their node-IDs and bit rates, by LSS [CiA 305].
void add_lss_command(Command& app, int& exit_code);
/// `canopus master network.toml`: boots a network without a PLC.
void add_master_command(Command& app, int& exit_code);
/// `canopus trace ...`: these go into the command `trace`.
void add_trace_info(Command& trace, int& exit_code);
void add_trace_convert(Command& trace, int& exit_code);
void add_trace_diff(Command& trace, int& exit_code);
void add_trace_show(Command& trace, int& exit_code);
void add_trace_stats(Command& trace, int& exit_code);
void add_trace_plot(Command& trace, int& exit_code);
void add_trace_export(Command& trace, int& exit_code);
/// `canopus monitor`: the frames of a bus, decoded.
void add_monitor_command(Command& app, int& exit_code);
/// `canopus replay FILE --bus ADDRESS`: sends the frames of a trace, as canplayer does.
void add_replay_command(Command& app, int& exit_code);
/// `canopus schema plant|network`: JSON Schemas of files.
void add_schema_command(Command& app, int& exit_code);
/// `canopus bench jitter`: how punctual a plant is on this machine.
void add_bench_command(Command& app, int& exit_code);
/// `canopus completion` and `canopus reference`: completions, manual pages and a reference of the other commands, for shells, packages
/// and documentation. Add them last: they describe `app` as it is when they run.
void add_reference_commands(Command& app, int& exit_code, std::string_view version);

}  // namespace canopus::cli
