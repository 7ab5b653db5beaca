#pragma once
// Runs a plant: in real time, in step with the machine's clock, with its servers (MC protocol, socketcand)
// open; or in virtual time, as fast as it goes, without servers or driven in step by a client. Ends after a
// duration, or on request.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/serve/real_time_thread.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/web/web_page.hpp"

namespace canopus::cli {

struct RunOptions {
  std::string plant;                        ///< path of the plant file
  std::optional<std::string> plant_text{};  ///< in place of that file's
  std::optional<serve::RealTimeThread> real_time{};
  std::vector<std::string> links{};         ///< in place of the plant file's: "line1=socketcan:can0"
  std::optional<can::Duration> duration{};  ///< plant time; without it until SIGINT or SIGTERM
  bool virtual_time = false;
  bool step = false;        ///< in virtual time: with servers, and time moves only on a client's request
  bool free_ports = false;  ///< every server takes a free port instead of the plant file's
  std::optional<text::HostAndPort>
      web{};                    ///< the page in the browser; port 0: a free one. In real time alone
  web::WebAccess web_access{};  ///< access rights to the page
  std::vector<web::WebSettings> web_settings{};  ///< module settings that the page edits
  std::optional<web::WebProject> web_project{};  ///< what the page edits, in place of projects of the plant
  std::optional<std::uint64_t> seed{};
  bool allows_native_code = false;  ///< programs of PLCs that are shared objects
  /// In virtual time: the maximum number of threads. 0: the number of the machine's processors. The output
  /// does not depend on it.
  std::size_t threads = 0;
  std::string trace{};  ///< file for all frames: candump log, or pcap if it ends so; empty = none
  std::string
      vcd{};  ///< file for the wire as a waveform, with several buses one each (-BUS.vcd); empty = none
  std::string svg{};                ///< file for a picture of the lifts; empty = none
  bool expect_operational = false;  ///< exit code 3 when not all nodes are Operational at the end
  /// With it: by when they have to be; the run ends as soon as they are, unless it has a duration.
  std::optional<can::Duration> operational_within{};
  bool quiet = false;  ///< errors alone
  bool json = false;   ///< one JSON object per line
};

/// Runs to the end. Exit code: 0 ended as asked (Ctrl-C included), 1 the plant could not be started, an
/// output file failed or a part of the plant stalled, 2 the plant file is wrong, 3 the nodes are not Operational
/// as expected.
int run_plant(const RunOptions& options);

}  // namespace canopus::cli
