#include "imports/gzip.hpp"

#include <array>
#include <cstddef>
#include <new>

#define ZLIB_CONST
#include <zlib.h>

namespace rubicon::imports {

namespace {

constexpr std::string_view magic = "\x1f\x8b";
constexpr std::size_t piece_octets = 65'536;

/// The state of zlib, freed at the end.
class inflater {
public:
  explicit inflater(std::string_view octets) {
    constexpr int gzip_window = 15 + 16; // the largest window; with gzip's header and trailer
    stream_.next_in = reinterpret_cast<const Bytef*>(octets.data());
    stream_.avail_in = static_cast<uInt>(octets.size());
    if (::inflateInit2(&stream_, gzip_window) != Z_OK)
      throw std::bad_alloc();
  }
  ~inflater() { ::inflateEnd(&stream_); }
  inflater(const inflater&) = delete;
  inflater& operator=(const inflater&) = delete;

  /// Appends the next octets of the content. @returns zlib's code
  int next(std::string& to) {
    stream_.next_out = piece_.data();
    stream_.avail_out = static_cast<uInt>(piece_.size());
    const auto code = ::inflate(&stream_, Z_NO_FLUSH);
    to.append(reinterpret_cast<const char*>(piece_.data()), piece_.size() - stream_.avail_out);
    return code;
  }

  [[nodiscard]] std::string_view rest() const {
    return {reinterpret_cast<const char*>(stream_.next_in), stream_.avail_in};
  }

  void begin_member() { ::inflateReset(&stream_); }

private:
  z_stream stream_{};
  std::array<Bytef, piece_octets> piece_;
};

/// Some programs fill the last block of a file.
bool is_padding(std::string_view x) {
  return x.find_first_not_of('\0') == std::string_view::npos;
}

} // namespace

bool is_gzip(std::string_view octets) {
  return octets.starts_with(magic);
}

std::variant<std::string, import_problem> gunzip(std::string_view octets) {
  if (octets.size() > file_octets_max)
    return import_problem{{}, "it has more than 64 MiB"};
  std::string out;
  inflater all(octets);
  for (;;) {
    const auto code = all.next(out);
    if (out.size() > file_octets_max)
      return import_problem{{}, "it has more than 64 MiB when it is decompressed"};
    if (code == Z_STREAM_END && is_padding(all.rest()))
      return out;
    if (code == Z_STREAM_END && is_gzip(all.rest()))
      all.begin_member();
    else if (code == Z_STREAM_END)
      return import_problem{{}, "there is something else behind its compressed content"};
    else if (code == Z_BUF_ERROR) // no input is left
      return import_problem{{}, "its compressed content ends too early"};
    else if (code != Z_OK)
      return import_problem{{}, "its compressed content is damaged"};
  }
}

} // namespace rubicon::imports
