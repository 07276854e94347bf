// TLS before a server on loopback that knows none, in a thread of its own.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "support/catch.hpp"

namespace rubicon::test {

/// One connection at a time: what comes through TLS goes on to the server, and back.
class tls_front {
public:
  /// @param server port of it, on loopback
  tls_front(const std::string& certificate, const std::string& key, std::uint16_t server)
      : server_(server), context_(SSL_CTX_new(TLS_server_method())),
        ends_(::eventfd(0, EFD_CLOEXEC)), listener_(tcp_socket()) {
    REQUIRE(SSL_CTX_use_certificate_file(context_, certificate.c_str(), SSL_FILETYPE_PEM) == 1);
    REQUIRE(SSL_CTX_use_PrivateKey_file(context_, key.c_str(), SSL_FILETYPE_PEM) == 1);
    auto at = loopback(0);
    socklen_t size = sizeof at;
    REQUIRE(::bind(listener_, reinterpret_cast<sockaddr*>(&at), size) == 0);
    REQUIRE(::getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size) == 0);
    REQUIRE(::listen(listener_, 4) == 0);
    port_ = ntohs(at.sin_port);
    thread_ = std::thread([this] { run(); });
  }
  ~tls_front() {
    const std::uint64_t one = 1;
    static_cast<void>(!::write(ends_, &one, sizeof one));
    thread_.join();
    ::close(listener_);
    ::close(ends_);
    SSL_CTX_free(context_);
  }
  tls_front(const tls_front&) = delete;
  tls_front& operator=(const tls_front&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Octets that came through TLS.
  [[nodiscard]] std::size_t came() const { return came_; }

private:
  static int tcp_socket() { return ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0); }

  static sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    at.sin_port = htons(port);
    return at;
  }

  void run() {
    for (;;) {
      std::array<pollfd, 2> all{{{ends_, POLLIN, 0}, {listener_, POLLIN, 0}}};
      ::poll(all.data(), all.size(), -1);
      if ((all[0].revents & POLLIN) != 0)
        return;
      const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      if (client < 0)
        continue;
      const timeval long_enough{5, 0}; // a client that says nothing is left
      ::setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &long_enough, sizeof long_enough);
      SSL* const tls = SSL_new(context_);
      SSL_set_fd(tls, client);
      if (SSL_accept(tls) == 1)
        carry(tls, client);
      SSL_free(tls);
      ::close(client);
    }
  }

  void carry(SSL* tls, int client) {
    const int behind = tcp_socket();
    const auto at = loopback(server_);
    std::array<pollfd, 3> all{{{ends_, POLLIN, 0}, {client, POLLIN, 0}, {behind, POLLIN, 0}}};
    std::array<char, 16384> some;
    if (::connect(behind, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0)
      for (;;) {
        const bool is_decrypted = SSL_pending(tls) > 0;
        ::poll(all.data(), all.size(), is_decrypted ? 0 : -1);
        if (all[0].revents != 0)
          break;
        if (is_decrypted || all[1].revents != 0) {
          const int size = SSL_read(tls, some.data(), static_cast<int>(some.size()));
          if (size <= 0 ||
              ::send(behind, some.data(), static_cast<std::size_t>(size), MSG_NOSIGNAL) != size)
            break;
          came_ += static_cast<std::size_t>(size);
        }
        if (all[2].revents != 0) {
          const auto size = ::recv(behind, some.data(), some.size(), 0);
          if (size <= 0 || SSL_write(tls, some.data(), static_cast<int>(size)) != size)
            break;
        }
      }
    ::close(behind);
    SSL_shutdown(tls);
  }

  std::uint16_t server_;
  std::uint16_t port_ = 0;
  SSL_CTX* context_;
  int ends_;
  int listener_;
  std::atomic<std::size_t> came_ = 0;
  std::thread thread_;
};

} // namespace rubicon::test
