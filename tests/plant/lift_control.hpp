#pragma once
// A small collective controller of lifts: a PLC program that knows an FX3U-CAN in 417 mode by its words alone.

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plant {

class LiftControl {
 public:
  /// Lifts 1 to `lifts`. Levels in mm.
  LiftControl(Plant& plant, unsigned lifts, std::vector<std::uint32_t> levels, std::uint32_t speed)
      : plant_(plant), levels_(std::move(levels)), speed_(speed), cars_(lifts) {}

  /// One scan of the PLC. Without levels nothing is controlled.
  void scan() {
    exchange();
    if (levels_.empty()) return;
    take_input();
    for (unsigned lift = 0; lift < cars_.size(); ++lift) control(lift);
  }
  void run_until(can::Time end) {
    while (plant_.timeline().now() < end) scan();
  }

  [[nodiscard]] can::Time now() const { return plant_.timeline().now(); }

  /// By hand.
  void enable(unsigned lift) {
    write(13436 + lift, 1);
    for (const std::uint16_t word : std::array<std::uint16_t, 3>{0x06, 0x07, 0x0F}) command(lift, word);
  }
  void command(unsigned lift, std::uint16_t word) {
    write(13428 + lift, word);
    for (int i = 0; i < 3; ++i) exchange();
  }
  void travel(unsigned lift, std::uint32_t position, std::uint32_t speed) {
    write_long(13460 + 2 * lift, position);
    write_long(13476 + 2 * lift, speed);
    exchange();
    command(lift, 0x1F);
    command(lift, 0x0F);
  }

  [[nodiscard]] std::uint16_t read(std::uint32_t address) const {
    std::uint16_t word = 0;
    (void)plant_.rack(0).read_buffer(0, address, {&word, 1}, plant_.timeline().now());
    return word;
  }
  void write(std::uint32_t address, std::uint16_t word) {
    (void)plant_.rack(0).write_buffer(0, address, {&word, 1}, plant_.timeline().now());
  }
  void write_long(std::uint32_t address, std::uint32_t value) {
    const std::array<std::uint16_t, 2> words{static_cast<std::uint16_t>(value),
                                             static_cast<std::uint16_t>(value >> 16)};
    (void)plant_.rack(0).write_buffer(0, address, words, plant_.timeline().now());
  }

 private:
  using Clock = std::chrono::milliseconds;
  static constexpr std::uint16_t up = 1, down = 2, hall = 2, car_call = 5, special = 0xE;
  enum class Step : std::uint8_t { set_up, standing, starting, travelling, opening, open, closing };
  struct Car {
    Step step = Step::set_up;
    std::uint16_t control = 0;
    std::size_t floor = 0;  // where it stands or goes to
    int direction = 0;
    std::set<std::size_t> calls{};    // car
    std::set<std::size_t> hall[2]{};  // up, down: that this car answers
    can::Time until{};
    bool wants_open = false;
  };

  void exchange() {
    if (!outputs_.empty()) {
      for (std::uint32_t i = 0; i < 3; ++i) write(13001 + i, outputs_.front()[i]);
      outputs_.pop_front();
    }
    write(20, 1);
    using namespace std::chrono_literals;
    const can::Time end = plant_.timeline().now() + 20ms;
    plant_.timeline().run_until(end);
  }
  void lamp(std::uint16_t basic, std::uint16_t sub, unsigned lifts, std::size_t floor, bool on) {
    outputs_.push_back({static_cast<std::uint16_t>(basic | sub << 8),
                        static_cast<std::uint16_t>(lifts | floor << 8),
                        static_cast<std::uint16_t>(on ? 0x8101 : 0x0001)});
  }
  [[nodiscard]] unsigned all() const { return (1U << cars_.size()) - 1; }

  void take_input() {
    const std::uint16_t code = read(12001), where = read(12002), data = read(12003);
    const std::uint16_t basic = code & 0xFF, sub = code >> 8;
    if (basic == 0 || (data >> 8 & 3) != 1) return;
    if (basic == hall && (sub == up || sub == down)) {
      const std::size_t floor = (where >> 8) - 1U;
      assign(floor, sub == up ? 0 : 1);
      lamp(hall, sub, all(), floor + 1, true);
    }
    for (unsigned lift = 0; lift < cars_.size(); ++lift) {
      if ((where >> lift & 1) == 0) continue;
      if (basic == car_call && sub >= 1 && sub <= levels_.size()) {
        cars_[lift].calls.insert(sub - 1U);
        lamp(car_call, sub, 1U << lift, 0, true);
      }
    }
  }
  void assign(std::size_t floor, int way) {
    std::size_t best = 0;
    long shortest = -1;
    for (std::size_t lift = 0; lift < cars_.size(); ++lift) {
      if (cars_[lift].hall[way].contains(floor)) return;
      const long far = std::abs(static_cast<long>(cars_[lift].floor) - static_cast<long>(floor)) +
                       2 * static_cast<long>(cars_[lift].calls.size() + cars_[lift].hall[0].size() +
                                             cars_[lift].hall[1].size());
      if (shortest >= 0 && far >= shortest) continue;
      shortest = far;
      best = lift;
    }
    cars_[best].hall[way].insert(floor);
  }
  [[nodiscard]] bool wanted(const Car& car, std::size_t floor) const {
    return car.calls.contains(floor) || car.hall[0].contains(floor) || car.hall[1].contains(floor);
  }
  /// The next floor in its direction, or behind.
  std::optional<std::size_t> next_floor(Car& car) const {
    for (int turn = 0; turn < 2; ++turn) {
      if (car.direction == 0) car.direction = 1;
      for (auto floor = static_cast<int>(car.floor) + car.direction;
           floor >= 0 && floor < static_cast<int>(levels_.size()); floor += car.direction) {
        if (wanted(car, static_cast<std::size_t>(floor))) return static_cast<std::size_t>(floor);
      }
      car.direction = -car.direction;
    }
    car.direction = 0;
    return std::nullopt;
  }
  void answered(Car& car, unsigned lift) {
    if (car.calls.erase(car.floor) != 0)
      lamp(car_call, static_cast<std::uint16_t>(car.floor + 1), 1U << lift, 0, false);
    for (std::uint16_t way = 0; way < 2; ++way) {
      if (car.hall[way].erase(car.floor) != 0)
        lamp(hall, static_cast<std::uint16_t>(way + 1), all(), car.floor + 1, false);
    }
  }
  void control(unsigned lift) {
    Car& car = cars_[lift];
    using namespace std::chrono_literals;
    const std::uint16_t status = read(12428 + lift), door = read(12050 + 4 * lift) >> 12;
    const bool blocked = read(12114 + 4 * lift) != 0x3F, overload = (read(12524 + 2 * lift) & 8) != 0;
    const can::Time now = plant_.timeline().now();
    const auto set_control = [&](std::uint16_t word) { write(13428 + lift, word); };
    const auto command_door = [&](std::uint16_t word) { write(13050 + 4 * lift, word); };
    switch (car.step) {
      case Step::set_up:
        write(13436 + lift, 1);
        set_control((status & 0x6F) == 0x21                              ? 7
                    : (status & 0x6F) == 0x23 || (status & 0x6F) == 0x27 ? 0xF
                                                                         : 6);
        if ((status & 0x6F) == 0x27 && door <= 1) car.step = Step::standing;
        break;
      case Step::standing:
        if (wanted(car, car.floor) || car.wants_open) {
          car.step = Step::opening;
        } else if (const auto next = next_floor(car)) {
          car.floor = *next;
          write_long(13460 + 2 * lift, levels_[*next]);
          write_long(13476 + 2 * lift, speed_);
          car.step = Step::starting;
        }
        break;
      case Step::starting:  // the target is exchanged
        set_control(0x1F);
        if ((status & 0x1000) != 0) {
          set_control(0x0F);
          car.step = Step::travelling;
        }
        break;
      case Step::travelling:
        if ((status & 0x1400) == 0x0400) car.step = Step::opening;
        break;
      case Step::opening:
        answered(car, lift);
        command_door(0x4FFF);
        if (door == 3 || door == 4) {
          car.step = Step::open;
          car.until = now + 3s;
        }
        break;
      case Step::open:
        answered(car, lift);
        command_door(0xFFFF);
        if (blocked || overload) car.until = now + 1500ms;
        if (now >= car.until) {
          car.step = Step::closing;
          car.until = now + 1s;
        }
        break;
      case Step::closing:
        command_door(0x1FFF);
        if (door <= 1) car.step = Step::standing;
        // Reopened, perhaps so soon that no status said it.
        if (door == 6 || ((door == 3 || door == 4) && now >= car.until) || overload ||
            car.hall[0].contains(car.floor) || car.hall[1].contains(car.floor)) {
          command_door(0xFFFF);
          car.step = Step::opening;
        }
        break;
    }
  }

  Plant& plant_;
  std::vector<std::uint32_t> levels_;
  std::uint32_t speed_;
  std::vector<Car> cars_;
  std::deque<std::array<std::uint16_t, 3>> outputs_;
};

}  // namespace canopus::plant
