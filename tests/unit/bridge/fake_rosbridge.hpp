// A rosbridge on loopback, in a thread of its own, that can misbehave.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <openssl/evp.h>
#include <openssl/sha.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bridge/ros2/simulated_rosbridge.hpp"
#include "support/catch.hpp"

namespace rubicon::test {

/// Serves one client at a time; what the client sends goes to a simulated rosbridge.
class fake_rosbridge {
public:
  fake_rosbridge() : wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) { listen(); }
  ~fake_rosbridge() {
    stop();
    if (listener_ >= 0)
      ::close(listener_);
    ::close(wake_);
  }
  fake_rosbridge(const fake_rosbridge&) = delete;
  fake_rosbridge& operator=(const fake_rosbridge&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }

  void start() {
    if (listener_ < 0)
      listen();
    ends_ = false;
    thread_ = std::thread([this] { run(); });
  }

  /// As a killed process: its sockets are closed at once.
  void stop() {
    if (!thread_.joinable())
      return;
    ends_ = true;
    wake();
    thread_.join();
    drop();
    if (listener_ >= 0)
      ::close(std::exchange(listener_, -1));
  }

  /// A text message to the client.
  void send_text(std::string_view text) { send_raw(frame(0x81, text)); }

  /// Octets to the client, whatever they are.
  void send_raw(std::string octets) {
    {
      const std::lock_guard lock(mutex_);
      leaving_ += octets;
    }
    wake();
  }

  void set_reading(bool x) {
    reads_ = x;
    wake();
  }
  void set_refusing(bool x) { refuses_ = x; }

  [[nodiscard]] bool is_connected() const { return open_; }
  [[nodiscard]] std::size_t texts() const { return texts_; }

  /// A copy of what it knows.
  [[nodiscard]] bridge::simulated_rosbridge known() const {
    const std::lock_guard lock(mutex_);
    return core_;
  }

  [[nodiscard]] static std::string frame(int first, std::string_view content) {
    std::string out(1, static_cast<char>(first));
    if (content.size() < 126)
      out += static_cast<char>(content.size());
    else {
      const int octets = content.size() < 65536 ? 2 : 8;
      out += static_cast<char>(octets == 2 ? 126 : 127);
      for (int i = octets - 1; i >= 0; --i)
        out += static_cast<char>((static_cast<std::uint64_t>(content.size()) >> (8 * i)) & 0xff);
    }
    return out.append(content);
  }

private:
  void listen() {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int yes = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    const int few = 4096; // octets that wait here: who does not read is noticed soon
    ::setsockopt(listener_, SOL_SOCKET, SO_RCVBUF, &few, sizeof few);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    at.sin_port = htons(port_);
    socklen_t size = sizeof at;
    REQUIRE(::bind(listener_, reinterpret_cast<sockaddr*>(&at), size) == 0);
    REQUIRE(::getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size) == 0);
    port_ = ntohs(at.sin_port);
    REQUIRE(::listen(listener_, 4) == 0);
  }

  void wake() const {
    const std::uint64_t one = 1;
    static_cast<void>(!::write(wake_, &one, sizeof one));
  }

  void run() {
    while (!ends_) {
      std::array<pollfd, 3> all{{{wake_, POLLIN, 0}, {listener_, POLLIN, 0}, {client_, 0, 0}}};
      if (client_ >= 0)
        all[2].events = static_cast<short>((reads_ ? POLLIN : 0) | (has_leaving() ? POLLOUT : 0));
      ::poll(all.data(), client_ >= 0 ? 3 : 2, 1000);
      std::uint64_t ignored = 0;
      static_cast<void>(!::read(wake_, &ignored, sizeof ignored));
      if ((all[1].revents & POLLIN) != 0)
        accept();
      else if (client_ >= 0 && (all[2].revents & (POLLIN | POLLHUP | POLLERR)) != 0)
        read();
      write();
    }
  }

  void accept() {
    const int next = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (next < 0)
      return;
    drop();
    if (refuses_)
      ::close(next);
    else
      client_ = next;
  }

  void drop() {
    if (client_ >= 0)
      ::close(std::exchange(client_, -1));
    open_ = false;
    came_.clear();
    const std::lock_guard lock(mutex_);
    leaving_.clear();
    core_.on_disconnected();
  }

  void read() {
    std::array<char, 65536> some;
    const auto count = ::recv(client_, some.data(), some.size(), 0);
    if (count <= 0)
      return drop();
    came_.append(some.data(), static_cast<std::size_t>(count));
    if (!open_)
      greet();
    while (open_ && take_frame()) {
    }
  }

  void greet() {
    if (came_.find("\r\n\r\n") == std::string::npos)
      return;
    constexpr std::string_view name = "Sec-WebSocket-Key: ";
    const auto at = came_.find(name);
    if (at == std::string::npos)
      return drop();
    const auto key = came_.substr(at + name.size(), 24) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
    std::array<unsigned char, SHA_DIGEST_LENGTH> digest;
    ::SHA1(reinterpret_cast<const unsigned char*>(key.data()), key.size(), digest.data());
    std::array<unsigned char, 64> accepted;
    const int size = ::EVP_EncodeBlock(accepted.data(), digest.data(), SHA_DIGEST_LENGTH);
    came_.clear();
    open_ = true;
    const std::lock_guard lock(mutex_);
    leaving_ += "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                "Sec-WebSocket-Accept: " +
                std::string(reinterpret_cast<const char*>(accepted.data()),
                            static_cast<std::size_t>(size)) +
                "\r\n\r\n";
  }

  /// Of a client: masked, not in parts.
  bool take_frame() {
    if (came_.size() < 6)
      return false;
    const auto octet = [this](std::size_t i) { return static_cast<unsigned char>(came_[i]); };
    std::size_t size = octet(1) & 0x7fU;
    std::size_t at = 2;
    if (size >= 126) {
      const std::size_t octets = size == 126 ? 2 : 8;
      if (came_.size() < 2 + octets)
        return false;
      size = 0;
      for (std::size_t i = 0; i < octets; ++i)
        size = (size << 8U) | octet(2 + i);
      at += octets;
    }
    if (came_.size() < at + 4 + size)
      return false;
    std::string content = came_.substr(at + 4, size);
    for (std::size_t i = 0; i < size; ++i)
      content[i] = static_cast<char>(content[i] ^ came_[at + i % 4]);
    const int kind = octet(0) & 0x0f;
    came_.erase(0, at + 4 + size);
    const std::lock_guard lock(mutex_);
    if (kind == 9)
      leaving_ += frame(0x8a, content);
    if (kind != 1)
      return true;
    ++texts_;
    for (const auto& each : core_.on_text(content))
      leaving_ += frame(0x81, each);
    return true;
  }

  [[nodiscard]] bool has_leaving() const {
    const std::lock_guard lock(mutex_);
    return !leaving_.empty();
  }

  void write() {
    const std::lock_guard lock(mutex_);
    if (client_ < 0 || leaving_.empty())
      return;
    const auto count = ::send(client_, leaving_.data(), leaving_.size(), MSG_NOSIGNAL);
    if (count > 0)
      leaving_.erase(0, static_cast<std::size_t>(count));
  }

  int listener_ = -1;
  int client_ = -1;
  int wake_;
  std::uint16_t port_ = 0;
  std::thread thread_;
  std::atomic<bool> ends_ = false;
  std::atomic<bool> reads_ = true;
  std::atomic<bool> refuses_ = false;
  std::atomic<bool> open_ = false;
  std::atomic<std::size_t> texts_ = 0;
  std::string came_;
  mutable std::mutex mutex_; ///< guards what follows
  std::string leaving_;
  bridge::simulated_rosbridge core_;
};

} // namespace rubicon::test
