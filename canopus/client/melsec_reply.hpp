#pragma once
// Decodes replies for the clients of 3E, 4E and 1E frames.

#include <expected>
#include <string>

#include "canopus/client/plc_link.hpp"
#include "canopus/plc/melsec/field.hpp"

namespace canopus::client {

using MelsecReply = std::expected<plc::melsec::FieldReader, std::string>;

/// A reply that carries nothing.
inline std::expected<void, std::string> completed(const MelsecReply& reply) {
  if (!reply) return std::unexpected(reply.error());
  return {};
}

/// Checks that all data read so far existed.
inline std::expected<void, std::string> whole(const plc::melsec::FieldReader& data, const PlcLink& link) {
  if (data.fault() != plc::melsec::FieldReader::Fault::none) return std::unexpected(link.not_a_reply());
  return {};
}

}  // namespace canopus::client
