#include "radio/channel/output.hpp"

namespace rubicon::radio {

std::string to_string(power x) {
  switch (x) {
  case power::on:
    return "on";
  case power::off:
    return "off";
  case power::flat:
    return "flat";
  }
  return "unknown";
}

} // namespace rubicon::radio
