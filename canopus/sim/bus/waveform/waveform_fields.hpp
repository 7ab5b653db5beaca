#pragma once
// Which field of a frame each port is in, in few lines: one field for the bus, and one of its own for a port that is
// elsewhere. On a healthy bus all are in the same field at all times.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "canopus/can/bus_error.hpp"

namespace canopus::sim {

class WaveformFields {
 public:
  /// The value of a port that is where the bus is.
  static constexpr int as_bus = -1;

  explicit WaveformFields(std::size_t ports) : fields_(ports), reported_(ports, as_bus) {
    counts_[number(can::FrameField::idle)] = ports;
  }

  [[nodiscard]] can::FrameField of_bus() const noexcept { return bus_; }  ///< as reported last
  [[nodiscard]] can::FrameField of(std::size_t port) const noexcept { return fields_[port]; }
  void set(std::size_t port, can::FrameField field) noexcept {
    --counts_[number(fields_[port])];
    ++counts_[number(field)];
    fields_[port] = field;
    has_changed_ = true;
  }
  void set_all(can::FrameField field) noexcept;
  /// Ports in the one field are in the other.
  void replace(can::FrameField one, can::FrameField other) noexcept;

  /// All changes of a moment have come: reports what is new. on_bus(field), on_port(port, field or as_bus).
  template <typename OnBus, typename OnPort>
  void settle(OnBus on_bus, OnPort on_port) {
    if (!has_changed_) return;
    has_changed_ = false;
    const can::FrameField common = most_common();
    if (common != bus_) {
      bus_ = common;
      on_bus(bus_);
    }
    if (apart_ == 0 && all_are_with_the_bus()) return;
    for (std::size_t port = 0; port < fields_.size(); ++port) {
      const int value = value_of(port);
      if (value == reported_[port]) continue;
      if (value == as_bus) --apart_;
      if (reported_[port] == as_bus) ++apart_;
      reported_[port] = static_cast<std::int8_t>(value);
      on_port(port, value);
    }
  }

 private:
  [[nodiscard]] static constexpr std::size_t number(can::FrameField field) noexcept {
    return static_cast<std::size_t>(field);
  }
  [[nodiscard]] can::FrameField most_common() const noexcept;
  [[nodiscard]] bool all_are_with_the_bus() const noexcept {
    const std::size_t late = bus_ == can::FrameField::start_of_frame ? counts_[0] : 0;
    return counts_[number(bus_)] + late == fields_.size();
  }
  [[nodiscard]] int value_of(std::size_t port) const noexcept;

  std::vector<can::FrameField> fields_;
  std::vector<std::int8_t> reported_;
  std::size_t apart_ = 0;  // ports that are reported with something else than as_bus
  std::array<std::size_t, can::frame_fields> counts_{};
  can::FrameField bus_ = can::FrameField::idle;  // as reported
  bool has_changed_ = false;
};

}  // namespace canopus::sim
