// Block transfers.

#include <algorithm>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/sdo/sdo_frame.hpp"
#include "canopus/trace/decode/sdo_follower.hpp"

namespace canopus::trace {
namespace {

namespace sdo = canopen::sdo;

constexpr std::uint8_t announced_bit = 0x02;  // size indicated, in the initiate frames of block transfers

}  // namespace

bool SdoFollower::block_segment(const can::Frame& frame, Step& step) {
  const auto number = static_cast<std::uint8_t>(frame.data[0] & 0x7FU);
  if (number == 0 || number > block_size_) return false;
  step.frame.kind = transfer_.is_read ? "block upload segment" : "block download segment";
  step.frame.sequence = number;
  step.frame.last = (frame.data[0] & sdo::last_segment) != 0;
  step.frame.data.assign(frame.data.begin() + 1, frame.data.end());
  if (number != block_.size() + 1) return true;  // one before it was lost, or it is a repetition
  std::array<std::uint8_t, 7> bytes;
  std::copy_n(frame.data.begin() + 1, bytes.size(), bytes.begin());
  block_.push_back(bytes);
  if (step.frame.last) last_in_block_ = true;
  return true;
}

void SdoFollower::join(bool is_read) {
  transfer_ = {
      .is_read = is_read, .is_block = true, .is_joined = true, .frames = 1, .begin = now_, .last = now_};
  phase_ = Phase::block_segments;
  block_size_ = last_frame_.data[2];
  last_in_block_ = false;
  block_.clear();
}

void SdoFollower::confirm(const can::Frame& frame, bool is_read, Step& step) {
  step.frame.sequence = frame.data[1];
  step.frame.block_size = frame.data[2];
  if (phase_ == Phase::idle && frame.data[2] >= 1 && frame.data[2] <= 127) return join(is_read);
  if (phase_ != Phase::block_segments || transfer_.is_read != is_read) return;
  const std::size_t good = std::min<std::size_t>(frame.data[1], block_.size());
  for (std::size_t i = 0; i < good; ++i) append(block_[i]);
  const bool all = last_in_block_ && good == block_.size();
  block_.clear();
  last_in_block_ = false;
  block_size_ = frame.data[2];
  if (all) phase_ = Phase::block_end;
}

void SdoFollower::end_of_block(const can::Frame& frame, Step& step) {
  if (phase_ != Phase::block_end && phase_ != Phase::block_segments) return;
  const std::uint64_t unused = frame.data[0] >> 2 & 7U;
  transfer_.size -= std::min(unused, transfer_.size);
  if (transfer_.data.size() > transfer_.size) transfer_.data.resize(static_cast<std::size_t>(transfer_.size));
  phase_ = Phase::block_end_sent;
  step.frame.last = true;
}

void SdoFollower::client_block_upload(const can::Frame& frame, can::Time now, Step& step) {
  switch (static_cast<sdo::BlockUpload>(frame.data[0] & 3U)) {
    case sdo::BlockUpload::initiate:
      step.frame.kind = "block upload request";
      begin(frame, true, true, now, step);
      step.frame.block_size = block_size_ = frame.data[4];
      return;
    case sdo::BlockUpload::start:
      step.frame.kind = "block upload start";
      if (phase_ == Phase::block_start) phase_ = Phase::block_segments;
      return;
    case sdo::BlockUpload::response:
      step.frame.kind = "block upload confirmation";
      confirm(frame, true, step);
      return;
    case sdo::BlockUpload::end:
      step.frame.kind = "block upload end response";
      if (phase_ == Phase::block_end_sent && transfer_.is_read) finish(step, TransferEnd::done);
      return;
  }
}

void SdoFollower::server_block_upload(const can::Frame& frame, Step& step) {
  if ((frame.data[0] & 1U) != 0) {
    step.frame.kind = "block upload end";
    if (transfer_.is_read) end_of_block(frame, step);
    return;
  }
  step.frame.kind = "block upload response";
  const bool mine = answers(frame, step) && transfer_.is_read && transfer_.is_block;
  if ((frame.data[0] & announced_bit) != 0) step.frame.size = sdo::value(frame);
  if (!mine) return;
  transfer_.announced = step.frame.size;
  phase_ = Phase::block_start;
}

void SdoFollower::client_block_download(const can::Frame& frame, can::Time now, Step& step) {
  if ((frame.data[0] & 1U) != 0) {
    step.frame.kind = "block download end";
    if (!transfer_.is_read) end_of_block(frame, step);
    return;
  }
  step.frame.kind = "block download request";
  begin(frame, false, true, now, step);
  if ((frame.data[0] & announced_bit) != 0) step.frame.size = transfer_.announced = sdo::value(frame);
}

void SdoFollower::server_block_download(const can::Frame& frame, Step& step) {
  switch (frame.data[0] & 3U) {
    case 0:
      step.frame.kind = "block download response";
      step.frame.block_size = frame.data[4];
      if (!answers(frame, step) || transfer_.is_read || !transfer_.is_block) return;
      block_size_ = frame.data[4];
      phase_ = Phase::block_segments;
      return;
    case 1:
      step.frame.kind = "block download end response";
      if (phase_ == Phase::block_end_sent && !transfer_.is_read) finish(step, TransferEnd::done);
      return;
    case 2:
      step.frame.kind = "block download confirmation";
      confirm(frame, false, step);
      return;
    default: return;
  }
}

}  // namespace canopus::trace
