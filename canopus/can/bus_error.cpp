#include "canopus/can/bus_error.hpp"

#include <array>

namespace canopus::can {
namespace {

constexpr std::array<std::string_view, frame_fields> field_names{"idle",
                                                                 "SOF",
                                                                 "ID.28-21",
                                                                 "ID.20-18",
                                                                 "RTR",
                                                                 "IDE",
                                                                 "ID.17-13",
                                                                 "ID.12-5",
                                                                 "ID.4-0",
                                                                 "RTR (extended)",
                                                                 "r1",
                                                                 "r0",
                                                                 "DLC",
                                                                 "data",
                                                                 "CRC",
                                                                 "CRC delimiter",
                                                                 "ACK slot",
                                                                 "ACK delimiter",
                                                                 "EOF",
                                                                 "intermission",
                                                                 "suspend",
                                                                 "active error flag",
                                                                 "passive error flag",
                                                                 "overload flag",
                                                                 "superposition",
                                                                 "error delimiter",
                                                                 "overload delimiter"};

}  // namespace

std::string_view name(BusError error) noexcept {
  constexpr std::array<std::string_view, 6> names{"none", "bit", "stuff", "CRC", "form", "acknowledgement"};
  return names[static_cast<std::size_t>(error)];
}

std::string_view name(FrameField field) noexcept { return field_names[static_cast<std::size_t>(field)]; }

std::string_view name(ErrorState state) noexcept {
  constexpr std::array<std::string_view, 3> names{"error active", "error passive", "bus-off"};
  return names[static_cast<std::size_t>(state)];
}

bool field_of(std::string_view name, FrameField& field) noexcept {
  for (std::size_t number = 1; number < field_names.size(); ++number) {
    if (field_names[number] != name) continue;
    field = static_cast<FrameField>(number);
    return true;
  }
  return false;
}

}  // namespace canopus::can
