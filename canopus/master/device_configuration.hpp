#pragma once
// The values of a device compared with those of its DCF, and the writes that make them agree.

#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopus/eds/device_file.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::master {

/// The objects of one device, as its SDO server has them.
class ObjectAccess {
 public:
  struct Failure {
    bool is_refused =
        false;           ///< the device answered with an abort; false: it did not answer, or the bus is lost
    std::string reason;  ///< "abort 06090030H: value range of parameter exceeded"
  };
  virtual ~ObjectAccess() = default;
  /// The bytes of a value of this type: an answer without the number of bytes is cut to it.
  [[nodiscard]] virtual std::expected<std::vector<std::uint8_t>, Failure> read(text::ObjectName object,
                                                                               canopen::DataType type) = 0;
  [[nodiscard]] virtual std::expected<void, Failure> write(text::ObjectName object,
                                                           std::span<const std::uint8_t> value) = 0;
};

/// A value as it should be, and what the device has.
struct ComparedValue {
  enum class State : std::uint8_t {
    same,
    different,
    refused,      ///< it cannot be read
    not_answered  ///< from here on nothing was asked any more
  };
  text::ObjectName object{};
  canopen::DataType type{};
  std::vector<std::uint8_t> wanted{};
  State state = State::not_answered;
  std::vector<std::uint8_t> found{};
  std::string reason{};  ///< of a failure
};

/// Called after each access: how many are done, of how many. False: go no further.
using Progress = std::function<bool(std::size_t done, std::size_t of)>;

/// Identity of the device (1000H, 1018:01-03) against the file, without values that are 0 there; 1000H alone if all are.
[[nodiscard]] std::vector<ComparedValue> compare_identity(const eds::DeviceFile& file, ObjectAccess& access);

/// Every value that the DCF configures and that can be read, in order of index. Commands (1010H, 1011H) and those of a file
/// that forbids to read them are left out.
[[nodiscard]] std::vector<ComparedValue> compare_configuration(const eds::DeviceFile& file,
                                                               std::uint8_t node_id, ObjectAccess& access,
                                                               const Progress& progress);

/// Every value that a device holds as its configuration and that differs from the file: values that can be
/// written and read, except process data (what can be mapped and has no value in the DCF), 1003H, 1010H,
/// 1011H and domains. Those of type UNICODE_STRING are left out, too: files have none.
[[nodiscard]] std::vector<ComparedValue> find_changed(const eds::DeviceFile& file, std::uint8_t node_id,
                                                      ObjectAccess& access, const Progress& progress);

struct WriteStep {
  enum class State : std::uint8_t { not_tried, written, refused, not_answered };
  text::ObjectName object{};
  std::vector<std::uint8_t> value{};
  State state = State::not_tried;
  std::string reason{};  ///< of a failure, or why it was not tried
};

/// The writes that set what differs to the values of the DCF, in the order that CiA 301 requires: a PDO is
/// switched off, changed as a whole, and switched on again; 1020H comes last.
[[nodiscard]] std::vector<WriteStep> plan_writes(const eds::DeviceFile& file, std::uint8_t node_id,
                                                 std::span<const ComparedValue> compared);

/// Makes them. After a refusal the rest of that PDO is not tried, so that it stays off; after silence nothing more is.
void write(std::vector<WriteStep>& steps, ObjectAccess& access, const Progress& progress);

/// A value as a DCF has it; nothing for a type that files do not hold. COB-IDs and mappings in hexadecimal.
[[nodiscard]] std::optional<std::string> value_text(text::ObjectName object, canopen::DataType type,
                                                    std::span<const std::uint8_t> value);

}  // namespace canopus::master
