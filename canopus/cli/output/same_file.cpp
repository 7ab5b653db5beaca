#include "canopus/cli/output/same_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

namespace canopus::cli {

bool is_same_file(const std::string& in, const std::string& out) {
  struct stat first {
  }, second{};
  const int found = in == "-" ? ::fstat(STDIN_FILENO, &first) : ::stat(in.c_str(), &first);
  return out != "-" && found == 0 && ::stat(out.c_str(), &second) == 0 && S_ISREG(first.st_mode) &&
         first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

}  // namespace canopus::cli
