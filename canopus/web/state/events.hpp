#pragma once
// The events of a run for its page in the browser: the same objects as `canopus run --json` prints, and `state`
// (docs/events.md).

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>

#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/text/output.hpp"
#include "canopus/web/state/boots.hpp"
#include "canopus/web/state/traffic.hpp"

namespace canopus::web {

/// Two observers as one; the first gets each event first.
class ObserverPair final : public plant::PlantObserver {
 public:
  /// Both must outlive the pair.
  ObserverPair(plant::PlantObserver& first, plant::PlantObserver& second) : first_(first), second_(second) {}

  void on(const plant::Event& event) override {
    first_.on(event);
    second_.on(event);
  }

 private:
  plant::PlantObserver& first_;
  plant::PlantObserver& second_;
};

/// An observer that passes everything on to `first`, makes JSON of it for the page, and keeps how slaves booted.
class WebEvents {
 public:
  explicit WebEvents(plant::PlantObserver& first) : pair_(first, json_) {}
  [[nodiscard]] plant::PlantObserver& observer() noexcept { return all_; }
  [[nodiscard]] const WebBoots& boots() const noexcept { return boots_; }
  /// Gets the events from now on; those up to now at once.
  void set_listener(std::function<void(std::string_view)> listener);
  /// A server listens.
  void listening(std::string_view protocol, std::string_view of, std::string_view address) {
    json_.listening(protocol, of, address);
  }
  /// The event in place of so many that a client did not get.
  [[nodiscard]] std::string lost(std::uint64_t events) const;

 private:
  void add(std::string_view line);

  static constexpr std::size_t most_kept = 500;
  std::function<void(std::string_view)> listener_;
  std::deque<std::string> early_;  // before there was a listener
  text::FunctionOutput lines_{[this](std::string_view line) { add(line); }};
  plant::JsonPrinter json_{lines_};
  ObserverPair pair_;
  WebBoots boots_;
  ObserverPair all_{pair_, boots_};
};

/// The `state` event: what there is to see of the plant at this moment, as JSON.
/// `traffic`: what the frames show of the nodes, `boots`: which of them had their identity compared; nullptr: not known.
/// `speed`: how fast plant time goes.
[[nodiscard]] std::string state_event(plant::Plant& plant, const WebTraffic* traffic = nullptr,
                                      const WebBoots* boots = nullptr, double speed = 1);

}  // namespace canopus::web
