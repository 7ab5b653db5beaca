#pragma once
// A picture of a run's lifts: the position of each car, its open doors, the calls and the times of their
// answers. A self-contained SVG file.

#include <cstdint>
#include <cstdio>
#include <expected>
#include <memory>
#include <string>
#include <vector>

#include "canopus/plant/lift_on_bus.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::cli {

/// One group of lifts.
class LiftPicture final : public sim::lift::LiftObserver {
 public:
  /// Registers itself as the listener of `seat`, which must outlive it.
  explicit LiftPicture(plant::LiftOnBus& seat);

  void lift_event(const sim::lift::LiftEvent& event) override;
  void car_moved(std::uint8_t lift, double position, double door, can::Time now) override;

  /// Height in pixels that draw() takes.
  [[nodiscard]] double height() const;
  /// SVG elements from `top` down, for the time up to `end`.
  [[nodiscard]] std::string draw(double top, can::Time end) const;

 private:
  struct Sample {
    can::Time time;
    float position = 0;  // mm
    float door = 0;      // mm
  };
  struct Call {
    can::Time from;
    can::Time until = can::never;
    std::uint8_t floor = 0;
    std::uint8_t direction = 0;
    std::uint8_t lift = 0;  // 0: hall
  };
  struct Mark {
    can::Time time;
    std::uint8_t lift = 0;
    std::string text;
  };
  [[nodiscard]] std::string draw_car(std::size_t car, double top, can::Time end) const;
  [[nodiscard]] double level(double position) const;  // pixels below the top of a strip
  [[nodiscard]] double strip_height() const;

  plant::LiftOnBus* seat_;
  std::vector<std::vector<Sample>> samples_;  // of each car
  std::vector<Call> calls_;
  std::vector<Mark> marks_;
};

/// The pictures of all lifts of a plant in one file, which is written at the end.
class LiftPictureFile {
 public:
  /// The error is a sentence: it cannot be written, or the plant has no lift.
  [[nodiscard]] static std::expected<std::unique_ptr<LiftPictureFile>, std::string> open(
      const std::string& path, plant::Plant& plant);
  ~LiftPictureFile();
  LiftPictureFile(const LiftPictureFile&) = delete;
  LiftPictureFile& operator=(const LiftPictureFile&) = delete;

  /// Empty, or what went wrong.
  [[nodiscard]] std::string close(can::Time end);

 private:
  LiftPictureFile() = default;
  std::string path_;
  std::string title_;
  std::FILE* file_ = nullptr;
  std::vector<std::unique_ptr<LiftPicture>> pictures_;
};

}  // namespace canopus::cli
