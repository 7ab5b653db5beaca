#pragma once
// What the page of a run knows of its buses: for each base identifier the last frame with its bits, for each class of frames how
// long they had the bus, and the errors by kind and place. It is counted from the plant's start on, whoever looks.

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/text/json.hpp"
#include "canopus/web/state/arbitration_probe.hpp"
#include "canopus/web/state/bus_statistics_view.hpp"

namespace canopus::web {

/// Classes of frames by their identifiers, as CiA 301 assigns them.
enum class FrameClass : std::uint8_t { nmt, sync, emcy, time, pdo, sdo, error_control, lss, other };
inline constexpr std::size_t frame_classes = 9;
/// "PDO"
[[nodiscard]] std::string_view name(FrameClass frame_class) noexcept;
[[nodiscard]] FrameClass class_of(const can::Frame& frame) noexcept;

class WebTraffic {
 public:
  /// The last frame of an identifier.
  struct Seen {
    std::uint64_t frames = 0;  ///< 0: none yet
    can::Time start{};         ///< of its SOF
    can::Time at{};            ///< end of the frame
    can::Frame frame{};
  };
  /// An error frame: what its first finder found.
  struct ErrorFrame {
    can::Time at = can::never;  ///< the sample point of the bit
    can::BusErrorReport first{};
    std::size_t finders = 0;  ///< at the same bit
  };
  static constexpr std::size_t most_error_frames = 8;  ///< the latest ones
  static constexpr std::size_t most_extended = 64;     ///< identifiers of 29 bits: the first ones of a bus
  /// Of one bus.
  struct Bus {
    std::array<Seen, 2048> seen{};                    ///< by base identifier
    std::array<Seen, most_extended> extended{};       ///< in the order in which they came
    std::array<can::Duration, frame_classes> busy{};  ///< time on the bus, without intermission
    std::array<std::uint64_t, frame_classes> frames{};
    /// Error frames, by what their first finder found and where.
    std::array<std::array<std::uint64_t, can::frame_fields>, 6> errors{};
    std::array<ErrorFrame, most_error_frames> error_frames{};
    std::size_t next_error_frame = 0;
    BusStatisticsView figures{};
  };

  /// The plant must outlive this.
  explicit WebTraffic(plant::Plant& plant);
  ~WebTraffic();
  WebTraffic(const WebTraffic&) = delete;
  WebTraffic& operator=(const WebTraffic&) = delete;

  /// The event of a view {"traffic": BUS, "can_id": 389}: of the bus of that number in `state`, with the bits of the last frame of
  /// that base identifier, with "extended": true of that identifier of 29 bits, if there was one; empty: there is no such bus.
  [[nodiscard]] std::string event_of(const text::Json& wish);
  /// No client has the view any more.
  void forget() { wires_.clear(); }
  /// Of the bus of this name; nullptr: there is none.
  [[nodiscard]] const BusStatisticsView* figures(std::string_view bus) const noexcept;

 private:
  [[nodiscard]] static Seen* seen_of(Bus& bus, std::uint32_t identifier, bool extended) noexcept;

  struct Tap final : can::BusObserver {
    void frame_completed(const can::Frame& frame, can::Time start, can::Time end) override;
    void errors_reported(std::span<const can::BusErrorReport> reports, can::Time now) override;
    Bus bus;
  };

  plant::Plant& plant_;
  [[nodiscard]] ArbitrationProbe* wire_of(std::size_t bus);
  void add_frame(text::Json& event, std::size_t bus, const Seen& seen);
  void add_error_frames(text::Json& event, std::size_t bus);

  std::vector<std::unique_ptr<Tap>> taps_;
  std::map<std::size_t, ArbitrationProbe> wires_;  // of simulated buses that are observed
};

/// Adds `bits`: each bit of the frame as the bus had it: `level` (`d`, `r`), `field`, and `stuff` when it is a stuff bit.
void add_bits(text::Json& event, const can::Frame& frame);

}  // namespace canopus::web
