#pragma once
// Recorded traces that the page opens, of one folder or of the browser's machine: read, decoded and searched in a thread of their own,
// as the trace of the run.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <expected>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>

#include "canopus/serve/worker.hpp"
#include "canopus/text/json.hpp"
#include "canopus/trace/decode/names.hpp"
#include "canopus/web/trace/query_engine.hpp"

namespace canopus::web {

// A trace file that comes from the browser's machine, part by part.

/// It stands in the system's folder for temporary files without a name there, and is gone with this object, however the process ends.
class UploadedFile {
 public:
  /// `name`: as the browser has it, for sentences alone. `size`: bytes that will come. The error is a sentence.
  [[nodiscard]] static std::expected<std::shared_ptr<UploadedFile>, std::string> make(std::string name,
                                                                                      std::uint64_t size);
  ~UploadedFile();
  UploadedFile(const UploadedFile&) = delete;
  UploadedFile& operator=(const UploadedFile&) = delete;

  /// The next bytes. Returns how many have come. The error is a sentence: more than `size`, or the disk refuses them.
  [[nodiscard]] std::expected<std::uint64_t, std::string> add(std::string_view bytes);
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] bool is_whole() const noexcept { return received_ == size_; }
  /// Where this process reads it from its begin on.
  [[nodiscard]] std::string path() const;

 private:
  UploadedFile(std::string name, std::uint64_t size, int descriptor)
      : name_(std::move(name)), size_(size), descriptor_(descriptor) {}

  std::string name_;
  std::uint64_t size_;
  std::uint64_t received_ = 0;
  int descriptor_;
};

class TraceFiles {
 public:
  static constexpr std::size_t most_listed = 200;
  static constexpr std::size_t most_open = 2;             ///< another one closes the oldest
  static constexpr std::size_t most_records = 1'000'000;  ///< of a file: its first ones
  static constexpr std::size_t most_questions = 16;       ///< that wait for their answers
  static constexpr std::size_t most_uploads = 2;          ///< that come at once; another one ends the oldest
  static constexpr std::uint64_t longest_upload = 128U << 20;  ///< bytes
  static constexpr std::size_t longest_part = 256U << 10;      ///< bytes
  using Answer = std::expected<text::Json, std::string>;       ///< the error is a sentence
  using Done = std::function<void(Answer)>;

  /// `names`: of the nodes. `most`: of a file, most_records but for tests.
  TraceFiles(boost::asio::io_context& io, std::filesystem::path folder, trace::Names names,
             std::size_t most = most_records);
  ~TraceFiles();
  TraceFiles(const TraceFiles&) = delete;
  TraceFiles& operator=(const TraceFiles&) = delete;

  /// {"folder", "files": [{"path", "size"}]}: by their endings, those of the folder and of two levels below it; no links that lead out
  /// of it.
  [[nodiscard]] text::Json list() const;
  /// {"path": "a/b.pcapng"}, one of the list, or {"upload": 1}, which has come whole. The row {"file", "path", "format", "records",
  /// "left_out", "buses", "begin"} and `message` where reading ended before the file did; `path` is its name. Times are those since
  /// its first frame, which was at `begin` (s) by the file.
  void open(const text::Json& wish, Done done);
  /// {"name": "run.asc", "size": 5000}: such a file will come from the browser's machine. The row {"upload": 1}. Its name is shown, and is
  /// no path.
  [[nodiscard]] Answer begin_upload(const text::Json& wish);
  /// {"upload": 1, "data": "base64"}: its next bytes. The row {"received": 5000}. An upload that fails is over.
  void add_part(const text::Json& wish, Done done);
  /// {"file": 3}
  [[nodiscard]] Answer close(const text::Json& wish);
  /// TraceQueryEngine::answer() and export_part() of the file that the wish names. `done` is called in the loop, once.
  void query(const text::Json& wish, Done done) { ask(&TraceQueryEngine::answer, wish, std::move(done)); }
  void export_part(const text::Json& wish, Done done) {
    ask(&TraceQueryEngine::export_part, wish, std::move(done));
  }

 private:
  using Question = Answer (TraceQueryEngine::*)(const text::Json&);
  using Moment = std::chrono::steady_clock::time_point;
  struct File {
    std::uint64_t number = 0;
    std::shared_ptr<TraceQueryEngine> engine{};  // the worker's alone
  };
  struct Upload {
    std::uint64_t number = 0;
    std::shared_ptr<UploadedFile> file{};  // the worker's alone
  };
  /// Of what is read: where, and as people call it.
  struct Source {
    std::string path{};
    std::string name{};
    std::shared_ptr<UploadedFile> upload{};  // nullptr: a file of the folder
  };
  void read(Source source, Done done);
  [[nodiscard]] std::deque<Upload>::iterator upload_of(const text::Json& wish);
  void ask(Question question, const text::Json& wish, Done done);
  [[nodiscard]] std::deque<File>::iterator file_of(const text::Json& wish);

  boost::asio::io_context& io_;
  std::filesystem::path folder_;
  trace::Names names_;
  std::size_t most_;
  std::deque<File> files_;
  std::deque<Upload> uploads_;
  std::uint64_t next_ = 1;                                         // of a file or an upload
  std::shared_ptr<bool> is_there_ = std::make_shared<bool>(true);  // for work that comes back
  std::shared_ptr<std::atomic<bool>> ends_ = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<Moment> until_ = std::make_shared<Moment>();  // the worker's alone
  serve::Worker worker_;
};

}  // namespace canopus::web
