// Any bytes as frames, and as what the page wants to see of the trace: no crash, no run without end, what is refused has a sentence, and
// lines stay within what there is.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "canopus/text/json.hpp"
#include "canopus/web/trace/query_engine.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus;
  if (size < 1) return 0;
  const std::size_t frames = std::min<std::size_t>(data[0], (size - 1) / 11);
  web::TraceQueryEngine engine(
      {.names = {}, .buses = {"a", "b"}, .bit_rates = {500'000, 125'000}, .most = 64});
  const std::uint8_t* at = data + 1;
  for (std::size_t i = 0; i < frames; ++i, at += 11) {
    trace::TraceRecord record{.time = can::Time{} + std::chrono::milliseconds(i),
                              .channel = static_cast<std::uint16_t>(at[0] & 1U),
                              .error_frame = (at[0] & 0x06U) == 0x06U,
                              .frame = {.identifier = (at[1] | at[2] << 8U) & can::max_base_identifier,
                                        .remote = (at[0] & 0x08U) != 0,
                                        .dlc = static_cast<std::uint8_t>(at[0] >> 4U)}};
    for (std::size_t byte = 0; byte < record.frame.length(); ++byte) record.frame.data[byte] = at[3 + byte];
    engine.add({&record, 1});
  }
  const std::string_view text(reinterpret_cast<const char*>(at), size - static_cast<std::size_t>(at - data));
  auto wish = text::parse_json(text).value_or(text::Json());
  if (!wish.is_object()) wish = {{"filter", text}, {"fold", (data[0] & 1U) != 0}};
  const auto answer = engine.answer(wish);
  if (!answer && answer.error().empty()) std::abort();
  if (answer && answer->contains("end") &&
      (*answer)["first"].get<std::uint64_t>() > (*answer)["end"].get<std::uint64_t>()) {
    std::abort();
  }
  if (answer) (void)answer->dump();
  wish["part"] = 0;
  if (!wish.contains("format")) wish["format"] = "candump";
  const auto part = engine.export_part(wish);
  if (!part && part.error().empty()) std::abort();
  (void)engine.answer({{"frames", data[0]}});
  return 0;
}
