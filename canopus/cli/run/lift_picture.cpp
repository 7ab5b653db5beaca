#include "canopus/cli/run/lift_picture.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace canopus::cli {
namespace {

using sim::lift::LiftEvent;

constexpr double left = 70, right = 20, width = 1100, head = 26, foot = 34, floor_height = 26;
constexpr double door_height = 14;
constexpr can::Duration sampling = std::chrono::milliseconds(100);

constexpr std::string_view style = R"(<style>
text { font: 12px sans-serif; fill: #333 }
.head { font-weight: bold }
.floor { stroke: #ddd }
.axis { stroke: #999 }
.car { fill: none; stroke: #1f5fa8; stroke-width: 1.6 }
.door { fill: #f0a030; stroke: none }
.hall { stroke: #2a8a3e; stroke-width: 1.2 }
.hallcall { fill: #2a8a3e }
.carcall { stroke: #a33a8a; stroke-width: 1.2; stroke-dasharray: 4 3 }
.carmark { fill: #a33a8a }
.fault { stroke: #c22; stroke-width: 1; stroke-dasharray: 2 2 }
.faulttext { fill: #c22 }
</style>
)";

double x_of(can::Time time, can::Time end) {
  const double whole = std::max(1e-9, can::seconds(end));
  return left + (width - left - right) * can::seconds(time) / whole;
}

/// "0", "30 s", "2 min".
std::string tick_name(double seconds) {
  if (seconds < 60 || static_cast<long>(seconds) % 60 != 0) return fmt::format("{:g} s", seconds);
  return fmt::format("{:g} min", seconds / 60);
}

double tick_step(double seconds) {
  static constexpr double steps[] = {1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600};
  for (const double step : steps) {
    if (seconds / step <= 12) return step;
  }
  return 7200 * std::max(1.0, static_cast<double>(static_cast<long>(seconds / 7200 / 12) + 1));
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '&') {
      result += "&amp;";
    } else {
      result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return result;
}

bool is_mark(LiftEvent::Kind kind) {
  using enum LiftEvent::Kind;
  return kind == fault_began || kind == fault_ended || kind == door_open_between_floors ||
         kind == door_open_while_moving || kind == overload_travel || kind == overspeed;
}

}  // namespace

LiftPicture::LiftPicture(plant::LiftOnBus& seat)
    : seat_(&seat), samples_(seat.building().settings().lifts.size()) {
  for (std::size_t car = 0; car < samples_.size(); ++car) {
    samples_[car].push_back({{}, static_cast<float>(seat.building().car(car, {}).position), 0});
  }
  seat.set_listener(this);
}

void LiftPicture::lift_event(const LiftEvent& event) {
  if (event.kind == LiftEvent::Kind::call_registered) {
    calls_.push_back(
        {.from = event.time, .floor = event.floor, .direction = event.direction, .lift = event.lift});
  } else if (event.kind == LiftEvent::Kind::call_answered) {
    const auto call = std::ranges::find_if(calls_.rbegin(), calls_.rend(), [&](const Call& one) {
      return one.until == can::never && one.floor == event.floor && one.direction == event.direction &&
             one.lift == event.lift;
    });
    if (call != calls_.rend()) call->until = event.time;
  } else if (is_mark(event.kind)) {
    std::string text = sim::lift::name(event.kind);
    if (event.kind == LiftEvent::Kind::fault_began) text = sim::lift::name(event.fault);
    if (event.kind == LiftEvent::Kind::fault_ended) text.clear();
    marks_.push_back({event.time, event.lift, std::move(text)});
  }
}

void LiftPicture::car_moved(std::uint8_t lift, double position, double door, can::Time now) {
  const auto& lifts = seat_->building().settings().lifts;
  std::vector<Sample>& samples =
      samples_[static_cast<std::size_t>(std::ranges::find(lifts, lift) - lifts.begin())];
  const Sample sample{now, static_cast<float>(position), static_cast<float>(door)};
  // The last one of two that are close gives way; one after a rest begins where the rest was.
  if (samples.size() > 1 && now - samples[samples.size() - 2].time < sampling) {
    samples.back() = sample;
    return;
  }
  if (now - samples.back().time > 2 * sampling)
    samples.push_back({now - sampling, samples.back().position, samples.back().door});
  samples.push_back(sample);
}

double LiftPicture::strip_height() const {
  return floor_height * static_cast<double>(seat_->building().settings().floors.size());
}

double LiftPicture::height() const {
  return (head + strip_height() + foot) * static_cast<double>(samples_.size());
}

double LiftPicture::level(double position) const {
  const auto& floors = seat_->building().settings().floors;
  const double share = (position - floors.front()) / (floors.back() - floors.front());
  return head + strip_height() - floor_height / 2 - share * (strip_height() - floor_height);
}

std::string LiftPicture::draw_car(std::size_t car, double top, can::Time end) const {
  const sim::lift::BuildingSettings& settings = seat_->building().settings();
  const std::uint8_t lift = settings.lifts[car];
  std::string svg = fmt::format("<text class=\"head\" x=\"{}\" y=\"{:.1f}\">{} lift {}</text>\n", left,
                                top + 16, escaped(seat_->bus()), lift);
  for (std::size_t floor = 0; floor < settings.floors.size(); ++floor) {
    const double y = top + level(settings.floors[floor]);
    svg += fmt::format("<line class=\"floor\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", left,
                       width - right, y, y);
    svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", left - 8, y + 4,
                       floor + 1);
  }
  const double bottom = top + head + strip_height();
  const double seconds = can::seconds(end), step = tick_step(seconds);
  svg += fmt::format("<line class=\"axis\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>\n", left,
                     width - right, bottom, bottom);
  for (double tick = 0; tick <= seconds; tick += step) {
    const double x = left + (width - left - right) * tick / std::max(1e-9, seconds);
    svg += fmt::format("<line class=\"axis\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", x, x,
                       bottom, bottom + 4);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", x, bottom + 17,
                       tick_name(tick));
  }
  for (const Call& call : calls_) {
    if (call.lift != 0 && call.lift != lift) continue;
    const double y = top + level(settings.floors[call.floor - 1U]);
    const double from = x_of(call.from, end), until = x_of(std::min(call.until, end), end);
    const bool hall = call.lift == 0;
    const double shift = !hall ? 0 : call.direction == 1 ? -4 : 4;
    svg += fmt::format("<line class=\"{}\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                       hall ? "hall" : "carcall", from, until, y + shift, y + shift);
    if (hall) {
      svg += fmt::format("<path class=\"hallcall\" d=\"M{:.1f} {:.1f}l4 {}h-8z\"/>\n", from,
                         y + 2 * shift + shift / 2, -1.5 * shift);
    } else {
      svg += fmt::format("<circle class=\"carmark\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\"/>\n", from, y);
    }
  }
  const std::vector<Sample>& samples = samples_[car];
  std::string line, door;
  bool is_open = false;
  double base = 0;
  for (const Sample& sample : samples) {
    const double x = x_of(sample.time, end), y = top + level(sample.position);
    line += fmt::format("{:.1f},{:.1f} ", x, y);
    if (sample.door > 0 && !is_open)
      door += fmt::format("<path class=\"door\" d=\"M{:.1f} {:.1f}", x, base = y);
    if (sample.door > 0 || is_open)
      door += fmt::format("L{:.1f} {:.1f}", x, base - door_height * sample.door / settings.door.width);
    if (sample.door <= 0 && is_open) door += "z\"/>\n";
    is_open = sample.door > 0;
  }
  const Sample& last = samples.back();
  if (is_open) {
    door += fmt::format("L{:.1f} {:.1f}L{:.1f} {:.1f}z\"/>\n", x_of(end, end),
                        base - door_height * last.door / settings.door.width, x_of(end, end), base);
  }
  line += fmt::format("{:.1f},{:.1f}", x_of(end, end), top + level(last.position));
  svg += door + fmt::format("<polyline class=\"car\" points=\"{}\"/>\n", line);
  for (const Mark& mark : marks_) {
    if (mark.lift != 0 && mark.lift != lift) continue;
    const double x = x_of(mark.time, end);
    svg += fmt::format("<line class=\"fault\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", x,
                       x, top + head, bottom);
    svg += fmt::format("<text class=\"faulttext\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + 3,
                       top + head + 4, mark.text);
  }
  return svg;
}

std::string LiftPicture::draw(double top, can::Time end) const {
  std::string svg;
  for (std::size_t car = 0; car < samples_.size(); ++car) {
    svg += draw_car(car, top + static_cast<double>(car) * (head + strip_height() + foot), end);
  }
  return svg;
}

std::expected<std::unique_ptr<LiftPictureFile>, std::string> LiftPictureFile::open(const std::string& path,
                                                                                   plant::Plant& plant) {
  if (plant.lift_count() == 0) return std::unexpected("--svg: the plant has no [[lift]] to be drawn");
  std::unique_ptr<LiftPictureFile> picture(new LiftPictureFile);
  picture->path_ = path;
  picture->title_ = plant.name();
  picture->file_ = std::fopen(path.c_str(), "wb");
  if (picture->file_ == nullptr)
    return std::unexpected(fmt::format("cannot write {}: {}", path, std::strerror(errno)));
  for (std::size_t i = 0; i < plant.lift_count(); ++i) {
    picture->pictures_.push_back(std::make_unique<LiftPicture>(plant.lift(i)));
  }
  return picture;
}

LiftPictureFile::~LiftPictureFile() {
  if (file_ != nullptr) (void)std::fclose(file_);
}

std::string LiftPictureFile::close(can::Time end) {
  constexpr double legend = 30;
  double height = legend;
  for (const auto& picture : pictures_) height += picture->height();
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1:.0f}\" width=\"{0}\" "
      "height=\"{1:.0f}\" role=\"img\">\n"
      "<title>{2}</title>\n{3}<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      width, height, escaped(title_.empty() ? "lifts" : title_), style);
  svg +=
      "<path class=\"car\" d=\"M70 16h24\"/><text x=\"100\" y=\"20\">car</text>"
      "<path class=\"door\" d=\"M150 21h24v-10h-24z\"/><text x=\"180\" y=\"20\">door open</text>"
      "<path class=\"hall\" d=\"M270 16h24\"/><path class=\"hallcall\" d=\"M270 10l4 6h-8z\"/><text "
      "x=\"300\" y=\"20\">hall "
      "call until answered</text>"
      "<path class=\"carcall\" d=\"M450 16h24\"/><circle class=\"carmark\" cx=\"450\" cy=\"16\" "
      "r=\"2.5\"/><text x=\"480\" "
      "y=\"20\">car call until answered</text>\n";
  double top = legend;
  for (const auto& picture : pictures_) {
    svg += picture->draw(top, end);
    top += picture->height();
  }
  svg += "</svg>\n";
  const bool written = std::fwrite(svg.data(), 1, svg.size(), file_) == svg.size();
  const bool closed = std::fclose(std::exchange(file_, nullptr)) == 0;
  return written && closed ? std::string() : fmt::format("cannot write {}: {}", path_, std::strerror(errno));
}

}  // namespace canopus::cli
