#pragma once
// The errors and warnings of a run that shows a table: kept, because they have to be read after the table has
// gone, too. Of very many the first and the latest ones.

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

struct RunMessage {
  can::Time time{};
  std::string text{};  ///< "ME3CAN1-Q U0: G24 = 300: not a baud rate"
  bool is_error = true;
  bool is_printed = false;  ///< a person has it without the table
};

class RunMessages {
 public:
  static constexpr std::size_t first_kept = 100;
  static constexpr std::size_t latest_kept = 400;

  void add(RunMessage message);
  [[nodiscard]] std::uint64_t errors() const noexcept { return errors_; }
  [[nodiscard]] std::uint64_t warnings() const noexcept { return warnings_; }
  /// At most this number, newest last.
  [[nodiscard]] std::vector<RunMessage> latest(std::size_t count) const;
  /// Prints the pending messages, as a run without a table does, and the number of dropped ones.
  void print(Output& out) const;
  /// One of them.
  static void print(const RunMessage& message, Output& out);

 private:
  std::vector<RunMessage> first_;
  std::deque<RunMessage> latest_;
  std::uint64_t errors_ = 0;
  std::uint64_t warnings_ = 0;
  std::uint64_t unprinted_ = 0;
};

}  // namespace canopus::cli
