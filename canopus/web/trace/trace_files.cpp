#include "canopus/web/trace/trace_files.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <boost/asio/post.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/text/base64.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/trace/file/file_format.hpp"
#include "canopus/trace/file/trace_reader.hpp"
#include "canopus/web/access/inside_folder.hpp"
#include "canopus/web/commands/wish_fields.hpp"
#include "canopus/web/trace/live_trace.hpp"

namespace canopus::web {

std::expected<std::shared_ptr<UploadedFile>, std::string> UploadedFile::make(std::string name,
                                                                             std::uint64_t size) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error) return std::unexpected("there is no folder for temporary files");
  std::string path = folder / "canopus-upload-XXXXXX";
  const int descriptor = ::mkostemp(path.data(), O_CLOEXEC);
  if (descriptor < 0) {
    return std::unexpected(fmt::format("{}: cannot make a temporary file: {}", folder.string(),
                                       std::generic_category().message(errno)));
  }
  (void)::unlink(path.c_str());
  return std::shared_ptr<UploadedFile>(new UploadedFile(std::move(name), size, descriptor));
}

UploadedFile::~UploadedFile() { (void)::close(descriptor_); }

std::expected<std::uint64_t, std::string> UploadedFile::add(std::string_view bytes) {
  if (bytes.size() > size_ - received_)
    return std::unexpected(fmt::format("{}: more than its {} came", name_, ascii::counted(size_, "byte")));
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      return std::unexpected(
          fmt::format("{}: cannot be kept here: {}", name_, std::generic_category().message(errno)));
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
    received_ += static_cast<std::uint64_t>(written);
  }
  return received_;
}

std::string UploadedFile::path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

namespace {

namespace fs = std::filesystem;

constexpr const char* no_upload = "this upload is over; begin again";
constexpr std::array<std::string_view, 7> endings{".log", ".pcapng", ".pcap", ".asc", ".trc", ".blf", ".csv"};

/// What was read of a file.
struct Recording {
  std::vector<trace::TraceRecord> records{};
  std::vector<std::string> buses{};
  std::string format{};
  std::uint64_t left_out = 0;
  can::Time begin{};
  std::string message{};
};

/// A sentence of the reader, in which the file has the name that people know.
std::string with_name(std::string sentence, const std::string& path, const std::string& name) {
  if (sentence.starts_with(path)) sentence.replace(0, path.size(), name);
  return sentence;
}

/// Up to its first mistake, or to `most` records. The error is a sentence.
std::expected<Recording, std::string> read_recording(const std::string& path, const std::string& name,
                                                     std::size_t most,
                                                     const trace::KeepReading& keep_reading) {
  auto reader = trace::open_trace(path, std::nullopt, keep_reading);
  if (!reader) return std::unexpected(with_name(reader.error(), path, name));
  Recording recording{.format = std::string(trace::name_of((*reader)->format()))};
  while (true) {
    auto record = (*reader)->next();
    if (!record) {
      recording.message = with_name(record.error(), path, name);
      break;
    }
    if (!*record) break;
    if (recording.records.size() == most) {
      recording.message = fmt::format("the first {} frames; the file has more", most);
      break;
    }
    recording.records.push_back(**record);
  }
  if (recording.records.empty())
    return std::unexpected(recording.message.empty() ? name + ": there is no frame in it"
                                                     : recording.message);
  recording.begin = recording.records.front().time;
  for (trace::TraceRecord& record : recording.records)
    record.time = can::Time{std::max(record.time - recording.begin, can::Duration{})};
  const trace::LeftOut& left_out = (*reader)->left_out();
  recording.left_out = left_out.total();
  if (recording.message.empty() && left_out.frames() > 0) recording.message = "left out: " + left_out.text();
  for (std::size_t i = 0; i < (*reader)->channel_count(); ++i)
    recording.buses.emplace_back((*reader)->channel(i));
  return recording;
}

}  // namespace

TraceFiles::TraceFiles(boost::asio::io_context& io, fs::path folder, trace::Names names, std::size_t most)
    : io_(io),
      folder_(std::move(folder)),
      names_(std::move(names)),
      most_(most),
      worker_(most_questions, false, WebTrace::patience) {}

TraceFiles::~TraceFiles() { *ends_ = true; }

text::Json TraceFiles::list() const {
  constexpr int deepest = 2;
  constexpr int most_looked_at = 20'000;
  std::vector<std::pair<std::string, std::uintmax_t>> found;
  std::error_code error;
  int looked_at = 0;
  fs::recursive_directory_iterator files(folder_, fs::directory_options::skip_permission_denied, error);
  for (; !error && files != fs::recursive_directory_iterator() && ++looked_at < most_looked_at &&
         found.size() < most_listed;
       files.increment(error)) {
    const fs::path& path = files->path();
    std::error_code unknown;
    const bool is_folder = files->is_directory(unknown);
    const bool is_hidden = path.filename().string().starts_with('.');
    if (is_folder && (is_hidden || files.depth() >= deepest)) files.disable_recursion_pending();
    const std::string ending = path.extension().string();
    if (is_folder || is_hidden || std::ranges::find(endings, ending) == endings.end()) continue;
    if (is_inside(path, folder_))
      found.emplace_back(path.lexically_relative(folder_).string(), fs::file_size(path, unknown));
  }
  std::ranges::sort(found);
  text::Json rows = text::Json::array();
  for (const auto& [path, size] : found) rows.push_back({{"path", path}, {"size", size}});
  return {{"folder", shown_folder(folder_)}, {"files", std::move(rows)}};
}

void TraceFiles::open(const text::Json& wish, Done done) {
  if (wish.contains("upload")) {
    const auto upload = upload_of(wish);
    if (upload == uploads_.end()) return done(std::unexpected(no_upload));
    std::shared_ptr<UploadedFile> file = std::move(upload->file);
    uploads_.erase(upload);
    return read({.path = file->path(), .name = file->name(), .upload = file}, std::move(done));
  }
  const std::string path = wish.value("path", "");
  const text::Json known = list()["files"];
  const bool is_known =
      std::ranges::any_of(known, [&](const text::Json& one) { return one["path"].string() == path; });
  if (!is_known)
    return done(std::unexpected(fmt::format("there is no trace file {}", text::printable(path))));
  read({.path = (folder_ / path).string(), .name = path}, std::move(done));
}

void TraceFiles::read(Source source, Done done) {
  if (files_.size() >= most_open) files_.pop_front();
  const std::uint64_t number = next_++;
  // The engine is made where the file is read, and comes into the loop with the row.
  const bool is_taken =
      worker_.add([this_there = std::weak_ptr(is_there_), this, &io = io_, source = std::move(source), number,
                   most = most_, names = names_, ends = ends_, until = until_, done] {
        const bool is_there = source.upload == nullptr || source.upload->is_whole();
        auto recording = is_there ? read_recording(source.path, source.name, most,
                                                   [ends](std::string_view) { return !*ends; })
                                  : std::unexpected(source.name + ": not all of it has come");
        std::shared_ptr<TraceQueryEngine> engine;
        Answer row = recording ? Answer(text::Json{{"file", number},
                                                   {"path", source.name},
                                                   {"format", recording->format},
                                                   {"records", recording->records.size()},
                                                   {"left_out", recording->left_out},
                                                   {"buses", recording->buses},
                                                   {"begin", can::seconds(recording->begin)}})
                               : Answer(std::unexpected(recording.error()));
        if (recording) {
          if (!recording->message.empty()) (*row)["message"] = recording->message;
          engine = std::make_shared<TraceQueryEngine>(TraceQueryEngine::Use{
              .names = names,
              .buses = recording->buses,
              .bit_rates = std::vector<std::uint32_t>(recording->buses.size()),
              .most = most,
              .has_time = [until] { return std::chrono::steady_clock::now() < *until; }});
          engine->add(recording->records);
        }
        boost::asio::post(io, [this_there, this, engine, number, done, row = std::move(row)]() mutable {
          if (this_there.expired()) return;
          if (engine) files_.push_back({number, std::move(engine)});
          if (files_.size() > most_open) files_.pop_front();
          done(std::move(row));
        });
      });
  if (!is_taken) done(std::unexpected("other trace files are being read; try again"));
}

TraceFiles::Answer TraceFiles::begin_upload(const text::Json& wish) {
  constexpr std::size_t longest_name = 255;
  const std::string name = wish.value("name", "");
  if (name.empty() || name.size() > longest_name)
    return std::unexpected(fmt::format("name: expected 1 to {} bytes", longest_name));
  const auto size = number_field(wish, "size", 1, longest_upload);
  if (!size) {
    const auto given = number_field(wish, "size", 0, UINT64_MAX);
    return std::unexpected(!given ? std::string("size: expected a number of bytes")
                           : *given == 0
                               ? text::printable(name) + ": the file is empty"
                               : fmt::format("{}: {} MiB; a trace file from elsewhere has at most {} MiB",
                                             text::printable(name), (*given + (1U << 20) - 1) >> 20,
                                             longest_upload >> 20));
  }
  auto file = UploadedFile::make(text::printable(name), *size);
  if (!file) return std::unexpected(file.error());
  if (uploads_.size() >= most_uploads) uploads_.pop_front();
  uploads_.push_back({next_++, std::move(*file)});
  return text::Json{{"upload", uploads_.back().number}};
}

void TraceFiles::add_part(const text::Json& wish, Done done) {
  const auto upload = upload_of(wish);
  if (upload == uploads_.end()) return done(std::unexpected(no_upload));
  std::string data = wish.value("data", "");
  if (data.size() > (longest_part + 2) / 3 * 4)
    return done(std::unexpected(fmt::format("data: expected at most {} bytes", longest_part)));
  const bool is_taken =
      worker_.add([this, number = upload->number, file = upload->file, data = std::move(data), done,
                   there = std::weak_ptr(is_there_), &io = io_] {
        const auto bytes = text::from_base64(data);
        const auto received = bytes ? file->add(*bytes) : std::unexpected("data: expected base64");
        boost::asio::post(io, [this, number, done, there, received] {
          if (there.expired()) return;
          if (!received) std::erase_if(uploads_, [&](const Upload& one) { return one.number == number; });
          done(received ? Answer(text::Json{{"received", *received}})
                        : Answer(std::unexpected(received.error())));
        });
      });
  if (!is_taken) done(std::unexpected("the trace has too much to do; try again"));
}

std::deque<TraceFiles::Upload>::iterator TraceFiles::upload_of(const text::Json& wish) {
  return std::ranges::find(uploads_, number_field(wish, "upload", 0, UINT64_MAX).value_or(0),
                           &Upload::number);
}

std::deque<TraceFiles::File>::iterator TraceFiles::file_of(const text::Json& wish) {
  return std::ranges::find(files_, number_field(wish, "file", 0, UINT64_MAX).value_or(0), &File::number);
}

TraceFiles::Answer TraceFiles::close(const text::Json& wish) {
  const auto file = file_of(wish);
  if (file == files_.end()) return std::unexpected("this trace file is not open");
  const std::uint64_t number = file->number;
  files_.erase(file);
  return text::Json{{"closed", number}};
}

void TraceFiles::ask(Question question, const text::Json& wish, Done done) {
  const auto file = file_of(wish);
  if (file == files_.end())
    return done(std::unexpected("this trace file is not open any more; open it again"));
  const bool is_taken = worker_.add([question, wish, done, engine = file->engine, until = until_,
                                     there = std::weak_ptr(is_there_), &io = io_] {
    *until = std::chrono::steady_clock::now() + WebTrace::turn;
    auto row = ((*engine).*question)(wish);
    boost::asio::post(io, [done, there, row = std::move(row)]() mutable {
      if (!there.expired()) done(std::move(row));
    });
  });
  if (!is_taken) done(std::unexpected("the trace has too much to do; try again"));
}

}  // namespace canopus::web
