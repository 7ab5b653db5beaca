#pragma once
// What the clients of 3E, 4E and 1E frames make of a reply.

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

/// What was read of the data was there.
inline std::expected<void, std::string> whole(const plc::melsec::FieldReader& data, const PlcLink& link) {
  if (data.fault() != plc::melsec::FieldReader::Fault::none) return std::unexpected(link.not_a_reply());
  return {};
}

}  // namespace canopus::client
