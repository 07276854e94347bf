// A list of revoked certificates that somebody sends to a host: the first octet says whether the
// rest is PEM or what PEM would stand for. None that the authority has not signed is taken.
#include <algorithm>
#include <string>
#include <string_view>

#include "core/bytes.hpp"
#include "io/files/temporary_folder.hpp"
#include "io/tls/certificates.hpp"
#include "io/tls/revocations.hpp"

#include "fuzz/require.hpp"

using namespace rubicon;

namespace {

struct authority {
  authority() { require(io::make_authority(path, {}, io::system_time()).index() == 0); }

  const io::temporary_folder folder{"rubicon-fuzz"};
  const std::string path = (folder.path() / "certs").string();
};

std::string base64(byte_view octets) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  constexpr std::size_t line = 48; // octets
  std::string out;
  for (std::size_t i = 0; i < octets.size(); i += 3) {
    const auto some = octets.subspan(i, std::min<std::size_t>(3, octets.size() - i));
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8U | (k < some.size() ? some[k] : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= some.size() ? digits[bits >> (18 - 6 * k) & 63U] : '=';
    if (i % line == line - 3)
      out += '\n';
  }
  return out + '\n';
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const authority ours;
  if (size == 0)
    return 0;
  const byte_view rest(data + 1, size - 1);
  const std::string text =
      data[0] % 2 == 0 ? std::string(rest.begin(), rest.end())
                       : "-----BEGIN X509 CRL-----\n" + base64(rest) + "-----END X509 CRL-----\n";
  const auto found =
      io::revocation_list::read(text, ours.path + "/ca.crt", io::system_time(), true);
  require(found.index() == 1);
  require(!std::get<std::string>(found).empty());
  return 0;
}
