#include "canopus/trace/print/trace_walk.hpp"

#include "canopus/ascii/counted.hpp"

namespace canopus::trace {

bool report_left_out(const std::string& path, const TraceReader& reader, std::uint64_t records,
                     std::uint64_t mistakes, text::Output& err) {
  const LeftOut& left_out = reader.left_out();
  if (left_out.total() != 0) err.line("canopus: {}: left out: {}", path, left_out.text());
  if (left_out.lost() != 0)
    err.line("canopus: {}: the recorder lost {}, which are not in the trace", path,
             ascii::counted(left_out.lost(), "frame"));
  if (records != 0 || (left_out.frames() == 0 && mistakes == 0)) return true;
  err.line("canopus: {}: nothing of it was read: expected classical CAN frames in a trace of the format {}",
           path, name_of(reader.format()));
  return false;
}

int walk_trace(const std::string& path, text::Output& err,
               const std::function<bool(const TraceRecord&, std::string_view channel)>& record) {
  constexpr unsigned enough_errors = 100;
  auto opened = open_trace(path, std::nullopt, wait_in_words(err, [] { return true; }));
  if (!opened) {
    err.line("canopus: {}", opened.error());
    return 2;
  }
  TraceReader& reader = **opened;
  unsigned errors = 0;
  std::uint64_t records = 0;
  while (errors < enough_errors) {
    const auto next = reader.next();
    if (!next) {
      err.line("canopus: {}", next.error());
      ++errors;
      continue;
    }
    if (!*next) break;
    ++records;
    if (!record(**next, reader.channel((*next)->channel))) break;
  }
  const bool is_read = report_left_out(path, reader, records, errors, err);
  return is_read && errors == 0 ? 0 : 1;
}

}  // namespace canopus::trace
