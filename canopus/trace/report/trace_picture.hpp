#pragma once
// A trace as a picture: load of the bus, values of PDOs, states of the nodes, over time. SVG that needs
// nothing else.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/trace/decode/message.hpp"

namespace canopus::trace {

/// A value over time that a person asked for, or the first ones of the trace.
struct PictureSignal {
  std::uint8_t node = 0;
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  friend bool operator==(const PictureSignal&, const PictureSignal&) = default;
};

struct PictureOptions {
  std::uint32_t bit_rate = 0;            ///< bit/s; 0: the load is drawn in kbit/s
  std::vector<PictureSignal> signals{};  ///< empty: the first `most_signals` that come
  static constexpr std::size_t most_signals = 8;
};

class TracePicture {
 public:
  explicit TracePicture(PictureOptions options) : options_(std::move(options)) {}

  /// Every message of the decoder but folded transfers and copies.
  void message(const Message& message);
  /// The picture. `title`: any text.
  [[nodiscard]] std::string svg(std::string_view title) const;
  /// Signals that were asked for and never came.
  [[nodiscard]] std::vector<PictureSignal> missing() const;

 private:
  struct Point {
    double time = 0;  // s
    double value = 0;
  };
  /// Values in the order of time; of many, the extremes of equal pieces of time.
  struct Curve {
    PictureSignal signal;
    std::string name;
    std::vector<Point> points;
    void add(Point point);
    void thin_out();
  };
  struct StateChange {
    double time = 0;
    std::string_view state;
  };
  struct NodeStates {
    std::string name;
    std::vector<StateChange> changes;
    std::vector<double> emergencies;
  };
  void add_signals(const Message& message, double time);
  void add_state(const Message& message, double time);
  void set_state(NodeStates& node, double time, std::string_view state);
  void add_load(const Message& message, double time);

  [[nodiscard]] std::string draw_load(double top) const;
  [[nodiscard]] std::string draw_curve(const Curve& curve, double top) const;
  [[nodiscard]] std::string draw_states(double top) const;
  [[nodiscard]] std::string draw_time_axis(double top) const;
  [[nodiscard]] double x_of(double time) const;

  PictureOptions options_;
  std::optional<can::Time> begin_;
  double end_ = 0;
  double load_step_ = 0.01;        // s
  std::vector<double> load_bits_;  // of each step
  std::vector<Curve> curves_;
  std::map<std::uint32_t, NodeStates> states_;  // channel, node
};

}  // namespace canopus::trace
