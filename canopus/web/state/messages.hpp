#pragma once
// The frames of a plant's buses for its page, decoded as `canopus monitor` does. Nothing is kept as long as no client wants them,
// and of what comes between two looks only the newest: decoding must not delay the plant.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/trace/decode/decoder.hpp"

namespace canopus::web {

class WebMessages {
 public:
  static constexpr std::size_t most_frames = 250;  ///< between two calls

  /// The plant, which must not have been switched on, must outlive this.
  explicit WebMessages(plant::Plant& plant);
  ~WebMessages();
  WebMessages(const WebMessages&) = delete;
  WebMessages& operator=(const WebMessages&) = delete;

  /// Of the plant's nodes.
  [[nodiscard]] const trace::Names& names() const noexcept { return decoder_.names(); }
  /// The `messages` event (docs/events.md) of what came since the last look, as JSON; empty when nothing came, and at the first
  /// look. `wanted`: a client wants them; false ends it.
  [[nodiscard]] std::string new_messages(bool wanted);

 private:
  class Tap final : public can::BusObserver {
   public:
    Tap(WebMessages& messages, std::uint16_t bus) : messages_(messages), bus_(bus) {}
    void frame_completed(const can::Frame& frame, can::Time start, can::Time end) override;

   private:
    WebMessages& messages_;
    std::uint16_t bus_;
  };

  plant::Plant& plant_;
  trace::Decoder decoder_;
  std::vector<std::unique_ptr<Tap>> taps_;
  bool is_wanted_ = false;
  std::deque<trace::TraceRecord> frames_;
  std::uint64_t left_out_ = 0;
};

}  // namespace canopus::web
