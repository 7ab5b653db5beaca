#pragma once
// The settings of a module that the page shows and changes: a project of `canopus configure`.

#include <cstdint>
#include <string>
#include <vector>

namespace canopus::web {

struct WebSettings {
  std::string file{};
  std::string model{};     ///< "RJ71CN91"
  std::uint32_t head = 0;  ///< head I/O number of the module, when the file was read
  std::string setup{};     ///< the transfer setup that they are of; empty: none
  std::vector<std::string>
      plc{};  ///< options that lead to its PLC: "--plc=127.0.0.1:5007"; empty: there is none
  std::vector<std::string> device_files{};  ///< of its nodes: files, and folders with them
  bool is_live = false;                     ///< of a real PLC or bus: commands that write want to be armed
};

}  // namespace canopus::web
