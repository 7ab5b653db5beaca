#pragma once
// Which connection gives way when a client comes and all places of a server are taken: one rule for all of its servers.

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace canopus::link {

/// The priority of a connection's place; connections with a lower one give way first.
enum class Hold : std::uint8_t {
  none,        ///< it gives way to any connection
  weak,        ///< likewise, when there are none of those
  while_used,  ///< when nothing has come from it for a while
  firm,        ///< never
};

struct HeldPlace {
  using Clock = std::chrono::steady_clock;
  Hold hold = Hold::firm;
  Clock::time_point used{};  ///< something came from it then; of the same hold the earliest gives way
  std::uint64_t number = 0;  ///< of those with the same time the lowest
};

class ConnectionPlaces {
 public:
  using Clock = HeldPlace::Clock;

  /// `gives_way_after`: with Hold::while_used.
  ConnectionPlaces(std::size_t most, std::chrono::milliseconds gives_way_after)
      : most_(most), gives_way_after_(gives_way_after) {}

  /// Whether a new connection of this name is admitted; one of the connections may be closed for it.
  /// Connections have name(), place() (a HeldPlace) and close(). `report(client, what)` reports the closed
  /// connection, or the refusal.
  template <typename Connection, typename Report>
  [[nodiscard]] bool make_room(std::vector<std::shared_ptr<Connection>>& connections,
                               const std::string& newcomer, Clock::time_point now,
                               const Report& report) const {
    if (connections.size() < most_) return true;
    if (give_way(connections, newcomer, now, report, [](const Connection&) { return true; })) return true;
    report(newcomer, fmt::format("was refused: all {} connections are in use", most_));
    return false;
  }

  /// Closes one of those for which `IsMeant` is true, if one gives way. False: none does.
  template <typename Connection, typename Report, typename IsMeant>
  bool give_way(std::vector<std::shared_ptr<Connection>>& connections, const std::string& newcomer,
                Clock::time_point now, const Report& report, const IsMeant& is_meant) const {
    const auto comes_before = [](const HeldPlace& one, const HeldPlace& other) {
      if (one.hold != other.hold) return one.hold < other.hold;
      return one.used != other.used ? one.used < other.used : one.number < other.number;
    };
    auto first = connections.end();
    for (auto one = connections.begin(); one != connections.end(); ++one) {
      if (!is_meant(**one)) continue;
      if (first == connections.end() || comes_before((*one)->place(), (*first)->place())) first = one;
    }
    if (first == connections.end()) return false;
    const HeldPlace place = (*first)->place();
    const auto idle = now - place.used;
    if (place.hold == Hold::firm || (place.hold == Hold::while_used && idle < gives_way_after_)) return false;
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(idle).count();
    report((*first)->name(), place.hold == Hold::while_used
                                 ? fmt::format("has sent no request for {} s: its connection gives way to {}",
                                               seconds, newcomer)
                                 : fmt::format("gives way to {}: its connection is closed", newcomer));
    const auto closed = *first;
    connections.erase(first);
    closed->close();
    return true;
  }

 private:
  std::size_t most_;
  std::chrono::milliseconds gives_way_after_;
};

}  // namespace canopus::link
