#include "canopus/plant/plant_partitioning.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <string_view>

#include "canopus/plant/event.hpp"
#include "canopus/plant/plant_assembly.hpp"

namespace canopus::plant {

namespace {

constexpr std::string_view stall_text =
    "sets its deadline to this moment without end and is stopped from here on. This is an error in Canopus: "
    "please "
    "report "
    "it with the plant file";

/// Buses that are joined, each set known by its first bus.
class JoinedBuses {
 public:
  explicit JoinedBuses(const std::vector<BusSection>& sections)
      : sections_(sections), first_(sections.size()) {
    std::iota(first_.begin(), first_.end(), std::size_t{0});
  }

  [[nodiscard]] std::size_t first(std::size_t bus) const { return first_[bus]; }
  /// None: a mistake in the plant file.
  [[nodiscard]] std::optional<std::size_t> number(std::string_view name) const {
    const auto found = std::ranges::find(sections_, name, &BusSection::name);
    if (found == sections_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - sections_.begin());
  }
  void join(std::optional<std::size_t> one, std::optional<std::size_t> other) {
    if (!one || !other) return;
    const auto [low, high] = std::minmax({first_[*one], first_[*other]});
    std::ranges::replace(first_, std::size_t{high}, std::size_t{low});
  }

 private:
  const std::vector<BusSection>& sections_;
  std::vector<std::size_t> first_;
};

}  // namespace

PlantPartitioning PlantPartitioning::of(const PlantFile& file) {
  JoinedBuses joined(file.buses);
  for (const BridgeSection& bridge : file.bridges) {
    joined.join(joined.number(bridge.from), joined.number(bridge.to));
  }
  for (const PlcSection& plc : file.plcs) {
    for (const ModuleSection& module : plc.modules) {
      joined.join(joined.number(plc.modules.front().bus), joined.number(module.bus));
    }
  }
  PlantPartitioning division;
  for (std::size_t bus = 0; bus < file.buses.size(); ++bus) {
    const std::size_t first = joined.first(bus);
    division.buses.push_back(first == bus ? division.count++ : division.buses[first]);
  }
  for (const PlcSection& plc : file.plcs) {
    std::size_t part = 0;
    for (const ModuleSection& module : plc.modules) {
      if (const auto bus = joined.number(module.bus)) part = division.buses[*bus];
    }
    division.racks.push_back(part);
  }
  return division;
}

/// Parts that share nothing have timelines of their own, so that each can run by itself.
void Assembly::divide() {
  parts_.division = PlantPartitioning::of(parts_.file);
  const auto report_stalls = [this](can::Timeline& timeline, PlantObserver& observer) {
    timeline.set_stall_handler([parts = &parts_, &observer](const can::Timeline::Stall& stall) {
      parts->has_stalled = true;
      observer.on({stall.now, Failure{std::string(stall.name), std::string(stall_text)}});
    });
  };
  report_stalls(parts_.timeline, observer_);
  for (std::size_t part = 0; part < std::max<std::size_t>(1, parts_.division.count); ++part) {
    can::Timeline& timeline = parts_.division.count < 2 ? parts_.timeline : parts_.timeline.add_partition();
    parts_.events.push_back(std::make_unique<DeferredEvents>(observer_, timeline));
    if (&timeline != &parts_.timeline) report_stalls(timeline, *parts_.events.back());
  }
}

std::size_t Assembly::partition_of(std::string_view bus) const {
  const auto found = std::ranges::find(parts_.file.buses, bus, &BusSection::name);
  if (found == parts_.file.buses.end()) return 0;  // a mistake in the plant file
  return parts_.division.buses[static_cast<std::size_t>(found - parts_.file.buses.begin())];
}

}  // namespace canopus::plant
