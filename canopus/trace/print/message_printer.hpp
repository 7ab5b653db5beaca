#pragma once
// Decoded messages on the terminal, line by line, or as JSON.

#include <optional>
#include <string>
#include <string_view>

#include "canopus/can/time.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/output.hpp"
#include "canopus/trace/decode/message.hpp"

namespace canopus::trace {

/// The first column, as `candump -t` has it.
enum class TimeColumn : char { absolute = 'a', delta = 'd', zero = 'z', date = 'A' };

struct PrinterOptions {
  TimeColumn time = TimeColumn::zero;
  bool frames = false;  ///< with the bytes of each frame
  bool json = false;
  bool colour = false;
};

class MessagePrinter {
 public:
  MessagePrinter(PrinterOptions options, text::Output& out) : options_(options), out_(out) {}

  /// `channel`: its name; empty: there is but one.
  void print(const Message& message, std::string_view channel);
  /// The zero of the time column in TimeColumn::zero.
  void set_zero(can::Time zero) { zero_ = zero; }

 private:
  [[nodiscard]] std::string time_text(can::Time time);

  PrinterOptions options_;
  text::Output& out_;
  can::Time zero_{};
  std::optional<can::Time> last_;
  std::size_t channel_width_ = 4;
  std::size_t node_width_ = 12;
};

/// The text that a filter's texts are searched in: bus, service, node, object, kind and meaning.
[[nodiscard]] std::string searched_text(const Message& message, std::string_view bus);
/// "6000:01 Digital inputs 1 to 8"; empty: there is none.
[[nodiscard]] std::string object_text(const Message& message);
/// Service, and which of them: "TPDO1", "heartbeat", "SDO".
[[nodiscard]] std::string service_text(const Message& message);
[[nodiscard]] text::Json to_json(const Message& message, std::string_view channel);

}  // namespace canopus::trace
