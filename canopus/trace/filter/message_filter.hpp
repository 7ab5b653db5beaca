#pragma once
// A filter for the messages of a trace.

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/text/output.hpp"
#include "canopus/trace/decode/message.hpp"

namespace canopus::trace {

struct FilterOptions {
  std::vector<std::string> nodes{};  ///< node-IDs, or what the names of nodes begin with
  std::vector<std::string> services{};
  std::vector<std::string> objects{};
  std::vector<std::string> identifiers{};
  std::vector<std::string> aborts{};
  std::vector<std::string> channels{};
  std::string from{};
  std::string to{};
  std::string expression{};  ///< filter_expression.hpp
};

/// The name before a value in an error message.
struct FilterNames {
  std::string_view node = "--node ";
  std::string_view service = "--service ";
  std::string_view object = "--object: ";
  std::string_view identifier = "--can-id ";
  std::string_view abort = "--abort ";
  std::string_view from = "--from: ";
  std::string_view to = "--to: ";
};

class MessageFilter {
 public:
  /// The error is a sentence without "canopus: ".
  [[nodiscard]] static std::expected<MessageFilter, std::string> read(const FilterOptions& options,
                                                                      const FilterNames& names = {});
  /// Nothing after a mistake was printed on `err`.
  [[nodiscard]] static std::optional<MessageFilter> make(const FilterOptions& options, text::Output& err);

  /// `since`: from the first record of the trace on. Channels are ChannelChoice's.
  [[nodiscard]] bool wants(const Message& message, can::Duration since) const;
  /// True when no later message can pass the filter.
  [[nodiscard]] bool is_over(can::Duration since) const { return to_ && since > *to_; }

 private:
  struct Object {
    std::uint16_t index = 0;
    std::optional<std::uint8_t> sub{};
  };
  [[nodiscard]] bool has_object(const Message& message) const;

  [[nodiscard]] bool has_node(const Message& message) const;

  std::vector<unsigned> nodes_;
  std::vector<std::string> node_names_;  ///< in lower-case letters
  std::vector<Service> services_;
  std::vector<Object> objects_;
  std::vector<std::uint32_t> identifiers_;
  std::vector<std::uint32_t> aborts_;
  std::optional<can::Duration> from_;
  std::optional<can::Duration> to_;
};

}  // namespace canopus::trace
