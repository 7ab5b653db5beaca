#include "canopus/cli/run/plant_servers.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <utility>

#include <boost/asio/ip/address.hpp>
#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/plc_arguments.hpp"
#include "canopus/text/local_time.hpp"
#include "canopus/text/version.hpp"

namespace canopus::cli {

namespace asio = boost::asio;

namespace {

/// The project of a bus as this process finds it; empty: it has none.
std::string project_of(const plant::PlantFile& file, const plant::BusSection& bus) {
  if (bus.project.empty()) return {};
  return (std::filesystem::path(file.path).parent_path() / bus.project).string();
}

}  // namespace

PlantServers::PlantServers(asio::io_context& io, plant::Plant& plant, link::LoopClock& clock, Use use)
    : io_(io),
      plant_(plant),
      clock_(clock),
      use_(std::move(use)),
      runs_(plant, use_.order, [this] { asio::post(io_, [this] { runs_.report(); }); }),
      run_control_(plant, runs_) {}

PlantServers::~PlantServers() { close(); }

bool PlantServers::open() {
  for (std::size_t i = 0; i < plant_.plc_count(); ++i) {
    if (!open_melsec(i) || !open_modbus(i)) return false;
  }
  if (!open_control()) return false;
  for (std::size_t i = 0; i < plant_.bus_count(); ++i) {
    if (!open_socketcand(i)) return false;
  }
  return open_web();
}

void PlantServers::close() {
  runs_.end_all();
  runs_.report();
  beacons_.clear();
  for (const auto& server : socketcand_) server->close();
  for (const auto& server : melsec_) server->stop();
  for (const auto& server : modbus_) server->stop();
  if (control_) control_->stop();
  if (web_) web_->close();
}

void PlantServers::set_standing_still(bool standing_still) {
  for (std::size_t i = 0; i < plant_.plc_count(); ++i) {
    plant_.rack(i).end_processing().stay_open(standing_still, plant_.timeline().now());
  }
}

std::size_t PlantServers::waiting_messages() const noexcept {
  std::size_t most = 0;
  for (const auto& server : socketcand_) most = std::max(most, server->waiting_messages());
  return most;
}

text::HostAndPort PlantServers::place_of(text::HostAndPort place) const {
  if (use_.free_ports) place.port = 0;
  return place;
}

bool PlantServers::opened(const std::expected<void, std::string>& result, std::string_view protocol,
                          std::string_view of, const text::HostAndPort& place, std::uint16_t port) {
  if (result) {
    use_.opened(protocol, of,
                place.host.find(':') == std::string::npos ? fmt::format("{}:{}", place.host, port)
                                                          : fmt::format("[{}]:{}", place.host, port));
  } else {
    print_error("canopus: {}: {}", protocol, result.error());
  }
  return result.has_value();
}

bool PlantServers::open_melsec(std::size_t plc) {
  const plant::PlcSection& section = plant_.plc_section(plc);
  for (const plant::MelsecPortSection& port : section.ports) {
    const text::HostAndPort place = place_of(port.listen);
    serve::MelsecServer& server = *melsec_.emplace_back(std::make_unique<serve::MelsecServer>(
        io_, plant_.rack(plc), clock_, serve::MelsecServerOptions{.allowed = port.allowed},
        use_.report(fmt::format("MC protocol {}", section.name)),
        serve::MelsecPort{.udp = port.udp, .settings = port.settings, .writers = port.writers}));
    const auto result = server.listen(place.host, place.port);
    if (!opened(result, protocol_name(port), section.name, place, server.port())) return false;
    // The first one without a remote password, which commands do not have; else the first one.
    MelsecWay& way = melsec_ways_[plc];
    const auto is_open = [](const plant::MelsecPortSection* one) {
      return one != nullptr && one->settings.remote_password.empty();
    };
    if (way.section == nullptr || (!is_open(way.section) && is_open(&port)))
      way = {.section = &port, .port = server.port()};
  }
  return true;
}

bool PlantServers::open_modbus(std::size_t plc) {
  const plant::PlcSection& section = plant_.plc_section(plc);
  for (const plant::ModbusPortSection& port : section.modbus_ports) {
    const text::HostAndPort place = place_of(port.listen);
    serve::ModbusPort settings{.settings = port.settings, .writers = port.writers};
    const std::string model(plant_.rack(plc).model().name);
    settings.settings.identification.objects = {
        "Canopus", model, text::program_version(), "", "Canopus", model, section.name};
    const std::string_view protocol =
        port.settings.framing == plc::modbus::Framing::rtu ? "Modbus RTU" : "Modbus TCP";
    serve::ModbusServer& server = *modbus_.emplace_back(std::make_unique<serve::ModbusServer>(
        io_, plant_.rack(plc), clock_, std::move(settings), serve::TcpServerOptions{.allowed = port.allowed},
        use_.report(fmt::format("{} {}", protocol, section.name))));
    const auto result = server.listen(place.host, place.port);
    if (!opened(result, protocol, section.name, place, server.port())) return false;
  }
  return true;
}

bool PlantServers::open_control() {
  const plant::PlantFile& file = plant_.file();
  if (!file.control && !use_.control) return true;
  const text::HostAndPort place =
      file.control ? place_of(*file.control) : text::HostAndPort{.host = "127.0.0.1", .port = 0};
  const auto answer = [this](std::string_view line, serve::ControlServer::Reply reply) {
    return run_control_.answer(line, std::move(reply));
  };
  control_.emplace(io_, clock_, answer, serve::ControlServerOptions{.allowed = file.control_allowed},
                   use_.report("control"));
  const auto result = control_->listen(place.host, place.port);
  return opened(result, "control", file.name, place, control_->port());
}

bool PlantServers::open_socketcand(std::size_t bus) {
  const plant::BusSection& section = plant_.bus_section(bus);
  // Commands of the page join a simulated bus like any other program. Other users of this machine do not: the page has roles.
  const bool is_for_page = !section.socketcand && !section.is_linked() && use_.web_events != nullptr;
  if (!section.socketcand && !is_for_page) return true;
  const text::HostAndPort place =
      is_for_page ? text::HostAndPort{.host = "127.0.0.1", .port = 0} : place_of(*section.socketcand);
  boost::system::error_code error;
  const auto address = asio::ip::make_address(place.host == "localhost" ? "127.0.0.1" : place.host, error);
  if (error) {
    print_error("canopus: \"{}\" is not an address to listen on; expected numbers such as 127.0.0.1",
                place.host);
    return false;
  }
  serve::ClientPorts& ports = *client_ports_.emplace_back(std::make_unique<serve::ClientPorts>(
      plant_.bus(bus), plant_.timeline_of_bus(bus), !section.is_linked()));
  const auto attach = [&ports](link::AttachedClient& client) { return ports.attach(client); };
  link::SocketcandServer& server = *socketcand_.emplace_back(std::make_unique<link::SocketcandServer>(
      io_, asio::ip::tcp::endpoint(address, place.port), section.name, attach, clock_,
      link::SocketcandLimits{.allowed = is_for_page ? link::AllowList() : section.allowed,
                             .own_user_alone = is_for_page},
      use_.report(fmt::format("socketcand {}", section.name))));
  const auto result = server.listen();
  if (result) socketcand_places_[bus] = {.host = place.host, .port = server.port()};
  if (result && is_for_page) return true;
  if (result && section.announced) {
    const asio::ip::tcp::endpoint reached(address, server.port());
    beacons_.push_back(std::make_unique<link::SocketcandBeacon>(
        io_, link::beacon_destination(address),
        link::socketcand_beacon(plant_.file().name, section.name, reached)));
  }
  return opened(result, "socketcand", section.name, place, server.port());
}

/// For --bus: the plant's own server, or the bus outside where several programs can join it.
std::string PlantServers::address_for_commands(std::size_t bus) const {
  if (const auto server = socketcand_places_.find(bus); server != socketcand_places_.end()) {
    const auto& [host, port] = server->second;
    return fmt::format("socketcand:{}:{}",
                       host.find(':') == std::string::npos ? host : fmt::format("[{}]", host), port);
  }
  const plant::BusSection& section = plant_.bus_section(bus);
  using enum link::BusAddress::Kind;
  const bool is_shared =
      section.address && section.address->kind != slcan && section.address->kind != cannelloni;
  return is_shared ? section.link : std::string();
}

/// Options for the PLC that has such a module, at its head address if there are several; empty: none has.
std::vector<std::string> PlantServers::way_to_plc(const web::WebSettings& settings) const {
  const MelsecWay* found = nullptr;
  for (const auto& [plc, way] : melsec_ways_) {
    for (const plant::ModuleSection& module : plant_.plc_section(plc).modules) {
      if (module.model != settings.model) continue;
      if (found == nullptr || module.head == settings.head) found = &way;
    }
  }
  if (found == nullptr) return {};
  const plant::MelsecPortSection& port = *found->section;
  const std::string& listens = port.listen.host;
  const std::string host = listens == "0.0.0.0" ? "127.0.0.1" : listens == "::" ? "::1" : listens;
  std::vector<std::string> way{"--plc=" + plc_place_text(host, found->port)};
  if (!port.settings.takes_3e) way.emplace_back("--1e");
  if (port.settings.code == plc::melsec::DataCode::ascii) way.emplace_back("--ascii");
  if (port.udp) way.emplace_back("--udp");
  return way;
}

std::vector<web::WebSettings> PlantServers::settings_for_page() const {
  std::vector<web::WebSettings> all = use_.web_settings;
  std::vector<std::string> device_files;
  const std::filesystem::path folder = std::filesystem::path(plant_.file().path).parent_path();
  for (const plant::DeviceSection& device : plant_.file().devices) {
    const std::string file = (folder / device.eds).string();
    if (!device.eds.empty() && std::ranges::find(device_files, file) == device_files.end())
      device_files.push_back(file);
  }
  for (web::WebSettings& one : all) {
    if (!one.plc.empty()) continue;
    one.plc = way_to_plc(one);
    one.device_files = device_files;
    for (std::size_t i = 0; i < plant_.bus_count(); ++i) {
      const plant::BusSection& section = plant_.bus_section(i);
      one.is_live = one.is_live || (section.is_linked() && section.replay.empty());
    }
  }
  return all;
}

bool PlantServers::open_web() {
  if (use_.web_events == nullptr) return true;
  std::vector<web::WebBus> buses;
  // A page of module settings alone has none: the run's own bus has no nodes.
  const bool has_buses =
      !use_.web_project || !use_.web_project->project.empty() || !use_.web_project->start.empty();
  for (std::size_t i = 0; has_buses && i < plant_.bus_count(); ++i) {
    const plant::BusSection& section = plant_.bus_section(i);
    buses.push_back({.name = section.name,
                     .project = project_of(plant_.file(), section),
                     .network = static_cast<unsigned>(section.project_network),
                     .address = address_for_commands(i),
                     .bit_rate = section.bit_rate,
                     .is_live = section.is_linked() && section.replay.empty()});
    if (!use_.web_project) continue;
    buses.back().project = use_.web_project->project;
    buses.back().network = use_.web_project->network;
    buses.back().device_files = use_.web_project->device_files;
  }
  web_.emplace(io_, plant_, clock_, *use_.web_events, std::move(buses), settings_for_page(),
               web::WebFolders{.start = use_.web_project ? use_.web_project->start : std::string(),
                               .traces = use_.web_traces},
               use_.web_access, use_.web_pace, use_.report("web"));
  const text::HostAndPort place = place_of(use_.web);
  if (const auto result = web_->listen(place); !result) {
    print_error("canopus: web: {}", result.error());
    return false;
  }
  use_.opened("web", plant_.file().name, web_->url());
  return true;
}

web::WebPace pace_of(serve::RealTime& clock) {
  return {.speed = [&clock] { return clock.speed(); },
          .set_speed = [&clock](double speed, can::Duration time) { clock.set_speed(speed, time); }};
}

void set_cpu_clocks(plant::Plant& plant) {
  const auto moment = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  for (std::size_t i = 0; i < plant.plc_count(); ++i) {
    plant.rack(i).set_clock(text::local_time(moment), plant.timeline().now());
  }
}

}  // namespace canopus::cli
