#pragma once
// Transfer setups: connections to a PLC that are saved under a name, as in the configuration tools [RJ71CN91
// 3.2 Transfer setup]. They are in the file "transfer-setups" of user_state_folder(), one JSON object a line,
// with read permission for the owner only. They contain no passwords.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace canopus::cli {

struct TransferSetup {
  std::string host = "127.0.0.1";  ///< name or address
  std::uint16_t port = 0;          ///< 0: the usual one, 5007
  std::string frame = "3E";        ///< 3E, 4E or 1E
  bool ascii = false;
  bool udp = false;
  std::string timeout = "3s";  ///< a duration of at least 1 ms
  unsigned cpu = 0;            ///< of a multiple CPU system, 1 to 4; 0: None, the control CPU
  std::string cpu_type{};      ///< one of cpu_types(), which a test expects; empty: any
  std::string model{};         ///< of the module, "RJ71CN91"; empty: the one that goes with the CPU

  bool operator==(const TransferSetup&) const = default;
};

/// By name.
using TransferSetups = std::map<std::string, TransferSetup, std::less<>>;

inline constexpr std::size_t most_transfer_setups = 200;

/// The values of "CPU type" in the tool's wizard: R00 ... R120SF [RJ71CN91 3.2].
[[nodiscard]] std::span<const std::string_view> cpu_types() noexcept;
/// "CPU series" of one of them: "R" or "R Safety".
[[nodiscard]] std::string_view cpu_series(std::string_view cpu_type) noexcept;
/// Whether a CPU that calls itself so ("R08ENCPU") is of this type.
[[nodiscard]] bool is_of_cpu_type(std::string_view name, std::string_view cpu_type) noexcept;
/// "None", "No.2".
[[nodiscard]] std::string multiple_cpu(unsigned cpu);

/// Empty: it can be the name of a setup.
[[nodiscard]] std::string why_no_setup_name(std::string_view name);
/// Empty: all its values are in their ranges; else the value and what was expected.
[[nodiscard]] std::string why_no_setup(const TransferSetup& setup);

/// All of them; no file is none of them. The error names file and line.
[[nodiscard]] std::expected<TransferSetups, std::string> read_transfer_setups();
/// One of them. The error lists all names.
[[nodiscard]] std::expected<TransferSetup, std::string> find_transfer_setup(std::string_view name);

/// Why setups were not changed.
struct SetupTrouble {
  bool is_refused = false;  ///< else the file cannot be read or written
  std::string message;
};
/// Reads, changes and writes them under a lock. `change` returns the reason of a refusal, then nothing is
/// written; empty: changed.
[[nodiscard]] std::expected<void, SetupTrouble> change_transfer_setups(
    const std::function<std::string(TransferSetups&)>& change);
/// "there is no transfer setup \"x\"; expected a or b".
[[nodiscard]] std::string no_such_setup(std::string_view name, const TransferSetups& setups);

}  // namespace canopus::cli
