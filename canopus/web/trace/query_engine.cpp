#include "canopus/web/trace/query_engine.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/text/base64.hpp"
#include "canopus/trace/file/file_format.hpp"
#include "canopus/trace/print/message_printer.hpp"
#include "canopus/trace/print/statistics_json.hpp"

namespace canopus::web {

namespace {

using trace::Message;
using trace::TraceRecord;

std::optional<std::uint64_t> number_of(const text::Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_integer()) return std::nullopt;
  if (!found->is_number_unsigned() && found->get<std::int64_t>() < 0) return std::nullopt;
  return found->get<std::uint64_t>();
}

/// Seconds, as far as plant time goes.
std::optional<can::Time> time_of(const text::Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  constexpr double latest = 9e9;  // seconds that nanoseconds of 64 bits have room for
  const double seconds = found->get<double>();
  if (!(seconds >= 0)) return can::Time{};
  return can::Time{
      std::chrono::duration_cast<can::Duration>(std::chrono::duration<double>(std::min(seconds, latest)))};
}

bool is_sdo_of(const can::Frame& frame, std::uint32_t node) {
  return !frame.extended && (frame.identifier == 0x580 + node || frame.identifier == 0x600 + node);
}

}  // namespace

TraceQueryEngine::TraceQueryEngine(Use use) : use_(std::move(use)), store_(use_.most) {}

void TraceQueryEngine::add(std::span<const TraceRecord> records) {
  for (const TraceRecord& record : records) store_.add(record);
  // Of such a one no line that is still there was read.
  std::erase_if(queries_, [&](const Query& one) { return one.rows->next_record() < store_.begin(); });
}

std::size_t TraceQueryEngine::bytes() const noexcept {
  std::size_t all = 0;
  for (const Query& one : queries_) all += one.rows->bytes();
  return all;
}

void TraceQueryEngine::forget_unasked() {
  while (queries_.back().asked + most_unasked < asked_count_) queries_.pop_back();
}

void TraceQueryEngine::keep_within_bytes() {
  while (queries_.size() > 1 && bytes() > use_.most_bytes) queries_.pop_back();
  for (std::size_t before = 0; bytes() > use_.most_bytes && bytes() != before;) {
    before = bytes();
    queries_.front().rows->forget_oldest();
  }
}

TraceQueryEngine::Answer TraceQueryEngine::answer(const text::Json& wish) {
  if (const auto record = number_of(wish, "frames")) return frames_answer(*record);
  if (wish.contains("statistics")) return statistics_answer();
  return rows_answer(wish);
}

std::expected<TraceQueryEngine::Query*, std::string> TraceQueryEngine::query(const std::string& filter,
                                                                             bool folded) {
  const auto found = std::ranges::find_if(
      queries_, [&](const Query& one) { return one.filter == filter && one.folded == folded; });
  if (found != queries_.end()) {
    std::rotate(queries_.begin(), found, std::next(found));
    return &queries_.front();
  }
  auto expression = trace::FilterExpression::parse(filter);
  if (!expression) return std::unexpected(expression.error());
  if (queries_.size() >= most_queries) queries_.pop_back();
  queries_.push_front(
      {filter, folded, std::make_unique<TraceRows>(use_.names, use_.buses, std::move(*expression), folded)});
  return &queries_.front();
}

TraceQueryEngine::Answer TraceQueryEngine::rows_answer(const text::Json& wish) {
  const bool folded = !wish.contains("fold") || wish["fold"] != false;
  const auto found = query(wish.value("filter", ""), folded);
  if (!found) return std::unexpected(found.error());
  (*found)->asked = ++asked_count_;
  forget_unasked();
  Json event{{"records", store_.end() - store_.begin()}, {"forgotten", store_.begin()}};
  TraceRows& rows = *(*found)->rows;
  do {
    rows.work(store_, slice);
    keep_within_bytes();
  } while (rows.next_record() < store_.end() && use_.has_time());
  const std::uint64_t all = store_.end() - store_.begin();
  const std::uint64_t left = store_.end() - rows.next_record();
  if (left > 0) event["progress"] = static_cast<double>(all - std::min(all, left)) / static_cast<double>(all);
  const std::uint64_t count = std::min<std::uint64_t>(number_of(wish, "count").value_or(50), most_rows);
  const std::uint64_t newest = rows.end() - std::min(count, rows.end() - rows.begin());
  std::uint64_t wanted = number_of(wish, "from").value_or(newest);
  if (const auto at = time_of(wish, "at")) {
    const std::uint64_t line = rows.first_at(*at);
    event["at"] = line;
    wanted = line - std::min(line - rows.begin(), count / 3);  // some that were before it, too
  }
  const std::uint64_t from = std::clamp(wanted, rows.begin(), newest);
  event["first"] = rows.begin();
  event["end"] = rows.end();
  event["from"] = from;
  event["rows"] = Json::array();
  for (std::uint64_t i = from; i < std::min(rows.end(), from + count); ++i) {
    event["rows"].push_back(rows.row(i, store_));
  }
  return event;
}

/// Those of the same node's SDOs before it, back to the request that began it.
TraceQueryEngine::Json TraceQueryEngine::frames_answer(std::uint64_t last) {
  Json event{{"record", last}, {"rows", Json::array()}};
  if (last < store_.begin() || last >= store_.end()) return event;
  // The duration is decoded again: the query that had it may be gone.
  const can::Frame& frame = store_.at(last).frame;
  const std::uint32_t node = frame.identifier & 0x7F;
  if (!is_sdo_of(frame, node)) return event;
  const std::uint16_t channel = store_.at(last).channel;
  std::vector<std::uint64_t> frames;
  constexpr std::size_t farthest = 200'000;
  for (std::uint64_t i = last + 1;
       i-- > store_.begin() && last - i < farthest && frames.size() < most_frames;) {
    const TraceRecord& record = store_.at(i);
    if (record.channel != channel || record.error_frame || !is_sdo_of(record.frame, node)) continue;
    frames.push_back(i);
  }
  // Which of them belong to it: the decoder reports the end of each transfer.
  trace::Decoder decoder(use_.names, {.frames = true, .transfers = true});
  std::vector<std::pair<std::uint64_t, Json>> lines;
  std::ranges::reverse(frames);
  for (const std::uint64_t number : frames) {
    bool ends = false;
    decoder.receive(store_.at(number), use_.buses[channel], [&](const Message& message) {
      if (message.is_transfer) {
        ends = true;
        return;
      }
      lines.push_back({number, Json{{"record", number},
                                    {"t", can::seconds(message.time)},
                                    {"id", fmt::format("{:03X}", message.frame.identifier)},
                                    {"data", ascii::hex_bytes(message.frame.bytes())},
                                    {"text", message.text}}});
    });
    if (ends && number != last) lines.clear();
  }
  for (auto& [number, line] : lines) event["rows"].push_back(std::move(line));
  return event;
}

TraceQueryEngine::Json TraceQueryEngine::statistics_answer() {
  if (!statistics_ || counted_ < store_.begin()) {
    // What was forgotten is in the figures no more.
    statistics_.emplace();
    statistics_decoder_ = std::make_unique<trace::Decoder>(
        use_.names, trace::DecoderOptions{.frames = true, .transfers = true});
    counted_ = store_.begin();
  }
  const auto take = [this](const Message& message) { statistics_->message(message, *statistics_decoder_); };
  for (std::size_t n = 1; counted_ < store_.end(); ++n, ++counted_) {
    if (n % slice == 0 && !use_.has_time()) break;
    const TraceRecord& record = store_.at(counted_);
    statistics_->record(record, use_.buses[record.channel]);
    statistics_decoder_->receive(record, use_.buses[record.channel], take);
  }
  trace::Statistics shown = *statistics_;
  shown.finish();
  Json event;
  const std::uint64_t all = store_.end() - store_.begin();
  if (counted_ < store_.end())
    event["progress"] = 1 - static_cast<double>(store_.end() - counted_) / static_cast<double>(all);
  event["begin"] = can::seconds(shown.begin());
  Json figures = trace::to_json(shown, 0);
  std::size_t place = 0;
  for (const auto& [number, channel] : shown.channels()) {
    Json& one = figures["channels"][place++];
    one["load"] = trace::load(channel.bits, shown.duration(), use_.bit_rates[number]);
    one["busiest_second_load"] =
        trace::load(channel.busiest_bits, std::chrono::seconds(1), use_.bit_rates[number]);
  }
  event.update(figures);
  return event;
}

TraceQueryEngine::Answer TraceQueryEngine::export_part(const text::Json& wish) {
  const auto part = number_of(wish, "part");
  if (!part) return std::unexpected("\"part\" is to be a number from 0 on");
  std::string bytes;
  if (*part == 0) {
    const std::string name = wish.value("format", "");
    const auto format = trace::format_of_name(name);
    if (!format || !trace::is_written(*format)) {
      return std::unexpected("\"format\" is to be candump, pcapng, pcap, asc, trc or csv");
    }
    auto filter = trace::FilterExpression::parse(wish.value("filter", ""));
    if (!filter) return std::unexpected(filter.error());
    export_.emplace(Export{.filter = std::move(*filter),
                           .encoder = trace::TraceEncoder(*format),
                           .decoder = std::make_unique<trace::Decoder>(
                               use_.names, trace::DecoderOptions{.frames = true, .transfers = false}),
                           .first = store_.begin(),
                           .next = store_.begin(),
                           .end = store_.end()});
    bytes = export_->encoder.begin();
  }
  if (!export_ || export_->part != *part) return std::unexpected("another export has begun; export again");
  Export& file = *export_;
  ++file.part;
  file.next = std::max(file.next, store_.begin());
  std::size_t frames = 0;
  for (std::size_t n = 0; n < part_frames && file.next < file.end; ++n, ++file.next) {
    const TraceRecord& record = store_.at(file.next);
    const std::string& bus = use_.buses[record.channel];
    bool is_wanted = file.filter.wants_all();
    if (!is_wanted) {
      file.decoder->receive(record, bus, [&](const Message& message) {
        is_wanted = is_wanted || file.filter.wants(message, bus, message.time.time_since_epoch(),
                                                   [&] { return trace::searched_text(message, bus); });
      });
    }
    if (!is_wanted) continue;
    ++frames;
    bytes += file.encoder.encode(bus, record);
  }
  const bool done = file.next >= file.end;
  if (done) bytes += file.encoder.end();
  const double all = static_cast<double>(std::max<std::uint64_t>(file.end - file.first, 1));
  Json row{{"data", text::to_base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()})},
           {"frames", frames},
           {"done", done},
           {"at", static_cast<double>(file.next - std::min(file.first, file.next)) / all}};
  if (done) export_.reset();
  return row;
}

}  // namespace canopus::web
