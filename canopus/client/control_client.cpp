#include "canopus/client/control_client.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include "canopus/text/text_values.hpp"

namespace canopus::client {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using Json = text::Json;

namespace {

/// The values of a device with thousands of objects.
constexpr std::size_t longest_answer = 64U << 20U;

class Connection {
 public:
  explicit Connection(const ControlConnection& connection) : to_(connection) {}

  std::expected<void, std::string> open();
  std::expected<std::string, std::string> exchange(std::string request);

 private:
  [[nodiscard]] std::unexpected<std::string> failed(std::string_view what) const {
    return std::unexpected(fmt::format("{}:{}: {}", to_.host, to_.port, what));
  }
  /// Runs the operation that was started, at most for the time-out.
  bool finish() {
    context_.restart();
    context_.run_for(to_.timeout);
    if (context_.stopped()) return true;
    error_code ignored;
    socket_.close(ignored);
    context_.run();
    return false;
  }

  const ControlConnection& to_;
  asio::io_context context_{1};
  tcp::socket socket_{context_};
};

std::expected<void, std::string> Connection::open() {
  error_code error;
  tcp::resolver resolver(context_);
  const auto found = resolver.resolve(to_.host, std::to_string(to_.port), error);
  if (error) return failed(error.message());
  error = asio::error::would_block;
  asio::async_connect(socket_, found, [&error](error_code result, const tcp::endpoint&) { error = result; });
  if (!finish()) return failed("no connection within " + text::describe_duration(to_.timeout));
  if (error == asio::error::connection_refused) {
    return failed(
        error.message() +
        ". Is `canopus run` running, without --virtual? Its plant file says where it can be controlled: "
        "[plant] control = \"127.0.0.1:29540\"");
  }
  if (error) return failed(error.message());
  return {};
}

std::expected<std::string, std::string> Connection::exchange(std::string request) {
  request += '\n';
  std::string answer;
  error_code error = asio::error::would_block;
  asio::async_write(socket_, asio::buffer(request), [&](error_code result, std::size_t) {
    error = result;
    if (error) return;
    asio::async_read_until(socket_, asio::dynamic_buffer(answer, longest_answer), '\n',
                           [&](error_code end, std::size_t) { error = end; });
  });
  if (!finish()) return failed("no answer within " + text::describe_duration(to_.timeout));
  if (error == asio::error::eof) return failed("the plant closed the connection");
  if (error) return failed(error.message());
  return answer;
}

}  // namespace

std::expected<Json, std::string> request_control(const ControlConnection& connection, const Json& request) {
  Connection open(connection);
  if (auto good = open.open(); !good) return std::unexpected(good.error());
  const auto line = open.exchange(request.dump());
  if (!line) return std::unexpected(line.error());
  Json answer = text::parse_json(*line, {.bytes = longest_answer}).value_or(Json());
  const auto wrong = [&] {
    return std::unexpected(fmt::format("{}:{}: the answer is none of a plant's control server",
                                       connection.host, connection.port));
  };
  if (!answer.is_object() || !answer.contains("ok") || !answer["ok"].is_boolean()) return wrong();
  if (answer["ok"].get<bool>()) return answer;
  if (!answer.contains("error") || !answer["error"].is_string()) return wrong();
  return std::unexpected(answer["error"].get<std::string>());
}

}  // namespace canopus::client
