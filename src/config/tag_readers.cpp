#include <utility>

#include "config/file_readers.hpp"
#include "config/model_readers.hpp"

namespace rubicon::config {

rfid::reader_config read_rfid_reader(table_reader& in, std::string_view peer_name) {
  rfid::reader_config out;
  out.name = peer_name;
  in.optional("name", name_text{}, out.name);
  in.required("position_m", config::place{}, out.place);
  in.optional("range", metres{0.05, 100}, out.range_m);
  in.optional("period", time_span{10ms, 1h}, out.period);
  in.optional("miss_rate", ratio{}, out.miss_rate);
  in.optional("missed_max", whole<unsigned>{1, 1000}, out.missed_max);
  return out;
}

std::vector<tag_description> read_tags(table_reader& root) {
  std::vector<tag_description> out;
  name_claims ids;
  root.tables("tag", "[[tag]]", [&](table_reader& in) {
    tag_description found;
    if (in.required("id", name_text{}, found.id))
      ids.claim(found.id, "tag", in.at("id"), in.problems());
    found.id = folded(found.id);
    in.optional("memory", hex_octets{}, found.memory);
    const bool has_place = in.has("path") ? in.optional("position_m", place{}, found.place)
                                          : in.required("position_m", place{}, found.place);
    read_path(in, has_place, found.place, found.path);
    out.push_back(std::move(found));
  });
  return out;
}

} // namespace rubicon::config
