#pragma once
// A transport over bytes in order: a TCP connection, or a device that its transport opens. Connects, reads, and writes what waits in one
// piece; when that is out, its frames count as handed over.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "canopus/link/handler_memory.hpp"
#include "canopus/link/transport.hpp"

namespace canopus::link {

class StreamTransport : public Transport {
 public:
  /// TCP to host and port of the address.
  StreamTransport(boost::asio::io_context& io, BusAddress address, BusClientOptions options);
  void finish() override;
  [[nodiscard]] bool finished() const override;
  void abort_transmissions() override;

 protected:
  /// The stream is there: greet. opened() is the transport's to call.
  virtual void stream_opened() = 0;
  virtual void bytes_received(std::string_view bytes) = 0;
  /// These frames are written.
  virtual void frames_written(std::span<const can::Frame> frames);
  /// Appends a frame's form. False: not yet (queue() keeps it).
  virtual bool append(std::string& out, const can::Frame& frame) = 0;
  /// Over the host and port of the address, unless it is overridden: use_stream() or failed() follows.
  void connect() override;
  /// An open, non-blocking descriptor, from now on ours.
  void use_stream(int descriptor);
  /// Bytes for the other side at the very end, as far as it takes them at once.
  void write_last(std::string_view bytes);
  [[nodiscard]] virtual std::string describe_failure(const boost::system::error_code& failure) const;

  /// Sends bytes that are no frame, behind what waits.
  void write_bytes(std::string_view bytes);
  /// No more is written from here; the other side may end the connection.
  void shut_down_writing();
  void write() override;
  void disconnect() override;
  [[nodiscard]] std::size_t under_way() const override { return written_.size(); }
  [[nodiscard]] const BusAddress& address() const noexcept { return address_; }

 private:
  void read();
  void on_written(const boost::system::error_code& failure);

  BusAddress address_;
  boost::asio::ip::tcp::resolver resolver_;
  boost::asio::ip::tcp::socket connecting_;
  std::unique_ptr<boost::asio::posix::stream_descriptor> stream_;
  std::uint32_t generation_ = 0;  // handlers of an earlier connection are deaf
  std::array<char, 16384> input_;
  HandlerPlace reading_place_;
  HandlerPlace writing_place_;
  std::string waiting_;               // bytes to write next
  std::string output_;                // being written
  std::vector<can::Frame> written_;   // in output_
  std::vector<can::Frame> reported_;  // were in it; their transmission is reported to the user
  bool writing_ = false;
};

}  // namespace canopus::link
