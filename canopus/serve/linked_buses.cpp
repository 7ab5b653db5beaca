#include "canopus/serve/linked_buses.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/plant/event.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/serve/replay_bus.hpp"

namespace canopus::serve {

LinkedBuses::LinkedBuses(boost::asio::io_context& io, const std::string& plant_path, bool virtual_time,
                         trace::KeepReading keep_reading)
    : io_(io),
      folder_(std::filesystem::path(plant_path).parent_path()),
      virtual_time_(virtual_time),
      keep_reading_(std::move(keep_reading)) {}

LinkedBuses::~LinkedBuses() = default;

std::expected<std::unique_ptr<can::Bus>, std::string> LinkedBuses::open(const plant::BusSection& section,
                                                                        can::Timeline& timeline) {
  std::unique_ptr<link::BusClient> client;
  if (!section.replay.empty()) {
    auto replay = ReplayBus::open((folder_ / section.replay).lexically_normal().string(),
                                  section.replay_channel, timeline, keep_reading_);
    if (!replay) return std::unexpected(replay.error());
    client = std::move(*replay);
  } else if (virtual_time_) {
    return std::unexpected(
        "a plant in virtual time runs ahead of a real bus; leave --virtual out, or expected link = \"sim\"");
  } else {
    auto opened = link::open_bus(io_, *section.address, {.keep_trying = true, .bit_rate = section.bit_rate});
    if (!opened) return std::unexpected(opened.error());
    client = std::move(*opened);
  }
  auto bus = std::make_unique<link::LinkedBus>(section.name, section.bit_rate, timeline, std::move(client));
  buses_.push_back(bus.get());
  return bus;
}

void LinkedBuses::start(link::LoopClock* clock, plant::Plant& plant) {
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    const auto bus =
        std::ranges::find(buses_, &plant.bus(i), [](link::LinkedBus* linked) -> can::Bus* { return linked; });
    if (bus == buses_.end()) continue;
    plant::PlantObserver& observer = plant.observer_of_bus(i);
    (*bus)->start(clock, [&observer, bus = *bus](std::string_view text, can::Time now) {
      observer.on({now, plant::Failure{fmt::format("bus {}", bus->name()), std::string(text)}});
    });
  }
}

void LinkedBuses::close(std::chrono::milliseconds time_out) {
  for (link::LinkedBus* bus : buses_) (void)bus->close(time_out);
}

}  // namespace canopus::serve
