// A tuple space alone, what it sends, and a network that acknowledges when it is asked to.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "peis/space/tuple_space.hpp"
#include "peis/wire/package.hpp"
#include "support/catch.hpp"
#include "unit/peis/ids.hpp"

namespace rubicon::peis::test {

inline constexpr duration offset = 1'000'000'000s;

inline key name_of(std::string_view text) {
  return *key::parse(text);
}

inline std::string numbered(std::string_view prefix, std::size_t i) {
  return std::string(prefix) + std::to_string(i);
}

inline bytes joined(bytes head, byte_view body) {
  head.insert(head.end(), body.begin(), body.end());
  return head;
}

inline bytes subscription(std::string_view pattern, std::optional<payload> value = {}) {
  subscribe_message message;
  message.wanted.name = name_of(pattern);
  message.wanted.value = std::move(value);
  return encode(message);
}

inline tuple tuple_of(peer_id owner, std::string_view name, std::size_t size,
                      std::int32_t seqno = 0) {
  tuple x;
  x.owner = x.creator = owner;
  x.name = name_of(name);
  x.form = encoding::binary;
  x.value = payload(bytes(size, 'x'));
  x.written = {1000 + seqno, 0};
  x.seqno = seqno;
  return x;
}

inline bytes message_of(const tuple& x) {
  return joined(encode_tuple_head(x, tuple_message_kind::push), x.value.view());
}

inline bytes append_request_for(std::string_view pattern, std::size_t size) {
  append_request x{prototype_of(me, name_of(pattern)), payload(bytes(size, 'y'))};
  return joined(encode_append_request_head(x), x.added.view());
}

struct lone_space {
  tuple_space x;
  instant now = start;
  std::vector<transmit> sent;  ///< and not acknowledged yet
  std::size_t sent_so_far = 0; ///< all that was ever sent

  /// Hosts 2 to 9 are known to the network.
  explicit lone_space(tuple_space_config config = {}) : x(config, me, offset) {
    for (int host = 2; host < 10; ++host)
      take(x.on_host_appeared(peer_id{host}, false, now));
  }

  std::size_t take(tuple_events events) {
    std::size_t count = 0;
    for (auto& event : events) {
      if (auto* message = std::get_if<transmit>(&event)) {
        sent.push_back(std::move(*message));
        ++count;
      }
    }
    sent_so_far += count;
    return count;
  }
  void set(std::string_view name, std::size_t size = 1) {
    take(x.set(name_of(name), binary_content(bytes(size, 'v')), now).second);
  }
  void fill(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      set(numbered("a.k", i));
  }
  std::size_t subscribe(peer_id who, std::string_view pattern) {
    return take(x.on_message(port::subscribe, who, subscription(pattern), now));
  }
  /// What is due at the next deadline.
  std::size_t turn() {
    now = std::max(now, x.deadline().value_or(now));
    return take(x.on_time(now));
  }
  void acknowledge(std::optional<peer_id> only = {}) {
    for (const auto& message : std::exchange(sent, {})) {
      if (only && message.destination != *only)
        sent.push_back(message);
      else
        take(x.on_delivered(message.request, now));
    }
  }
  void fail(peer_id whose) {
    for (const auto& message : std::exchange(sent, {})) {
      if (message.destination != whose)
        sent.push_back(message);
      else
        x.on_undelivered(whose, message.port, message.content.head.view(), message.request, now);
    }
  }
  void fail_all() {
    for (const auto& message : std::exchange(sent, {}))
      x.on_undelivered(message.destination, message.port, message.content.head.view(),
                       message.request, now);
  }
  std::size_t set_by(peer_id who, std::string_view name, std::size_t size) {
    return take(x.on_set(who, tuple_of(me, name, size), true, now));
  }
  /// Until everything is acknowledged and nothing is due within a second.
  void work_off(int turns = 10'000) {
    const auto due = [&] { return x.deadline() && *x.deadline() < now + 900ms; };
    for (; turns > 0 && (due() || !sent.empty()); --turns) {
      if (due())
        turn();
      acknowledge();
    }
    CHECK(turns > 0);
  }
  [[nodiscard]] tuple_counters counted() const { return x.counters(); }
};

} // namespace rubicon::peis::test
