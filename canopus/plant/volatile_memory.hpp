#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/module/interface/non_volatile_memory.hpp"

namespace canopus::plant {

/// Non-volatile memory that lasts as long as the run: a rack without a store folder.
class VolatileMemory final : public module::NonVolatileMemory {
 public:
  Content read(std::string_view name) override {
    const auto found = contents_.find(name);
    if (found == contents_.end()) return {};
    return {Content::State::good, found->second};
  }
  bool write(std::string_view name, std::span<const std::uint8_t> bytes) override {
    contents_.insert_or_assign(std::string(name), std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
    return true;
  }
  bool erase(std::string_view name) override {
    contents_.erase(std::string(name));
    return true;
  }

 private:
  std::map<std::string, std::vector<std::uint8_t>, std::less<>> contents_;
};

}  // namespace canopus::plant
