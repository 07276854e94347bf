#include "peis/wire/package_walk.hpp"

#include <algorithm>

#include "peis/wire/package.hpp"

namespace rubicon::peis {

namespace {

/// The size of the package that `octets` begins with; 0 if there is no whole one.
std::size_t package_size(byte_view octets) {
  const auto header = decode_header(octets);
  if (!header || header_size + header->length > octets.size())
    return 0;
  return header_size + header->length;
}

} // namespace

thinned without_lost_packages(byte_view octets, std::size_t kept,
                              const std::function<bool()>& is_lost) {
  thinned out;
  out.octets.reserve(octets.size());
  const auto take = [&octets](bytes& into, std::size_t count) {
    const auto part = octets.first(count);
    into.insert(into.end(), part.begin(), part.end());
    octets = octets.subspan(count);
  };
  take(out.octets, std::min(kept, octets.size()));
  while (!octets.empty()) {
    const auto size = package_size(octets);
    if (size == 0) {
      take(out.octets, octets.size());
    } else if (is_lost()) {
      take(out.lost_octets, size);
      ++out.lost;
    } else
      take(out.octets, size);
  }
  return out;
}

} // namespace rubicon::peis
