#pragma once
// The users of the page of a run, and what is recorded of their commands.

#include <string>

namespace canopus::web {

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

}  // namespace canopus::web
