#include "cli/options/serial_command_line.hpp"

#include <charconv>
#include <functional>
#include <string>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>

#include "cli/options/add_option.hpp"
#include "cli/options/option_values.hpp"
#include "config/toml/units.hpp"
#include "core/text/ipv4_network.hpp"
#include "serial/packet.hpp"

namespace rubicon::cli {

namespace {

/// Decimal, or hexadecimal behind 0x.
template <class Number>
Number parse_number(const char* name, const std::string& text, Number least, Number most) {
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  const auto* begin = text.data() + (hex ? 2 : 0);
  const auto* end = text.data() + text.size();
  std::uint64_t x = 0;
  const auto [stop, error] = std::from_chars(begin, end, x, hex ? 16 : 10);
  if (error != std::errc{} || stop != end || x < least || x > most)
    throw CLI::ValidationError(name, "not a number from " + std::to_string(least) + " to " +
                                         std::to_string(most) + ": '" + text + '\'');
  return static_cast<Number>(x);
}

/// `sf@HOST`, `sf@HOST:PORT`, or the path of a serial port.
void parse_source(const std::string& text, serial_command& out) {
  if (!text.starts_with("sf@")) {
    out.device = text;
    return;
  }
  const auto rest = text.substr(3);
  const auto colon = rest.rfind(':');
  out.host = rest.substr(0, colon);
  if (out.host.empty())
    throw CLI::ValidationError("SOURCE", "not sf@HOST:PORT: '" + text + '\'');
  if (colon != std::string::npos)
    out.port = parse_number<std::uint16_t>("SOURCE", rest.substr(colon + 1), 1, 65535);
}

void parse_listener(const std::string& text, forward_serial& out) {
  const auto colon = text.rfind(':');
  out.address = text.substr(0, colon);
  if (colon == std::string::npos || !parse_ipv4_address(out.address))
    throw CLI::ValidationError("ADDRESS:PORT",
                               "not an IPv4 address of this computer and a port: '" + text + '\'');
  out.port = parse_number<std::uint16_t>("ADDRESS:PORT", text.substr(colon + 1), 1, 65535);
}

bytes parse_payload(const std::string& text) {
  auto found = from_hex(text);
  if (!found || found->size() > serial::am_payload_max)
    throw CLI::ValidationError("PAYLOAD", "not up to " + std::to_string(serial::am_payload_max) +
                                              " octets in hexadecimal: '" + text + '\'');
  return *std::move(found);
}

} // namespace

/// For commands that write to a mote.
void serial_command_line::add_payload_max(CLI::App& app) {
  add_parsed(app, "--payload", "N",
             "Longest AM payload that the mote is compiled for; default: 28, as in TinyOS. A "
             "longer one is refused: a BaseStation would accept nothing after it",
             [this](const auto& text) {
               with_.payload_max =
                   parse_number<std::size_t>("--payload", text, 1, serial::am_payload_max);
             });
}

CLI::App& serial_command_line::add(CLI::App& below, const char* name, const char* text) {
  auto& app = *below.add_subcommand(name, text);
  add_parsed(app, "SOURCE", "", "A serial port such as /dev/ttyUSB0, or sf@HOST:PORT, a forwarder",
             [this](const auto& words) { parse_source(words, with_); })
      ->required();
  add_parsed(app, "--baud", "RATE", "Of the port: micaz, iris, telosb or a number; default: micaz",
             [this](const auto& words) {
               const bool is_number = words.find_first_not_of("0123456789") == std::string::npos;
               const auto rate = config::parse_baud(is_number ? words + "baud" : words);
               if (!rate || *rate < 300 || *rate > 4'000'000)
                 throw CLI::ValidationError("--baud",
                                            "neither a platform nor a rate: '" + words + '\'');
               with_.baud = static_cast<std::uint32_t>(*rate);
             });
  return app;
}

serial_command_line::serial_command_line(CLI::App& app) {
  auto& serial =
      *app.add_subcommand("serial", "Receive from and send to a sink, without an ecology");
  serial.require_subcommand(1);

  auto& listened = add(serial, "listen", "Print the packets of a sink");
  listen_app_ = &listened;
  add_parsed(listened, "--for", "TIME", "End after this time; at Ctrl-C if not given",
             [this](const auto& text) { listen_.length = parse_length(text); });
  add_parsed(listened, "--count", "N", "End after this many packets", [this](const auto& text) {
    listen_.count = parse_number<std::uint64_t>("--count", text, 1, UINT64_MAX);
  });
  listened.add_flag("--json", listen_.json, "Print a JSON object for each packet");

  auto& sent = add(serial, "send", "Send an active message to a sink, which acknowledges it");
  send_app_ = &sent;
  add_parsed(sent, "TYPE", "", "AM type", [this](const auto& text) {
    send_.am_type = parse_number<std::uint8_t>("TYPE", text, 0, 255);
  })->required();
  add_parsed(sent, "PAYLOAD", "", "In hexadecimal; default: none",
             [this](const auto& text) { send_.payload = parse_payload(text); });
  add_parsed(sent, "--to", "ID", "The mote that the sink sends it to; default: all",
             [this](const auto& text) {
               send_.destination = parse_number<std::uint16_t>("--to", text, 0, 65535);
             });
  add_parsed(sent, "--group", "N", "AM group; default: 0x22", [this](const auto& text) {
    send_.group = parse_number<std::uint8_t>("--group", text, 0, 255);
  });
  add_payload_max(sent);

  auto& forwarded = add(serial, "forward", "Run a serial forwarder for programs of TinyOS");
  forward_app_ = &forwarded;
  add_payload_max(forwarded);
  add_parsed(forwarded, "ADDRESS:PORT", "",
             "Address for their connections; default: 127.0.0.1:9002",
             [this](const auto& text) { parse_listener(text, forward_); });
  add_parsed(forwarded, "--for", "TIME", "End after this time; at Ctrl-C if not given",
             [this](const auto& text) { forward_.length = parse_length(text); });
}

std::optional<serial_command> serial_command_line::parsed() const {
  auto out = with_;
  if (listen_app_->parsed())
    out.what = listen_;
  else if (send_app_->parsed())
    out.what = send_;
  else if (forward_app_->parsed())
    out.what = forward_;
  else
    return std::nullopt;
  return out;
}

} // namespace rubicon::cli
