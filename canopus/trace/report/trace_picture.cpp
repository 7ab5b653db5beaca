#include "canopus/trace/report/trace_picture.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/trace/report/names_of_others.hpp"

namespace canopus::trace {
namespace {

constexpr double left = 140, right = 24, width = 1100, head = 26, foot = 16, strip = 110, state_height = 22;
constexpr std::size_t most_points = 4000;
constexpr std::size_t most_steps = 2000;
constexpr std::size_t most_changes = 20'000;

constexpr std::string_view style = R"(<style>
text { font: 12px sans-serif; fill: #333 }
.title { font: bold 14px sans-serif }
.head { font-weight: bold }
.grid { stroke: #e2e2e2 }
.axis { stroke: #999; fill: none }
.curve { fill: none; stroke: #1f5fa8; stroke-width: 1.4 }
.load { fill: #9cc3ea; stroke: #1f5fa8; stroke-width: 0.8 }
.operational { fill: #4ca964 }
.pre-operational { fill: #e9b949 }
.stopped { fill: #b0b0b0 }
.initialising { fill: #7a6fc0 }
.emcy { stroke: #c22; stroke-width: 2 }
</style>
)";

/// A round number of which at most `pieces` fit into the span.
double round_step(double span, double pieces) {
  const double least = std::max(span, 1e-12) / pieces;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

/// "0.25", "1200": without the noise of binary fractions.
std::string number_text(double value) {
  if (std::abs(value) < 1e-9) value = 0;
  return fmt::format("{:.6g}", value);
}

std::string text_at(double x, double y, std::string_view text, std::string_view more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", x, y, more, xml_text(text));
}

/// The frame of a strip with its title.
std::string strip_frame(double top, std::string_view title) {
  return text_at(left, top + 16, title, " class=\"head\"") +
         fmt::format("<path class=\"axis\" d=\"M{0},{1:.1f}V{2:.1f}H{3}\"/>\n", left, top + head,
                     top + head + strip, width - right);
}

struct Scale {
  double low = 0, high = 1, step = 1;
  [[nodiscard]] double y(double value, double top) const {
    return top + head + strip * (1 - (value - low) / (high - low));
  }
};

Scale scale_of(double low, double high) {
  if (!(high > low)) {
    const double around = std::max(1.0, std::abs(low) * 0.1);
    low -= around;
    high += around;
  }
  Scale scale;
  scale.step = round_step(high - low, 5);
  scale.low = std::floor(low / scale.step) * scale.step;
  scale.high = std::ceil(high / scale.step) * scale.step;
  return scale;
}

std::string value_axis(const Scale& scale, double top) {
  std::string svg;
  const auto count = static_cast<int>(std::lround((scale.high - scale.low) / scale.step));
  for (int i = 0; i <= std::min(count, 12); ++i) {
    const double value = scale.low + i * scale.step;
    const double y = scale.y(value, top);
    svg += fmt::format("<line class=\"grid\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", left,
                       width - right, y, y);
    svg += text_at(left - 6, y + 4, number_text(value), " text-anchor=\"end\"");
  }
  return svg;
}

std::string_view state_after(std::string_view command) {
  if (command == "start") return "operational";
  if (command == "stop") return "stopped";
  if (command == "enter pre-operational") return "pre-operational";
  return "initialising";
}

}  // namespace

void TracePicture::Curve::add(Point point) {
  points.push_back(point);
  if (points.size() > 2 * most_points) thin_out();
}

void TracePicture::Curve::thin_out() {
  // Of every four points in a row the first, the last and the extremes show the curve.
  std::vector<Point> kept;
  for (std::size_t i = 0; i < points.size(); i += 4) {
    const auto begin = points.begin() + static_cast<std::ptrdiff_t>(i);
    const auto end = points.begin() + static_cast<std::ptrdiff_t>(std::min(i + 4, points.size()));
    auto [low, high] = std::minmax_element(begin, end, [](Point a, Point b) { return a.value < b.value; });
    if (high < low) std::swap(low, high);
    kept.push_back(*low);
    if (high != low) kept.push_back(*high);
  }
  points = std::move(kept);
}

void TracePicture::message(const Message& message) {
  if (message.is_transfer || message.is_copy) return;
  if (!begin_) begin_ = message.time;
  const double time = std::chrono::duration<double>(message.time - *begin_).count();
  if (time < 0) return;  // of a channel whose clock is another's
  end_ = std::max(end_, time);
  if (message.service != Service::error_frame) add_load(message, time);
  add_signals(message, time);
  add_state(message, time);
}

void TracePicture::add_load(const Message& message, double time) {
  while (time / load_step_ >= static_cast<double>(most_steps)) {  // half as many, twice as long
    for (std::size_t i = 0; 2 * i < load_bits_.size(); ++i) {
      load_bits_[i] = load_bits_[2 * i] + (2 * i + 1 < load_bits_.size() ? load_bits_[2 * i + 1] : 0);
    }
    load_bits_.resize((load_bits_.size() + 1) / 2);
    load_step_ *= 2;
  }
  const auto step = static_cast<std::size_t>(time / load_step_);
  if (load_bits_.size() <= step) load_bits_.resize(step + 1);
  load_bits_[step] += can::frame_bits(message.frame) + can::intermission_bits;
}

void TracePicture::add_signals(const Message& message, double time) {
  for (const Signal& signal : message.signals) {
    if (!signal.number || !std::isfinite(*signal.number)) continue;
    const PictureSignal key{message.node, signal.index, signal.sub};
    const auto same = [&](const Signal& other) {
      return other.index == signal.index && other.sub == signal.sub;
    };
    if (&*std::ranges::find_if(message.signals, same) != &signal)
      continue;  // mapped twice: the first one counts
    auto curve = std::ranges::find(curves_, key, &Curve::signal);
    if (curve == curves_.end()) {
      const bool wanted = options_.signals.empty()
                              ? curves_.size() < PictureOptions::most_signals
                              : std::ranges::find(options_.signals, key) != options_.signals.end();
      if (!wanted) continue;
      std::string name =
          fmt::format("node {} {}", node_text(message), canopen::object_text(signal.index, signal.sub));
      if (!signal.name.empty()) name += " " + signal.name;
      curves_.push_back({key, std::move(name), {}});
      curve = curves_.end() - 1;
    }
    curve->add({time, *signal.number});
  }
}

void TracePicture::set_state(NodeStates& node, double time, std::string_view state) {
  if (node.changes.size() >= most_changes) return;
  if (node.changes.empty() || node.changes.back().state != state) node.changes.push_back({time, state});
}

void TracePicture::add_state(const Message& message, double time) {
  const std::uint32_t channel = std::uint32_t{message.channel} << 8;
  if (message.service == Service::nmt && !message.text.starts_with("unknown") &&
      message.kind != "malformed") {
    for (auto& [key, node] : states_) {
      const bool addressed =
          (key & ~0xFFU) == channel && (message.node == 0 || (key & 0xFFU) == message.node);
      if (addressed) set_state(node, time, state_after(message.kind));
    }
    return;
  }
  if (message.node == 0) return;
  if (message.service == Service::emcy && message.emcy_code.value_or(0) != 0) {
    NodeStates& node = states_[channel | message.node];
    if (node.emergencies.size() < most_changes) node.emergencies.push_back(time);
    if (!message.node_name.empty()) node.name = message.node_name;
  }
  if (message.service != Service::error_control || message.frame.remote || message.data.size() != 1) return;
  NodeStates& node = states_[channel | message.node];
  if (!message.node_name.empty()) node.name = message.node_name;
  switch (message.data[0] & 0x7FU) {
    case 0x00:  // a boot-up message: initialisation is over
    case 0x7F: return set_state(node, time, "pre-operational");
    case 0x04: return set_state(node, time, "stopped");
    case 0x05: return set_state(node, time, "operational");
    default: return;
  }
}

std::vector<PictureSignal> TracePicture::missing() const {
  std::vector<PictureSignal> missing;
  for (const PictureSignal& signal : options_.signals) {
    if (std::ranges::find(curves_, signal, &Curve::signal) == curves_.end()) missing.push_back(signal);
  }
  return missing;
}

double TracePicture::x_of(double time) const {
  return left + (width - left - right) * time / std::max(end_, 1e-9);
}

std::string TracePicture::draw_load(double top) const {
  // Steps that are wide enough to be seen, and long against a frame.
  constexpr std::size_t most_drawn = 240;
  const std::size_t together = (load_bits_.size() + most_drawn - 1) / most_drawn;
  std::vector<double> rates;
  const double scale_factor = options_.bit_rate != 0 ? 100.0 / options_.bit_rate : 1e-3;
  for (std::size_t i = 0; i < load_bits_.size(); i += together) {
    double bits = 0;
    for (std::size_t k = i; k < std::min(i + together, load_bits_.size()); ++k) bits += load_bits_[k];
    rates.push_back(bits / (load_step_ * static_cast<double>(together)) * scale_factor);
  }
  const Scale scale = scale_of(0, rates.empty() ? 1 : std::max(std::ranges::max(rates), 1e-3));
  std::string svg = strip_frame(top, options_.bit_rate != 0
                                         ? fmt::format("load of the bus, % of {} bit/s", options_.bit_rate)
                                         : std::string("load of the bus, kbit/s"));
  svg += value_axis(scale, top);
  svg += fmt::format("<path class=\"load\" d=\"M{:.1f},{:.1f}", left, scale.y(0, top));
  for (std::size_t i = 0; i < rates.size(); ++i) {
    const double step = load_step_ * static_cast<double>(together);
    // The last step ends with the trace.
    svg += fmt::format("V{:.1f}H{:.1f}", scale.y(rates[i], top),
                       x_of(std::min(static_cast<double>(i + 1) * step, end_)));
  }
  return svg + fmt::format("V{:.1f}Z\"/>\n", scale.y(0, top));
}

std::string TracePicture::draw_curve(const Curve& curve, double top) const {
  const auto [low, high] = std::minmax_element(curve.points.begin(), curve.points.end(),
                                               [](Point a, Point b) { return a.value < b.value; });
  const Scale scale = scale_of(low->value, high->value);
  std::string svg = strip_frame(top, curve.name) + value_axis(scale, top);
  svg += fmt::format("<path class=\"curve\" d=\"M{:.1f},{:.1f}", x_of(curve.points.front().time),
                     scale.y(curve.points.front().value, top));
  for (const Point& point : curve.points) {  // a value holds until the next one comes
    svg += fmt::format("H{:.1f}V{:.1f}", x_of(point.time), scale.y(point.value, top));
  }
  return svg + fmt::format("H{:.1f}\"/>\n", x_of(end_));
}

std::string TracePicture::draw_states(double top) const {
  std::string svg = text_at(left, top + 16, "states of the nodes", " class=\"head\"");
  double x = left + 160;
  for (const std::string_view state : {"initialising", "pre-operational", "operational", "stopped"}) {
    svg += fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"12\" height=\"12\"/>", state, x,
                       top + 6);
    svg += text_at(x + 17, top + 16, state);
    x += 130;
  }
  svg += fmt::format("<line class=\"emcy\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>",
                     x + 6, top + 4, top + 20);
  svg += text_at(x + 17, top + 16, "EMCY");
  double y = top + head;
  for (const auto& [key, node] : states_) {
    const std::string name = node.name.empty() ? fmt::format("node {}", key & 0xFFU)
                                               : fmt::format("{} {}", key & 0xFFU, node.name);
    svg += text_at(left - 6, y + 14, clipped_text(name, 16), " text-anchor=\"end\"");
    for (std::size_t i = 0; i < node.changes.size(); ++i) {
      const double from = x_of(node.changes[i].time);
      const double to = i + 1 < node.changes.size() ? x_of(node.changes[i + 1].time) : x_of(end_);
      svg += fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{}\"/>",
                         node.changes[i].state, from, y + 2, std::max(to - from, 0.5), state_height - 6);
    }
    for (const double time : node.emergencies) {
      svg += fmt::format("<line class=\"emcy\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>",
                         x_of(time), y, y + state_height - 2);
    }
    svg += '\n';
    y += state_height;
  }
  return svg;
}

std::string TracePicture::draw_time_axis(double top) const {
  std::string svg = fmt::format("<path class=\"axis\" d=\"M{},{:.1f}H{}\"/>", left, top, width - right);
  const double step = round_step(std::max(end_, 1e-9), 12);
  for (int i = 0; i <= 12 && i * step <= end_ * (1 + 1e-9); ++i) {
    const double x = x_of(i * step);
    svg += fmt::format("<path class=\"axis\" d=\"M{:.1f},{:.1f}v5\"/>", x, top);
    svg += text_at(x, top + 19, number_text(i * step) + " s", " text-anchor=\"middle\"");
  }
  return svg;
}

std::string TracePicture::svg(std::string_view title) const {
  std::string body = text_at(left, 22, title, " class=\"title\"");
  double top = 34;
  body += draw_load(top);
  top += head + strip + foot;
  for (const Curve& curve : curves_) {
    body += draw_curve(curve, top);
    top += head + strip + foot;
  }
  if (!states_.empty()) {
    body += draw_states(top);
    top += head + state_height * static_cast<double>(states_.size()) + foot;
  }
  body += draw_time_axis(top);
  top += 34;
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1:.0f}\" viewBox=\"0 0 {0} "
             "{1:.0f}\">\n"
             "<title>{2}</title>\n",
             width, top, xml_text(title)) +
         std::string(style) +
         fmt::format("<rect width=\"{}\" height=\"{:.0f}\" fill=\"white\"/>\n", width, top) + body +
         "</svg>\n";
}

}  // namespace canopus::trace
