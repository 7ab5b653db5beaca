#pragma once
// Who may use the page of a run, and what is kept of what they do: options of the commands that have a page.

#include <string>

namespace canopus::cli {

class Command;
class Option;

struct WebAccess {
  std::string
      users{};  ///< their file; empty: the one who runs the program, by the key of the printed address
  std::string audit{};   ///< the audit log; empty: with users beside their file, else none
  std::string origin{};  ///< "https://plant.example": what is in front of the server; empty: nothing

  /// Of the audit log; empty: none.
  [[nodiscard]] std::string audit_file() const {
    return audit.empty() && !users.empty() ? users + ".audit" : audit;
  }
};

/// --web-users, --web-audit, --web-origin; `prefix` is "--web-" or "--". Each needs `page`, the option that opens the page, if
/// there is one. `access` outlives the command.
void add_web_access_options(Command& command, const std::string& prefix, WebAccess& access,
                            Option* page = nullptr);

}  // namespace canopus::cli
