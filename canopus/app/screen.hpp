#pragma once

#include <string>

#include "canopus/app/live_table.hpp"

namespace canopus::app {

/// The terminal's part of the screen, redrawn in place.
class Screen {
 public:
  ~Screen();

  void show(const std::string& picture);
  /// Gives the terminal back as it was.
  void leave();

  [[nodiscard]] static TableSize size();

 private:
  bool shown_ = false;
};

}  // namespace canopus::app
