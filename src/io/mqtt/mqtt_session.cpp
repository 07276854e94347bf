#include "io/mqtt/mqtt_session.hpp"

#include <array>
#include <cerrno>
#include <mutex>
#include <system_error>
#include <utility>

#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <unistd.h>

namespace rubicon::io {

namespace {

constexpr int keep_alive_s = 15;
constexpr int wait_max_ms = 500;
constexpr std::uint32_t packet_max = mqtt_client::payload_max + 1024; ///< with topic and header

void begin_library() {
  static std::once_flag once;
  std::call_once(once, [] { mosquitto_lib_init(); });
}

std::string text_of(int error) {
  return error == MOSQ_ERR_ERRNO ? std::generic_category().message(errno)
                                 : std::string(mosquitto_strerror(error));
}

const char* given(const std::string& x) {
  return x.empty() ? nullptr : x.c_str();
}

/// Of a key that is encrypted: nobody is asked for its password.
int no_key_password(char* /*to*/, int /*size*/, int /*writes*/, void* /*user*/) {
  return 0;
}

} // namespace

mqtt_session::~mqtt_session() {
  if (client_ != nullptr)
    mosquitto_destroy(client_);
}

void mqtt_session::on_answer(int reason) {
  connected_ = reason == 0;
  refused_ = !connected_;
  if (refused_)
    refusal_ = std::string("refused by the broker: ") + mosquitto_reason_string(reason);
}

void mqtt_session::on_message(const mosquitto_message& x) {
  const auto size = static_cast<std::size_t>(x.payloadlen);
  if (size > mqtt_client::payload_max) {
    ++oversized_;
    return;
  }
  on_message_({x.topic, std::string(static_cast<const char*>(x.payload), size), x.retain});
}

std::string mqtt_session::set_up(const mqtt_client_settings& x) {
  mosquitto_connect_callback_set(client_, [](::mosquitto*, void* self, int reason) {
    static_cast<mqtt_session*>(self)->on_answer(reason);
  });
  mosquitto_message_callback_set(client_,
                                 [](::mosquitto*, void* self, const mosquitto_message* message) {
                                   static_cast<mqtt_session*>(self)->on_message(*message);
                                 });
  int error = mosquitto_int_option(client_, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
  if (error == 0)
    error = mosquitto_int_option(client_, MOSQ_OPT_TCP_NODELAY, 1);
  if (error == 0)
    error =
        mosquitto_will_set(client_, x.will_topic.c_str(), static_cast<int>(x.will_payload.size()),
                           x.will_payload.data(), 0, true);
  if (error == 0 && !x.user.empty())
    error = mosquitto_username_pw_set(client_, x.user.c_str(), x.password.c_str());
  if (error == 0 && x.tls && x.authority.empty())
    error = mosquitto_int_option(client_, MOSQ_OPT_TLS_USE_OS_CERTS, 1);
  if (error == 0 && x.tls && (!x.authority.empty() || !x.certificate.empty()))
    error = mosquitto_tls_set(client_, given(x.authority),
                              x.authority.empty() ? "/etc/ssl/certs" : nullptr,
                              given(x.certificate), given(x.key), no_key_password);
  return error == 0 ? std::string() : text_of(error);
}

std::string mqtt_session::open(const mqtt_client_settings& x) {
  begin_library();
  client_ = mosquitto_new(x.client.c_str(), true, this);
  if (client_ == nullptr)
    return std::generic_category().message(errno);
  if (auto why = set_up(x); !why.empty())
    return why;
  mosquitto_property* properties = nullptr;
  int error = mosquitto_property_add_int32(&properties, MQTT_PROP_MAXIMUM_PACKET_SIZE, packet_max);
  if (error == 0)
    error = mosquitto_connect_bind_v5(client_, x.host.c_str(), x.port, keep_alive_s, nullptr,
                                      properties);
  auto why = error == 0 ? std::string() : text_of(error);
  mosquitto_property_free_all(&properties);
  return why;
}

void mqtt_session::close() {
  if (client_ != nullptr)
    mosquitto_disconnect_v5(client_, MQTT_RC_DISCONNECT_WITH_WILL_MSG, nullptr);
}

bool mqtt_session::wants_write() const {
  auto* const tls = static_cast<SSL*>(mosquitto_ssl_get(client_));
  if (tls != nullptr && SSL_is_init_finished(tls) == 0)
    return SSL_want_write(tls);
  return mosquitto_want_write(client_);
}

bool mqtt_session::is_free() const {
  return connected_ && !mosquitto_want_write(client_);
}

bool mqtt_session::send(const mqtt_request& x) {
  switch (x.what) {
  case mqtt_request::kind::publish:
    return mosquitto_publish(client_, nullptr, x.topic.c_str(), static_cast<int>(x.payload.size()),
                             x.payload.data(), 0, true) == 0;
  case mqtt_request::kind::subscribe:
    return mosquitto_subscribe_v5(client_, nullptr, x.topic.c_str(), 0, MQTT_SUB_OPT_NO_LOCAL,
                                  nullptr) == 0;
  case mqtt_request::kind::unsubscribe:
    return mosquitto_unsubscribe(client_, nullptr, x.topic.c_str()) == 0;
  }
  return false;
}

/// What TLS has decrypted already does not make the socket readable.
int mqtt_session::read(bool reads) {
  int error = mosquitto_loop_read(client_, 1);
  auto* const tls = static_cast<SSL*>(mosquitto_ssl_get(client_));
  for (int i = 0; i < 64 && reads && error == 0 && tls != nullptr && SSL_pending(tls) > 0; ++i)
    error = mosquitto_loop_read(client_, 1);
  return error;
}

std::string mqtt_session::serve(int wake, bool reads) {
  const int socket = mosquitto_socket(client_);
  if (socket < 0)
    return refused_ ? refusal_ : "the connection is closed";
  auto* const tls = static_cast<SSL*>(mosquitto_ssl_get(client_));
  const bool decrypted = reads && tls != nullptr && SSL_pending(tls) > 0;
  const int wanted = (reads ? POLLIN : 0) | (wants_write() ? POLLOUT : 0);
  std::array<pollfd, 2> all{{{socket, static_cast<short>(wanted), 0}, {wake, POLLIN, 0}}};
  if (::poll(all.data(), all.size(), decrypted ? 0 : wait_max_ms) < 0 && errno != EINTR)
    return std::generic_category().message(errno);
  std::uint64_t ignored = 0;
  if ((all[1].revents & POLLIN) != 0)
    static_cast<void>(!::read(wake, &ignored, sizeof ignored));
  int error = 0;
  if (decrypted || (all[0].revents & (POLLIN | POLLHUP | POLLERR)) != 0)
    error = read(reads);
  if (error == 0 && (all[0].revents & POLLOUT) != 0)
    error = mosquitto_loop_write(client_, 1);
  if (error == 0)
    error = mosquitto_loop_misc(client_);
  if (refused_)
    return refusal_;
  return error == 0 ? std::string() : text_of(error);
}

} // namespace rubicon::io
