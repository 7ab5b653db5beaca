#pragma once
// The servers of a run: MC protocol and Modbus TCP of each PLC, socketcand of each bus, control of the plant.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "canopus/link/loop_clock.hpp"
#include "canopus/link/peer.hpp"
#include "canopus/link/socketcand_beacon.hpp"
#include "canopus/link/socketcand_server.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/serve/client_ports.hpp"
#include "canopus/serve/control_server.hpp"
#include "canopus/serve/melsec_server.hpp"
#include "canopus/serve/modbus_server.hpp"
#include "canopus/serve/plant_runs.hpp"
#include "canopus/serve/real_time.hpp"
#include "canopus/serve/run_control.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/web/web_page.hpp"

namespace canopus::cli {

class PlantServers {
 public:
  struct Use {
    /// A server listens: protocol, what it belongs to, its address.
    std::function<void(std::string_view protocol, std::string_view of, const std::string& address)> opened{};
    /// Creates the report function for the clients of a source.
    std::function<link::ClientReport(std::string source)> report{};
    bool free_ports = false;  ///< each on a free port instead of the plant file's
    bool control = false;     ///< control also without the plant file's key, on a free port of this machine
    /// The page in the browser: where, and what it shows. Without events there is none.
    text::HostAndPort web{};
    web::WebEvents* web_events = nullptr;
    std::optional<web::WebProject> web_project{};
    /// Module settings that the page edits; those without a PLC get the plant's that has such a module.
    std::vector<web::WebSettings> web_settings{};
    web::WebAccess web_access{};
    std::string web_traces{};  ///< folder of recorded traces that the page may open
    web::WebPace web_pace{};
    serve::PlantRuns::Order order = serve::PlantRuns::Order::side_by_side;
  };

  /// All must outlive the servers; `clock` is that of the plant's timeline.
  PlantServers(boost::asio::io_context& io, plant::Plant& plant, link::LoopClock& clock, Use use);
  ~PlantServers();
  PlantServers(const PlantServers&) = delete;
  PlantServers& operator=(const PlantServers&) = delete;

  /// False after an error, which is printed.
  [[nodiscard]] bool open();
  /// The runs that clients of the control server wait for.
  [[nodiscard]] serve::PlantRuns& runs() noexcept { return runs_; }
  /// Plant time is stopped: requests to racks with a scan of their own are answered at once. Or it runs, and
  /// they wait for the END of the scan.
  void set_standing_still(bool standing_still);
  /// Messages that wait for the slowest client of a bus.
  [[nodiscard]] std::size_t waiting_messages() const noexcept;
  /// Answers pending requests, and closes.
  void close();

 private:
  /// A port of a PLC as commands reach it.
  struct MelsecWay {
    const plant::MelsecPortSection* section = nullptr;
    std::uint16_t port = 0;
  };

  bool open_melsec(std::size_t plc);
  bool open_modbus(std::size_t plc);
  bool open_control();
  bool open_socketcand(std::size_t bus);
  [[nodiscard]] std::string address_for_commands(std::size_t bus) const;
  [[nodiscard]] std::vector<std::string> way_to_plc(const web::WebSettings& settings) const;
  [[nodiscard]] std::vector<web::WebSettings> settings_for_page() const;
  bool open_web();
  bool opened(const std::expected<void, std::string>& result, std::string_view protocol, std::string_view of,
              const text::HostAndPort& place, std::uint16_t port);
  [[nodiscard]] text::HostAndPort place_of(text::HostAndPort place) const;

  boost::asio::io_context& io_;
  plant::Plant& plant_;
  link::LoopClock& clock_;
  Use use_;
  serve::PlantRuns runs_;
  serve::RunControl run_control_;
  std::vector<std::unique_ptr<serve::ClientPorts>> client_ports_;  // outlive the servers
  std::vector<std::unique_ptr<link::SocketcandServer>> socketcand_;
  std::vector<std::unique_ptr<link::SocketcandBeacon>> beacons_;
  std::map<std::size_t, text::HostAndPort> socketcand_places_;  // by bus
  std::vector<std::unique_ptr<serve::MelsecServer>> melsec_;
  std::map<std::size_t, MelsecWay> melsec_ways_;  // by PLC
  std::vector<std::unique_ptr<serve::ModbusServer>> modbus_;
  std::optional<serve::ControlServer> control_;
  std::optional<web::WebPage> web_;
};

/// Sets the clocks of all CPUs to the machine's local time, like a programming tool.
void set_cpu_clocks(plant::Plant& plant);
/// For a plant without a bus outside. `clock` must outlive it.
[[nodiscard]] web::WebPace pace_of(serve::RealTime& clock);

}  // namespace canopus::cli
