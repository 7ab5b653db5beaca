#include "canopus/trace/print/trace_walk.hpp"

#include "canopus/trace/print/silent_pipe.hpp"

namespace canopus::trace {

int walk_trace(const std::string& path, text::Output& err,
               const std::function<bool(const TraceRecord&, std::string_view channel)>& record) {
  constexpr unsigned enough_errors = 100;
  auto reader = open_trace(path, std::nullopt, wait_in_words(err, [] { return true; }));
  if (!reader) {
    err.line("canopus: {}", reader.error());
    return 2;
  }
  unsigned errors = 0;
  while (true) {
    const auto next = (*reader)->next();
    if (!next) {
      err.line("canopus: {}", next.error());
      if (++errors == enough_errors) return 1;
      continue;
    }
    if (!*next) return errors == 0 ? 0 : 1;
    if (!record(**next, (*reader)->channel((*next)->channel))) return errors == 0 ? 0 : 1;
  }
}

}  // namespace canopus::trace
