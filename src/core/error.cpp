#include "core/error.hpp"

namespace rubicon {

std::string_view to_string(errc x) {
  switch (x) {
  case errc::truncated:
    return "truncated";
  case errc::too_long:
    return "too_long";
  case errc::bad_checksum:
    return "bad_checksum";
  case errc::bad_value:
    return "bad_value";
  case errc::unsupported:
    return "unsupported";
  }
  return "unknown";
}

} // namespace rubicon
