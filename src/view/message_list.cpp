#include "view/message_list.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "explain/outcome.hpp"
#include "explain/print/text.hpp"

namespace rubicon::view {

namespace {

constexpr duration frame_length = 4ms; ///< of one that nobody received: about 100 octets
constexpr explain::text_style style{100, false};

listed_message listed(const explain::traces& all, const explain::message& x) {
  const auto how = explain::outcome_of(all, x);
  listed_message y{.name = x.name,
                   .source = x.source,
                   .destination = x.destination,
                   .from = all.known.of(x.source),
                   .to = all.known.of(x.destination),
                   .sent = all.nodes[x.root].begin,
                   .ended = x.delivered ? x.delivered : x.failed,
                   .outcome = std::string(to_string(how.status)),
                   .kind = {}};
  if (!how.where.empty())
    y.outcome += ", " + how.where;
  if (!how.why.empty())
    y.outcome += ": " + how.why;
  using status = explain::message_status;
  y.kind = how.status == status::delivered   ? "arrived"
           : how.status == status::in_flight ? "open"
                                             : "lost";
  return y;
}

} // namespace

message_list::message_list(std::shared_ptr<const explain::traces> all, bool is_whole)
    : all_(std::move(all)), is_whole_(is_whole) {
  messages_.reserve(all_->messages.size());
  for (const auto& each : all_->messages)
    messages_.push_back(listed(*all_, each));
  for (const auto& each : all_->nodes) {
    if (each.what != explain::step::hop || each.over != explain::medium::air)
      continue;
    for (const auto& attempt : each.attempts) {
      const auto length =
          attempt.arrived && each.arrived ? *each.arrived - attempt.begin : frame_length;
      frames_.push_back(
          {attempt.begin, std::min(length, frame_length), each.from, each.to, attempt.arrived});
    }
  }
  std::ranges::stable_sort(frames_, {}, &listed_frame::begin);
}

std::string message_list::explain_message(std::string_view name) const {
  const auto found = explain::find(*all_, name);
  if (const auto* message = std::get_if<explain::message_found>(&found))
    return explain::message_text(*all_, message->index, style);
  return "The record has no such message.";
}

std::string message_list::explain_tuple(const std::string& owner, const std::string& key,
                                        instant at) const {
  auto found = explain::find(*all_, key);
  if (std::holds_alternative<explain::nothing_found>(found))
    found = explain::find(*all_, key + '@' + owner);
  const auto* values = std::get_if<explain::tuples_found>(&found);
  if (values == nullptr)
    return "The record has no such tuple.";
  const auto index = explain::value_at(*all_, values->indices, at);
  return index ? explain::tuple_text(*all_, *index, style) : "It had no value at that time.";
}

} // namespace rubicon::view
