#include "canopus/web/access/audit.hpp"

#include <cerrno>
#include <ctime>
#include <mutex>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "canopus/serve/worker.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::web {
namespace {

std::string utc_of(std::int64_t milliseconds) {
  const std::time_t seconds = static_cast<std::time_t>(milliseconds / 1000);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", parts.tm_year + 1900, parts.tm_mon + 1,
                     parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec, milliseconds % 1000);
}

}  // namespace

std::string audit_line(const WebAuditEntry& entry) {
  text::Json line{{"at", utc_of(entry.milliseconds)},
                  {"t", entry.plant_time},
                  {"user", entry.user.name},
                  {"role", name_of(entry.user.role)},
                  {"address", entry.user.address},
                  {"do", entry.what},
                  {"code", entry.code}};
  if (!entry.message.empty()) line["message"] = entry.message;
  return text::printable_json(line.dump());
}

struct WebAudit::File {
  File(int the_descriptor, std::string the_name) : descriptor(the_descriptor), name(std::move(the_name)) {}
  ~File() { ::close(descriptor); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void write(const std::string& line) {
    std::string text = line + '\n';
    {
      const std::scoped_lock lock(mutex);
      if (lost != 0) text = fmt::format("{{\"lost\":{}}}\n", lost) + text;
      if (is_torn) text = '\n' + text;
    }
    std::size_t written = 0;
    int error = 0;
    while (error == 0 && written < text.size()) {
      const ssize_t count = ::write(descriptor, text.data() + written, text.size() - written);
      if (count >= 0) {
        written += static_cast<std::size_t>(count);
      } else if (errno != EINTR) {
        error = errno;
      }
    }
    if (error == 0) (void)::fdatasync(descriptor);
    const std::scoped_lock lock(mutex);
    if (written != 0) is_torn = error != 0;
    if (error == 0) {
      lost = 0;
    } else {
      lose(std::generic_category().message(error));
    }
  }
  /// With the lock.
  void lose(const std::string& why) {
    ++lost;
    trouble = fmt::format("{}: {}: lines of the audit log are lost", name, why);
  }

  const int descriptor;
  const std::string name;
  std::mutex mutex;
  std::uint64_t lost = 0;
  bool is_torn = false;  // the last line is half there
  std::string trouble;
};

std::expected<std::unique_ptr<WebAudit>, std::string> WebAudit::open(const std::string& name) {
  const auto error = [&](int why) {
    return std::unexpected(name + ": " + std::generic_category().message(why));
  };
  const int descriptor = ::open(
      name.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY, 0600);
  if (descriptor < 0) return error(errno);
  auto file = std::make_shared<File>(descriptor, name);
  struct stat found {};
  if (::fstat(descriptor, &found) != 0) return error(errno);
  if (!S_ISREG(found.st_mode)) return std::unexpected(name + ": expected a file");
  return std::unique_ptr<WebAudit>(new WebAudit(std::move(file)));
}

WebAudit::WebAudit(std::shared_ptr<File> file)
    : file_(std::move(file)),
      worker_(std::make_unique<serve::Worker>(most_waiting, true, std::chrono::seconds(2))) {}

WebAudit::~WebAudit() = default;

void WebAudit::add(std::string_view line) {
  if (worker_->add([file = file_, text = std::string(line)] { file->write(text); })) return;
  const std::scoped_lock lock(file_->mutex);
  file_->lose("the disk does not take them");
}

std::string WebAudit::next_trouble() {
  const std::scoped_lock lock(file_->mutex);
  return std::exchange(file_->trouble, {});
}

std::uint64_t WebAudit::lost() const {
  const std::scoped_lock lock(file_->mutex);
  return file_->lost;
}

}  // namespace canopus::web
