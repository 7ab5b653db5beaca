#include "canopus/trace/decode/sdo_follower.hpp"

#include <algorithm>
#include <utility>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/sdo/sdo_frame.hpp"

namespace canopus::trace {
namespace {

namespace sdo = canopen::sdo;

bool is_client_transfer_direction(bool is_read, bool from_client) noexcept { return is_read != from_client; }

/// Data bytes of an expedited transfer.
std::span<const std::uint8_t> expedited_data(const can::Frame& frame) noexcept {
  const bool sized = (frame.data[0] & sdo::size_bit) != 0;
  const std::size_t unused = sized ? frame.data[0] >> 2 & 3U : 0;
  return std::span<const std::uint8_t>(frame.data).subspan(4, 4 - unused);
}

void address(const can::Frame& frame, SdoFrame& out) {
  out.index = sdo::index(frame);
  out.sub = frame.data[3];
}

}  // namespace

SdoFollower::Step SdoFollower::follow(const can::Frame& frame, bool from_client, can::Time now) {
  Step step;
  now_ = now;
  last_frame_ = frame;
  if (phase_ != Phase::idle && !transfer_.is_joined) {
    step.frame.index = transfer_.index;
    step.frame.sub = transfer_.sub;
  }
  const bool carries = is_client_transfer_direction(transfer_.is_read, from_client);
  const bool is_abort = frame.data[0] == 0x80;
  if (phase_ == Phase::block_segments && carries && !is_abort && block_segment(frame, step)) {
    transfer_.last = now;
    ++transfer_.frames;
    return step;
  }
  const bool was_active = phase_ != Phase::idle;
  if (frame.data[0] >> 5 == 4) {
    step.frame.kind = "abort";
    address(frame, step.frame);
    step.frame.abort_code = sdo::value(frame);
    // An abort without a transfer, or of another object, may have 0000:00 when its sender has no transfer.
    if (was_active) {
      transfer_.last = now;
      ++transfer_.frames;
      transfer_.abort_code = step.frame.abort_code;
      transfer_.aborted_by_client = from_client;
      finish(step, TransferEnd::aborted);
    }
    return step;
  }
  if (was_active) {
    const can::Time before = std::exchange(transfer_.last, now);
    ++transfer_.frames;
    if (from_client) {
      client_frame(frame, now, step);
    } else {
      server_frame(frame, step);
    }
    if (step.overtaken) {  // the frame is the new one's
      step.overtaken->last = before;
      --step.overtaken->frames;
    }
  } else if (from_client) {
    client_frame(frame, now, step);
  } else {
    server_frame(frame, step);
  }
  return step;
}

std::optional<SdoTransfer> SdoFollower::give_up() {
  if (phase_ == Phase::idle) return std::nullopt;
  Step step;
  finish(step, phase_ == Phase::initiated ? TransferEnd::unanswered : TransferEnd::unfinished);
  return std::move(step.ended);
}

void SdoFollower::finish(Step& step, TransferEnd how) {
  transfer_.end = how;
  step.ended = std::move(transfer_);
  transfer_ = {};
  phase_ = Phase::idle;
}

void SdoFollower::begin(const can::Frame& frame, bool is_read, bool is_block, can::Time now, Step& step) {
  if (phase_ != Phase::idle) {
    transfer_.end = phase_ == Phase::initiated ? TransferEnd::unanswered : TransferEnd::overtaken;
    step.overtaken = std::move(transfer_);
  }
  address(frame, step.frame);
  transfer_ = {.is_read = is_read,
               .index = sdo::index(frame),
               .sub = frame.data[3],
               .is_block = is_block,
               .frames = 1,
               .begin = now,
               .last = now};
  phase_ = Phase::initiated;
  expedited_ = toggle_ = last_segment_ = last_in_block_ = false;
  block_.clear();
}

void SdoFollower::append(std::span<const std::uint8_t> bytes) {
  transfer_.size += bytes.size();
  const std::size_t room = most_sdo_data - std::min(most_sdo_data, transfer_.data.size());
  bytes = bytes.first(std::min(bytes.size(), room));
  transfer_.data.insert(transfer_.data.end(), bytes.begin(), bytes.end());
}

bool SdoFollower::answers(const can::Frame& frame, Step& step) const {
  address(frame, step.frame);
  return phase_ == Phase::initiated && transfer_.index == *step.frame.index &&
         transfer_.sub == step.frame.sub;
}

void SdoFollower::client_frame(const can::Frame& frame, can::Time now, Step& step) {
  switch (static_cast<sdo::ClientCommand>(frame.data[0] >> 5)) {
    case sdo::ClientCommand::initiate_download: return initiate_download(frame, now, step);
    case sdo::ClientCommand::initiate_upload:
      step.frame.kind = "upload request";
      return begin(frame, true, false, now, step);
    case sdo::ClientCommand::download_segment:
      step.frame.kind = "download segment";
      segment(frame, step);
      if (phase_ != Phase::segments || transfer_.is_read) return;
      check_toggle(step);
      toggle_ = *step.frame.toggle;
      append(step.frame.data);
      last_segment_ = step.frame.last;
      phase_ = Phase::segment_sent;
      return;
    case sdo::ClientCommand::upload_segment:
      step.frame.kind = "upload segment request";
      step.frame.toggle = (frame.data[0] & sdo::toggle_bit) != 0;
      if (phase_ != Phase::segments || !transfer_.is_read) return;
      check_toggle(step);
      toggle_ = *step.frame.toggle;
      phase_ = Phase::segment_sent;
      return;
    case sdo::ClientCommand::block_upload: return client_block_upload(frame, now, step);
    case sdo::ClientCommand::block_download: return client_block_download(frame, now, step);
    case sdo::ClientCommand::network_indication: step.frame.kind = "network indication"; return;
    case sdo::ClientCommand::abort: return;
  }
}

void SdoFollower::initiate_download(const can::Frame& frame, can::Time now, Step& step) {
  step.frame.kind = "download request";
  begin(frame, false, false, now, step);
  expedited_ = (frame.data[0] & sdo::expedited_bit) != 0;
  const bool sized = (frame.data[0] & sdo::size_bit) != 0;
  if (expedited_) {
    const auto bytes = expedited_data(frame);
    step.frame.data.assign(bytes.begin(), bytes.end());
    step.frame.length_unstated = transfer_.length_unstated = !sized;
    append(bytes);
  } else if (sized) {
    step.frame.size = transfer_.announced = sdo::value(frame);
  }
}

void SdoFollower::segment(const can::Frame& frame, Step& step) {
  const std::size_t unused = frame.data[0] >> 1 & 7U;
  step.frame.toggle = (frame.data[0] & sdo::toggle_bit) != 0;
  step.frame.last = (frame.data[0] & sdo::last_bit) != 0;
  const auto bytes = std::span<const std::uint8_t>(frame.data).subspan(1, 7 - unused);
  step.frame.data.assign(bytes.begin(), bytes.end());
}

/// It is 0 in the first segment and alternates; the server returns the client's.
void SdoFollower::check_toggle(Step& step) const {
  if (step.frame.toggle != toggle_) step.frame.expected_toggle = toggle_;
}

void SdoFollower::server_frame(const can::Frame& frame, Step& step) {
  switch (static_cast<sdo::ServerCommand>(frame.data[0] >> 5)) {
    case sdo::ServerCommand::initiate_download:
      step.frame.kind = "download response";
      if (!answers(frame, step) || transfer_.is_read || transfer_.is_block) return;
      if (expedited_) return finish(step, TransferEnd::done);
      phase_ = Phase::segments;
      return;
    case sdo::ServerCommand::initiate_upload: return initiate_upload_answer(frame, step);
    case sdo::ServerCommand::download_segment:
      step.frame.kind = "download segment response";
      step.frame.toggle = (frame.data[0] & sdo::toggle_bit) != 0;
      if (phase_ != Phase::segment_sent || transfer_.is_read) return;
      check_toggle(step);
      toggle_ = !toggle_;
      if (last_segment_) return finish(step, TransferEnd::done);
      phase_ = Phase::segments;
      return;
    case sdo::ServerCommand::upload_segment:
      step.frame.kind = "upload segment";
      segment(frame, step);
      if (phase_ != Phase::segment_sent || !transfer_.is_read) return;
      check_toggle(step);
      toggle_ = !toggle_;
      append(step.frame.data);
      if (step.frame.last) return finish(step, TransferEnd::done);
      phase_ = Phase::segments;
      return;
    case sdo::ServerCommand::block_download: return server_block_download(frame, step);
    case sdo::ServerCommand::block_upload: return server_block_upload(frame, step);
    case sdo::ServerCommand::abort: return;
  }
}

void SdoFollower::initiate_upload_answer(const can::Frame& frame, Step& step) {
  step.frame.kind = "upload response";
  const bool mine = answers(frame, step) && transfer_.is_read;
  const bool sized = (frame.data[0] & sdo::size_bit) != 0;
  if ((frame.data[0] & sdo::expedited_bit) != 0) {
    const auto bytes = expedited_data(frame);
    step.frame.data.assign(bytes.begin(), bytes.end());
    step.frame.length_unstated = !sized;
    if (!mine) return;
    transfer_.is_block = false;
    transfer_.length_unstated = !sized;
    append(bytes);
    return finish(step, TransferEnd::done);
  }
  if (sized) step.frame.size = sdo::value(frame);
  if (!mine) return;
  transfer_.is_block = false;  // a block upload may be answered so
  transfer_.announced = step.frame.size;
  phase_ = Phase::segments;
}

}  // namespace canopus::trace
