// Files that are compressed, or say so: what they hold is never more than an import may have, and
// what is compressed here comes back whole, or not at all where a part of it is missing.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#define ZLIB_CONST
#include <zlib.h>

#include "fuzz/require.hpp"
#include "imports/gzip.hpp"

using namespace rubicon::imports;

namespace {

std::string compressed(std::string_view content) {
  z_stream stream{};
  constexpr int gzip_window = 15 + 16;
  require(::deflateInit2(&stream, 1, Z_DEFLATED, gzip_window, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string out(::deflateBound(&stream, static_cast<uLong>(content.size())), '\0');
  stream.next_in = reinterpret_cast<const Bytef*>(content.data());
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  require(::deflate(&stream, Z_FINISH) == Z_STREAM_END);
  out.resize(out.size() - stream.avail_out);
  ::deflateEnd(&stream);
  return out;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view octets(reinterpret_cast<const char*>(data), size);
  const auto found = gunzip(octets);
  if (const auto* content = std::get_if<std::string>(&found))
    require(is_gzip(octets) && content->size() <= file_octets_max);
  else
    require(!std::get<import_problem>(found).message.empty());

  const auto whole = compressed(octets);
  require(is_gzip(whole));
  const auto again = gunzip(whole);
  require(std::holds_alternative<std::string>(again) && std::get<std::string>(again) == octets);
  const auto cut = size == 0 ? 0 : data[size - 1] * (whole.size() - 1) / 255;
  require(std::holds_alternative<import_problem>(gunzip(std::string_view(whole).substr(0, cut))));
  return 0;
}
