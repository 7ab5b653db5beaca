#include "canopus/manager/sdo/sdo_requests.hpp"

#include <algorithm>
#include <utility>

namespace canopus::manager {

using canopen::AbortCode;

bool SdoRequests::upload(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub, Done done,
                         can::Time now, const SdoRequestOptions& options) {
  return add(node_id, {index, sub, true, options, {}, std::move(done)}, now);
}

bool SdoRequests::download(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                           std::span<const std::uint8_t> value, Done done, can::Time now,
                           const SdoRequestOptions& options) {
  return add(node_id, {index, sub, false, options, {value.begin(), value.end()}, std::move(done)}, now);
}

bool SdoRequests::add(std::uint8_t node_id, Request request, can::Time now) {
  if (node_id == 0 || node_id >= channels_.size()) return false;
  auto& channel = channels_[node_id];
  if (!channel) {
    channel = std::make_unique<Channel>(*sink_);
    channel->client.set_server(node_id);
    alarms_[node_id].add_part(channel->client.alarm());
  }
  channel->queue.push_back(std::move(request));
  begin(node_id, now);
  return true;
}

bool SdoRequests::begin(std::uint8_t node_id, can::Time now) {
  Channel& channel = *channels_[node_id];
  if (channel.queue.empty() || channel.client.busy() || channel.ending) return false;
  const Request& next = channel.queue.front();
  const bool begun = gate_->channel_is_free(node_id) &&
                     (next.is_upload ? channel.client.upload(next.index, next.sub, *this, now,
                                                             next.options.time_out, next.options.mode)
                                     : channel.client.download(next.index, next.sub, next.value, *this, now,
                                                               next.options.time_out, next.options.mode));
  alarms_[node_id].set(begun ? can::never : later(now, busy_retry));
  return begun;
}

bool SdoRequests::channel_freed(std::uint8_t node_id, can::Time now) {
  return node_id < channels_.size() && channels_[node_id] && begin(node_id, now);
}

void SdoRequests::cancel(std::uint8_t node_id, AbortCode code, can::Time now) {
  for (std::size_t n = 1; n < channels_.size(); ++n) {
    if (!channels_[n] || (node_id != 0 && node_id != n)) continue;
    if (channels_[n]->client.busy()) channels_[n]->client.cancel(code);
    // What is requested from inside the calls comes later, and stays.
    for (std::size_t left = channels_[n]->queue.size(); left > 0; --left) {
      end(static_cast<std::uint8_t>(n), code, {}, now);
    }
    begin(static_cast<std::uint8_t>(n), now);
  }
}

void SdoRequests::end(std::uint8_t node_id, AbortCode code, std::span<const std::uint8_t> data,
                      can::Time now) {
  Channel& channel = *channels_[node_id];
  const Request request = std::move(channel.queue.front());
  channel.queue.pop_front();
  alarms_[node_id].cancel();
  if (!request.done) return;
  const bool was_ending = std::exchange(channel.ending, true);
  const canopen::SdoClient& client = channel.client;
  const bool is_over = code == client.abort_code();  // else it was cancelled
  request.done({node_id, request.index, request.sub, code, data, client.is_size_indicated(),
                is_over ? client.short_answer() : nullptr},
               now);
  channel.ending = was_ending;
}

void SdoRequests::sdo_finished(canopen::SdoClient& client, can::Time now) {
  const std::uint8_t node_id = client.server();
  const bool was_upload = channels_[node_id]->queue.front().is_upload;
  end(node_id, client.abort_code(), was_upload ? client.data() : std::span<const std::uint8_t>{}, now);
  // Others first: they have waited for the whole transfer.
  gate_->channel_freed(node_id, now);
  begin(node_id, now);
}

void SdoRequests::receive(const can::Frame& frame, can::Time now) {
  const auto node_id = static_cast<std::uint8_t>(frame.identifier & 0x7F);
  if (busy(node_id)) channels_[node_id]->client.receive(frame, now);
}

void SdoRequests::tick(can::Time now) {
  while (alarms_.alarm() <= now) {
    const std::uint8_t node_id = alarms_.first();
    alarms_[node_id].cancel();
    Channel& channel = *channels_[node_id];
    if (channel.client.busy()) {
      channel.client.tick(now);
    } else {
      begin(node_id, now);
    }
  }
}

}  // namespace canopus::manager
