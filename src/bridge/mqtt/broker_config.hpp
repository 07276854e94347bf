// Where an MQTT broker is, and as whom a bridge connects to it.
#pragma once

#include <string>

namespace rubicon::bridge {

struct broker_config {
  std::string address = "127.0.0.1:1883"; ///< HOST:PORT
  std::string client;                     ///< id at the broker; empty: BASE-PEER
  std::string user;                       ///< empty: anonymous
  std::string
      password_file; ///< has the password in its first line; empty: it is in the environment
  bool tls = false;
  std::string authority;   ///< file with certificates that sign the broker's; empty: the system's
  std::string certificate; ///< file with the bridge's own; empty: none
  std::string key;         ///< its key
};

/// Environment variable with the password.
inline constexpr const char* password_variable = "RUBICON_MQTT_PASSWORD";

} // namespace rubicon::bridge
