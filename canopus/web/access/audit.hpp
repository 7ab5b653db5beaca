#pragma once
// The audit log of the page: a file that only grows, one JSON object a line for each command and each log-in. A thread of its
// own writes it: a slow disk delays nothing.

#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <string_view>

#include "canopus/web/access/user.hpp"

namespace canopus::serve {
class Worker;
}

namespace canopus::web {

struct WebAuditEntry {
  double plant_time = 0;          ///< s
  std::int64_t milliseconds = 0;  ///< since 1970-01-01, UTC
  WebUser user{};
  std::string what{};  ///< "canopus nmt start 3 --bus ...", "log in"
  int code = 0;        ///< 0 = done; else why not, as in docs/web.md
  std::string message{};
};

/// {"at":"2026-11-24T01:02:03.456Z","t":12.5,"user":"anna","role":"operate","address":"192.168.1.7:50123","do":"log in","code":0}
[[nodiscard]] std::string audit_line(const WebAuditEntry& entry);

class WebAudit {
 public:
  /// Opens the file or makes it, for its owner alone. The error names it.
  [[nodiscard]] static std::expected<std::unique_ptr<WebAudit>, std::string> open(const std::string& file);
  /// Waits two seconds for the disk.
  ~WebAudit();
  WebAudit(const WebAudit&) = delete;
  WebAudit& operator=(const WebAudit&) = delete;

  /// A line, without its end. One for which there is no room, because the disk hangs, is counted, and so is one that cannot be
  /// written; what a reader finds is {"lost":N} in their place.
  void add(std::string_view line);
  /// Why lines could not be written since the last call; empty: none were lost.
  [[nodiscard]] std::string next_trouble();

  /// Lines that are lost and not made up for by {"lost":N} yet.
  [[nodiscard]] std::uint64_t lost() const;

  static constexpr std::size_t most_waiting = 10000;  ///< lines

 private:
  struct File;
  explicit WebAudit(std::shared_ptr<File> file);
  std::shared_ptr<File> file_;
  std::unique_ptr<serve::Worker> worker_;
};

}  // namespace canopus::web
