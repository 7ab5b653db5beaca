#pragma once

#include <deque>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/canopen/sdo/sdo_crc.hpp"

#include "canopen/conversation.hpp"

namespace canopus::canopen {

/// A value that is counted and checked, never kept: each byte is its position times 7.
class Megabytes : public ObjectHandler, public ObjectStream {
 public:
  explicit Megabytes(std::size_t size, bool size_is_known) : size_(size), size_is_known_(size_is_known) {}
  ObjectStream* stream(const Entry&) override { return this; }
  std::expected<std::optional<std::size_t>, AbortCode> open_read(const Entry&, can::Time) override {
    position = 0;
    if (!size_is_known_) return std::nullopt;
    return size_;
  }
  std::expected<std::size_t, AbortCode> read(std::span<std::uint8_t> into) override {
    largest_piece = std::max(largest_piece, into.size());
    const std::size_t count = std::min(into.size(), size_ - position);
    for (std::size_t i = 0; i < count; ++i) into[i] = static_cast<std::uint8_t>((position + i) * 7);
    position += count;
    return count;
  }
  AbortCode open_write(const Entry&, std::optional<std::size_t> size, can::Time) override {
    announced = size;
    position = 0;
    return AbortCode::none;
  }
  AbortCode write(std::span<const std::uint8_t> bytes) override {
    largest_piece = std::max(largest_piece, bytes.size());
    for (const std::uint8_t byte : bytes)
      is_right = is_right && byte == static_cast<std::uint8_t>(position++ * 7);
    return refusal;
  }
  AbortCode close(const Entry&, bool complete, can::Time) override {
    closed += complete ? "complete " : "incomplete ";
    return AbortCode::none;
  }

  std::size_t position = 0;
  std::size_t largest_piece = 0;
  std::optional<std::size_t> announced;
  bool is_right = true;
  AbortCode refusal = AbortCode::none;
  std::string closed;

 private:
  std::size_t size_;
  bool size_is_known_;
};

}  // namespace canopus::canopen
