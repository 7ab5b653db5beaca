#include "canopus/link/slcan/serial_device.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

namespace canopus::link {
namespace {

struct Speed {
  std::uint32_t speed;
  speed_t code;
};
constexpr Speed speeds[] = {
    {1200, B1200},       {2400, B2400},       {4800, B4800},       {9600, B9600},       {19200, B19200},
    {38400, B38400},     {57600, B57600},     {115200, B115200},   {230400, B230400},   {460800, B460800},
    {500000, B500000},   {576000, B576000},   {921600, B921600},   {1000000, B1000000}, {1152000, B1152000},
    {1500000, B1500000}, {2000000, B2000000}, {2500000, B2500000}, {3000000, B3000000}, {3500000, B3500000},
    {4000000, B4000000},
};

std::string describe(int reason) {
  switch (reason) {
    case ENOENT: return "there is no such device; is the adapter plugged in?";
    case EACCES: return "permission denied; the user must be in the device's group (usually dialout)";
    case EBUSY: return "another program has opened it";
    default: return std::strerror(reason);
  }
}

}  // namespace

std::expected<int, std::string> open_serial_device(const std::string& path, std::uint32_t speed) {
  const auto* known = std::ranges::find(speeds, speed, &Speed::speed);
  if (known == std::end(speeds)) {
    return std::unexpected(std::to_string(speed) + " bit/s is no speed of a serial line (9600 ... 4000000)");
  }
  const int file = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return std::unexpected(describe(errno));
  termios settings{};
  if (::tcgetattr(file, &settings) < 0) {
    ::close(file);
    return std::unexpected("this is not a serial device");
  }
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  ::cfsetispeed(&settings, known->code);
  ::cfsetospeed(&settings, known->code);
  if (::tcsetattr(file, TCSANOW, &settings) < 0) {
    const int reason = errno;
    ::close(file);
    return std::unexpected(std::string("its line cannot be set up: ") + std::strerror(reason));
  }
  (void)::ioctl(file, TIOCEXCL);
  (void)::tcflush(file, TCIOFLUSH);
  return file;
}

}  // namespace canopus::link
