#include "cli/network/network_text.hpp"

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"
#include "core/text/printable.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

double unix_s(const peis::timestamp& x) {
  return static_cast<double>(x.seconds) + x.microseconds * 1e-6;
}

std::string one_line(const nlohmann::ordered_json& x) {
  return printable_json(json_line(x));
}

} // namespace

std::string value_text(const peis::tuple& x) {
  if (x.form == peis::encoding::text)
    return report::printable(x.text());
  return to_hex(x.value.view());
}

bool is_of_kernel(const peis::tuple& x) {
  return x.name.folded().starts_with("kernel.");
}

nlohmann::ordered_json to_json(const peis::tuple& x) {
  nlohmann::ordered_json out;
  out["owner"] = x.owner.value;
  out["key"] = x.name.text();
  if (x.form == peis::encoding::text)
    out["value"] = std::string(x.text());
  else
    out["value_hex"] = to_hex(x.value.view());
  out["mimetype"] = x.mimetype;
  out["size"] = x.value.size();
  out["creator"] = x.creator.value;
  out["written"] = unix_s(x.written);
  if (x.expiry != peis::never)
    out["expires"] = unix_s(x.expiry);
  return out;
}

std::string line_of(const nlohmann::ordered_json& x) {
  return one_line(x) + "\n";
}

std::string lines_of(const std::vector<nlohmann::ordered_json>& all) {
  std::string text = "[";
  for (std::size_t i = 0; i < all.size(); ++i)
    text += (i == 0 ? "" : ",\n ") + one_line(all[i]);
  return text + "]\n";
}

} // namespace rubicon::cli
