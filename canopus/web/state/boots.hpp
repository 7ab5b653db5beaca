#pragma once
// The boots of all slaves, step by step, for the page: what a waterfall is drawn from.

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::web {

class WebBoots final : public plant::PlantObserver {
 public:
  static constexpr std::size_t most_steps = 64;  ///< of each slave, the newest

  struct Step {
    can::Time at{};  ///< began then
    manager::BootRecord record{};
  };
  struct Slave {
    std::string bus;
    std::string name;
    std::uint8_t node_id = 0;
    std::uint8_t master = 0;
    std::deque<Step> steps{};
  };

  /// By bus and node-ID.
  [[nodiscard]] const std::map<std::pair<std::string, std::uint8_t>, Slave>& slaves() const noexcept {
    return slaves_;
  }

  void on(const plant::Event& event) override;

 private:
  std::map<std::pair<std::string, std::uint8_t>, Slave> slaves_;
};

}  // namespace canopus::web
