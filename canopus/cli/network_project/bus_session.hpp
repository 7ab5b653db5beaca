#pragma once
// The devices of a bus against a project, one after another: compared, written, taken over; each result is printed as it is
// found.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/cli/network_project/bus_objects.hpp"
#include "canopus/cli/network_project/project_command.hpp"

namespace canopus::cli {

class BusSession {
 public:
  BusSession(const ProjectArguments& arguments, BusLoop& bus, can::Duration time_out);

  /// One device against its DCF; what differs is listed.
  void compare(const network_project::ProjectNode& node);
  /// And written where it differs, with --yes; then read back. A device with another identity is left alone.
  void write(const network_project::ProjectNode& node);
  /// Takes over into the project what a device has otherwise; of one that falls silent nothing.
  void accept_values(network_project::NetworkProject& project, std::uint8_t node_id);

  /// The summary with --json; the exit code of all that was done.
  [[nodiscard]] int end();

 private:
  using Values = std::vector<master::ComparedValue>;

  void silent(const network_project::ProjectNode& node, std::string_view what);
  /// Whether the device on the bus is the project's: a project is not written into another device.
  bool is_the_device(const network_project::ProjectNode& node, BusObjects& objects);
  /// None: it is another device, or does not answer; prints the reason.
  std::optional<Values> compared(const network_project::ProjectNode& node, BusObjects& objects);
  /// None: it does not answer any more; prints nothing.
  std::optional<Values> values_of_device(const network_project::ProjectNode& node, BusObjects& objects);
  void save(const network_project::ProjectNode& node, BusObjects& objects);

  void print_result(const network_project::ProjectNode& node, const master::ComparedValue& value);
  void print_result(const network_project::ProjectNode& node, const master::WriteStep& step,
                    std::string_view state, const std::string& reason, bool is_bad);
  /// `now`: the device's values after the writes; none: not read back.
  void print_writes(const network_project::ProjectNode& node, const std::vector<master::WriteStep>& steps,
                    const Values* now);
  void print_differences(const network_project::ProjectNode& node, const Values& values);
  void print_summary(const network_project::ProjectNode& node, const Values& values, std::string_view good);
  void print_accepted_value(const network_project::ProjectNode& node, const master::ComparedValue& value,
                            const std::string& why_not);

  /// The number of nodes by result.
  struct Summary {
    unsigned same = 0;
    unsigned different = 0;
    unsigned silent = 0;
    unsigned refused = 0;
  };

  const ProjectArguments& arguments_;
  BusLoop& bus_;
  can::Duration time_out_;
  Summary summary_;
};

}  // namespace canopus::cli
