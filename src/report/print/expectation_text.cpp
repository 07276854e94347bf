// How expectations read.
#include <cmath>
#include <variant>

#include "core/text/decimal.hpp"
#include "report/expect/expectations.hpp"
#include "report/figures.hpp"

namespace rubicon::report {

namespace {

/// `99.9%`: as the file's author thinks of it, without what binary fractions add.
std::string share(double x) {
  return shortest_decimal(std::round(x * 1e8) / 1e6) + '%';
}

std::string scope(const config::mote_scope& x) {
  return x.name == "*" ? "" : ' ' + x.name;
}

std::string condition(const config::tuple_condition& x) {
  auto text = '"' + x.key + '"';
  for (std::size_t i = 0; i < x.equals.size(); ++i)
    text += (i == 0 ? " = \"" : " or \"") + x.equals[i] + '"';
  if (x.above)
    text += " >= " + shortest_decimal(*x.above);
  if (x.below)
    text += (x.above ? " and < " : " < ") + shortest_decimal(*x.below);
  return text;
}

struct writer {
  std::string operator()(const config::delivery_expectation& x) const {
    return "delivery" + scope(x.of) + " >= " + share(x.at_least);
  }
  std::string operator()(const config::acknowledged_expectation& x) const {
    return "acknowledged" + scope(x.of) + " >= " + share(x.at_least);
  }
  std::string operator()(const config::stream_expectation& x) const {
    return "stream " + std::to_string(x.stream) + " to " + x.to_name + " >= " + share(x.at_least) +
           (x.pause ? ", no pause > " + rubicon::to_text(*x.pause) : "") +
           (x.first_within ? ", the first within " + rubicon::to_text(*x.first_within) : "");
  }
  std::string operator()(const config::actuations_expectation& x) const {
    return (x.count > 1 ? with_thousands(x.count) + " actuations" : std::string("actuations")) +
           (x.proxy == "*" ? "" : ' ' + x.proxy) + " >= " + share(x.at_least);
  }
  std::string operator()(const config::tuple_expectation& x) const {
    return condition(x.then) + " within " + rubicon::to_text(x.within) +
           (x.when ? " of " + condition(*x.when) : "");
  }
  std::string operator()(const config::clock_expectation& x) const {
    return "clock" + scope(x.of) + " <= " + rubicon::to_text(x.at_most) +
           (x.share < 1 ? " in " + share(x.share) : "");
  }
  std::string operator()(const config::joined_expectation& x) const {
    return "joined" + scope(x.of) + " within " + rubicon::to_text(x.within);
  }
  std::string operator()(const config::members_expectation& x) const {
    return "members" + scope(x.of) +
           (x.at_least ? " >= " + with_thousands(*x.at_least) : std::string(": all"));
  }
  std::string operator()(const config::battery_expectation& x) const {
    return "battery" + scope(x.of) + " >= " + share(x.at_least);
  }
  std::string operator()(const config::radio_expectation& x) const {
    return "radio" + scope(x.of) + " <= " + share(x.at_most);
  }
  std::string operator()(const config::vectors_expectation& x) const {
    return "vectors missed" + (x.node == "*" ? "" : ' ' + x.node) +
           " <= " + with_thousands(x.missed) +
           (x.from > 0s ? " after " + rubicon::to_text(x.from) : "");
  }
  std::string operator()(const config::events_expectation& x) const {
    return "events <= " + with_thousands(x.at_most);
  }
  std::string operator()(const config::event_log_expectation& x) const {
    return "event log" + (x.who.empty() ? "" : " of " + x.who) + " has \"" + x.text +
           "\" >= " + with_thousands(x.at_least) +
           (x.at_most ? ", <= " + with_thousands(*x.at_most) : "");
  }
  std::string operator()(const config::sometimes_expectation& x) const {
    return std::string(sometimes) + x.name;
  }
};

} // namespace

std::string to_text(const config::expectation& x) {
  return std::visit(writer{}, x);
}

} // namespace rubicon::report
