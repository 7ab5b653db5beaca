#pragma once
// Traces as lists, for tests.

#include <cstdint>
#include <string>
#include <vector>

#include "canopus/trace/file/reader_base.hpp"
#include "canopus/trace/file/trace_encoder.hpp"

namespace canopus::trace {

struct NamedRecord {
  std::string channel{};
  TraceRecord record{};
  friend bool operator==(const NamedRecord&, const NamedRecord&) = default;
};

struct WholeTrace {
  std::vector<NamedRecord> records{};  // record.channel is 0
  std::vector<std::string> errors{};
  std::uint64_t left_out = 0;
  std::uint64_t lost = 0;
  std::string left_out_text{};
};

inline WholeTrace read_whole(OpenedReader reader) {
  WholeTrace all;
  if (!reader) {
    all.errors.push_back(reader.error());
    return all;
  }
  while (true) {
    auto next = (*reader)->next();
    if (!next) {
      all.errors.push_back(next.error());
      continue;
    }
    if (!*next) break;
    NamedRecord named{std::string((*reader)->channel((*next)->channel)), **next};
    named.record.channel = 0;
    all.records.push_back(std::move(named));
  }
  all.left_out = (*reader)->left_out().total();
  all.lost = (*reader)->left_out().lost();
  all.left_out_text = (*reader)->left_out().text();
  return all;
}

inline std::string encoded(FileFormat format, const std::vector<NamedRecord>& records) {
  TraceEncoder encoder(format);
  std::string bytes(encoder.begin());
  for (const NamedRecord& named : records) bytes += encoder.encode(named.channel, named.record);
  bytes += encoder.end();
  return bytes;
}

}  // namespace canopus::trace
