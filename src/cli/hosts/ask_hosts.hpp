// One question to several hosts at the same time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "cli/hosts/deployed.hpp"
#include "control/system.hpp"
#include "deploy/messages.hpp"

namespace rubicon::cli {

/// Waits for all of them.
/// @returns the answer of each host, in their order, or why there is none
[[nodiscard]] std::vector<std::variant<deploy::answer, std::string>>
ask_each(control::system& actors, const std::vector<deployed_host>& hosts,
         const std::function<deploy::question(const deployed_host&)>& what);

/// The same with the answers of one kind of question. @param what makes it for a host
template <class Make>
[[nodiscard]] auto ask_hosts(control::system& actors, const std::vector<deployed_host>& hosts,
                             const Make& what) {
  using answer = typename std::invoke_result_t<Make, const deployed_host&>::answer;
  std::vector<std::variant<answer, std::string>> out;
  for (auto& each : ask_each(actors, hosts, what)) {
    if (auto* why = std::get_if<std::string>(&each))
      out.emplace_back(std::move(*why));
    else
      out.emplace_back(std::get<answer>(std::get<deploy::answer>(std::move(each))));
  }
  return out;
}

using received_verdict = std::variant<deploy::verdict, std::string>;

/// `rubicon host --name kitchen --listen 192.168.1.5:4242`, to be started there; with files as
/// `rubicon certs` names them if whoever asks has certificates.
[[nodiscard]] std::string host_command_line(const deployed_host& host, bool with_certificates);

/// Why a host refuses, or why it did not answer.
[[nodiscard]] std::vector<std::string> problems_of(const received_verdict& x);

struct received_facts {
  deploy::host_facts facts;
  double clock_ahead_s = 0; ///< of ours
};

[[nodiscard]] std::vector<std::variant<received_facts, std::string>>
ask_facts_of(control::system& actors, const std::vector<deployed_host>& hosts);

} // namespace rubicon::cli
