#include "canopus/trace/decode/sdo_channel.hpp"

#include <algorithm>
#include <utility>

#include "canopus/canopen/sdo/sdo_frame.hpp"

namespace canopus::trace {
namespace {

namespace sdo = canopen::sdo;

bool begins_transfer(const can::Frame& frame) noexcept {
  const std::uint8_t command = frame.data[0];
  switch (static_cast<sdo::ClientCommand>(command >> 5)) {
    case sdo::ClientCommand::initiate_download:
    case sdo::ClientCommand::initiate_upload: return true;
    case sdo::ClientCommand::block_upload:
      return static_cast<sdo::BlockUpload>(command & 3U) == sdo::BlockUpload::initiate;
    case sdo::ClientCommand::block_download: return (command & 1U) == 0;
    default: return false;
  }
}

/// An abort, or the answer to a request: these frames have an object.
bool names_its_object(const can::Frame& frame, bool from_client) noexcept {
  const std::uint8_t command = frame.data[0];
  if (command >> 5 == 4) return true;
  if (from_client) return false;
  switch (static_cast<sdo::ServerCommand>(command >> 5)) {
    case sdo::ServerCommand::initiate_download:
    case sdo::ServerCommand::initiate_upload: return true;
    case sdo::ServerCommand::block_download: return (command & 3U) == 0;
    case sdo::ServerCommand::block_upload: return (command & 1U) == 0;
    default: return false;
  }
}

EndedSdoTransfer ended(SdoFollower& follower) {
  const can::Frame frame = follower.last_frame();
  return {.transfer = follower.give_up().value_or(SdoTransfer{}), .frame = frame};
}

}  // namespace

SdoFollower::Step SdoChannel::follow(const can::Frame& frame, bool from_client, can::Time now) {
  const Place follower = follower_of(frame, from_client);
  SdoFollower::Step step = follower->follow(frame, from_client, now);
  if (!follower->is_active()) {
    followers_.erase(follower);
  } else if (followers_.size() > most_requests) {
    step.overtaken = followers_.front().give_up();
    followers_.erase(followers_.begin());
  }
  return step;
}

SdoChannel::Place SdoChannel::follower_of(const can::Frame& frame, bool from_client) {
  const auto segments = std::ranges::find_if(followers_, [from_client](const SdoFollower& follower) {
    return follower.expects_block_segment(from_client);
  });
  if (segments != followers_.end()) return segments;
  if (names_its_object(frame, from_client)) {
    const Place request = request_of(sdo::index(frame), frame.data[3]);
    if (request != followers_.end()) return request;
  }
  const Place current = under_way();
  if (current != followers_.end()) return current;
  const bool is_new = followers_.empty() || (from_client && begins_transfer(frame));
  if (is_new) followers_.emplace_back();
  return followers_.end() - 1;
}

SdoChannel::Place SdoChannel::request_of(std::uint16_t index, std::uint8_t sub) {
  const auto found = std::find_if(followers_.rbegin(), followers_.rend(), [&](const SdoFollower& follower) {
    return follower.awaits_answer() && follower.is_of(index, sub);
  });
  return found == followers_.rend() ? followers_.end() : found.base() - 1;
}

SdoChannel::Place SdoChannel::under_way() {
  const auto found = std::find_if(followers_.rbegin(), followers_.rend(),
                                  [](const SdoFollower& follower) { return !follower.awaits_answer(); });
  return found == followers_.rend() ? followers_.end() : found.base() - 1;
}

void SdoChannel::note_short_answer(std::span<const std::uint8_t> bytes) {
  if (followers_.empty()) return;
  Place request = followers_.end();
  if (bytes.size() >= 4) request = request_of(static_cast<std::uint16_t>(bytes[1] | bytes[2] << 8), bytes[3]);
  if (request == followers_.end()) request = followers_.end() - 1;
  request->note_short_answer(bytes.size());
}

std::vector<EndedSdoTransfer> SdoChannel::expire(can::Time now, can::Duration time_out) {
  std::vector<EndedSdoTransfer> all;
  std::erase_if(followers_, [&](SdoFollower& follower) {
    if (now - follower.last() < time_out) return false;
    all.push_back(ended(follower));
    return true;
  });
  return all;
}

std::vector<EndedSdoTransfer> SdoChannel::give_up() {
  std::vector<EndedSdoTransfer> all;
  for (SdoFollower& follower : followers_) all.push_back(ended(follower));
  followers_.clear();
  return all;
}

}  // namespace canopus::trace
