// Segments as the other end of a conversation would write them.
#pragma once

#include <utility>

#include "transport/segment.hpp"

namespace rubicon::test {

/// Nobody waits for an answer to it.
inline transport::segment plain(mote_id source, std::uint8_t am_type, bytes payload) {
  transport::segment x;
  x.source = source;
  x.am_type = am_type;
  x.payload = std::move(payload);
  return x;
}

/// A first incarnation's, for a first incarnation. @param counter of the hello before it, and one
inline transport::segment reliable(mote_id source, std::uint16_t counter, std::uint8_t am_type,
                                   bytes payload) {
  auto x = plain(source, am_type, std::move(payload));
  x.counter = counter;
  x.what = transport::segment::kind::reliable;
  return x;
}

inline transport::segment hello(mote_id source, std::uint16_t counter, std::uint8_t am_type) {
  auto x = plain(source, am_type, {});
  x.counter = counter;
  x.what = transport::segment::kind::hello;
  return x;
}

/// What a first incarnation of `source` answers to a hello or a reliable segment that it accepts.
inline transport::segment acknowledgement(mote_id source, const transport::segment& of) {
  auto x = plain(source, of.am_type, {});
  x.counter = of.counter;
  x.sender = of.sender;
  x.what = transport::segment::kind::acknowledgement;
  return x;
}

} // namespace rubicon::test
