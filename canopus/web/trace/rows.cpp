#include "canopus/web/trace/rows.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/text/json.hpp"
#include "canopus/trace/print/message_printer.hpp"

namespace canopus::web {

namespace {

using trace::Message;
using trace::Service;

constexpr std::size_t bytes_of_node = 48;  // of a std::set, with what the heap takes

bool is_trouble_of(const Message& message) {
  return message.service == Service::error_frame || message.service == Service::emcy || message.abort_code ||
         (message.is_transfer && message.end != trace::TransferEnd::done);
}

}  // namespace

TraceRows::TraceRows(const trace::Names& names, const std::vector<std::string>& buses,
                     trace::FilterExpression filter, bool folded)
    : buses_(buses), filter_(std::move(filter)), decoder_(names, {.frames = !folded, .transfers = folded}) {}

void TraceRows::work(const TraceStore& store, std::size_t count) {
  forget(store.begin());
  next_ = std::max(next_, store.begin());
  for (; count > 0 && next_ < store.end(); --count, ++next_) {
    const trace::TraceRecord& record = store.at(next_);
    decoder_.receive(record, buses_[record.channel], [this](const Message& message) { add(message, next_); });
  }
}

void TraceRows::add(const Message& message, std::uint64_t record) {
  const std::string& bus = buses_[message.channel];
  const Head head{.bus = message.channel,
                  .service = message.service,
                  .what = trace::service_text(message),
                  .node = message.node,
                  .node_name = message.node_name,
                  .object = trace::object_text(message)};
  const auto line = [&] { return trace::searched_text(message, bus); };
  if (!filter_.wants_all() && !filter_.wants(message, bus, message.time.time_since_epoch(), line)) return;
  Block& last = block_for_next();
  const auto [shared, is_new] = last.heads.insert(head);
  if (is_new)
    last.head_bytes +=
        bytes_of_node + sizeof(Head) + head.what.size() + head.node_name.size() + head.object.size();
  if (message.is_transfer) {
    last.transfers.push_back({.place = static_cast<std::uint32_t>(last.rows.size()),
                              .frames = message.frames,
                              .duration = message.duration});
  }
  last.rows.push_back({.record = record,
                       .head = &*shared,
                       .time = message.time,
                       .text = static_cast<std::uint32_t>(last.texts.size()),
                       .identifier = message.frame.identifier & can::max_extended_identifier,
                       .is_extended = message.frame.extended,
                       .is_trouble = is_trouble_of(message),
                       .is_transfer = message.is_transfer});
  last.texts += message.text;
  bytes_of_last_ = last.bytes();
  ++end_;
}

/// What many lines have in common is kept by block, and goes with it: nothing grows with all that was ever seen.
std::size_t TraceRows::Block::bytes() const noexcept {
  return rows.capacity() * sizeof(Row) + transfers.capacity() * sizeof(Transfer) + texts.capacity() +
         head_bytes;
}

TraceRows::Block& TraceRows::block_for_next() {
  if (!blocks_.empty() && blocks_.back().rows.size() < block) return blocks_.back();
  if (!blocks_.empty()) {
    Block& full = blocks_.back();
    full.texts.shrink_to_fit();
    full.transfers.shrink_to_fit();
    bytes_ += full.bytes();
  }
  blocks_.emplace_back().rows.reserve(block);
  return blocks_.back();
}

void TraceRows::forget(std::uint64_t first_record) {
  while (!blocks_.empty() && blocks_.front().rows.size() == block &&
         blocks_.front().rows.back().record < first_record) {
    if (blocks_.size() > 1) {
      forget_oldest();
    } else {
      bytes_of_last_ = 0;
      blocks_.pop_front();
      begin_ += block;
    }
  }
}

void TraceRows::forget_oldest() {
  if (blocks_.size() < 2) return;
  bytes_ -= blocks_.front().bytes();
  blocks_.pop_front();
  begin_ += block;
}

std::uint64_t TraceRows::first_at(can::Time time) const noexcept {
  const auto part = std::ranges::find_if(
      blocks_, [&](const Block& one) { return !one.rows.empty() && one.rows.back().time >= time; });
  if (part == blocks_.end()) return end_;
  const auto row = std::ranges::lower_bound(part->rows, time, {}, &Row::time);
  return begin_ + static_cast<std::uint64_t>(part - blocks_.begin()) * block +
         static_cast<std::uint64_t>(row - part->rows.begin());
}

text::Json TraceRows::row(std::uint64_t number, const TraceStore& store) const {
  const Block& part = blocks_[(number - begin_) / block];
  const std::size_t place = (number - begin_) % block;
  const Row& row = part.rows[place];
  const std::size_t end = place + 1 < part.rows.size() ? part.rows[place + 1].text : part.texts.size();
  text::Json json{{"n", number},
                  {"record", row.record},
                  {"t", can::seconds(row.time)},
                  {"bus", buses_[row.head->bus]},
                  {"id", fmt::format("{:0{}X}", row.identifier, row.is_extended != 0 ? 8 : 3)},
                  {"service", trace::name(row.head->service)},
                  {"what", row.head->what}};
  if (row.head->node != 0 || row.head->service == Service::nmt) json["node"] = row.head->node;
  if (!row.head->node_name.empty()) json["name"] = row.head->node_name;
  if (!row.head->object.empty()) json["object"] = row.head->object;
  json["text"] = part.texts.substr(row.text, end - row.text);
  if (row.is_trouble != 0) json["trouble"] = true;
  if (row.is_transfer != 0) {
    const auto transfer = std::ranges::lower_bound(part.transfers, place, {}, &Transfer::place);
    json["frames"] = transfer->frames;
    json["duration"] = std::chrono::duration<double>(transfer->duration).count();
  } else if (row.record >= store.begin()) {
    const can::Frame& frame = store.at(row.record).frame;
    json["dlc"] = frame.dlc;
    if (frame.remote) json["remote"] = true;
    json["data"] = ascii::hex_bytes(frame.bytes());
  }
  return json;
}

}  // namespace canopus::web
