#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "core/text/name.hpp"
#include "imports/plan.hpp"

namespace rubicon::imports {

namespace {

/// The shortest text, with at most 6 digits behind the point.
std::string decimal(double x) {
  constexpr double millionth = 1e6;
  const auto rounded = std::round(x * millionth) / millionth;
  char digits[64];
  const auto end = std::to_chars(digits, digits + sizeof digits, rounded == 0 ? 0.0 : rounded,
                                 std::chars_format::fixed);
  return {digits, end.ptr};
}

std::string place_text(point x) {
  return '[' + decimal(x.x_m) + ", " + decimal(x.y_m) +
         (x.z_m != 0 ? ", " + decimal(x.z_m) : std::string()) + ']';
}

std::string time_text(duration x) {
  return '"' + std::to_string(std::chrono::floor<std::chrono::milliseconds>(x).count()) + "ms\"";
}

/// Characters of a name; all others become dashes.
std::string as_name(std::string_view text, std::string_view otherwise) {
  constexpr std::size_t length_max = 24;
  std::string out;
  for (const char c : text.substr(0, length_max))
    out += is_name_character(c) ? c : '-';
  return out.empty() || out.find_first_not_of('-') == std::string::npos ? std::string(otherwise)
                                                                        : out;
}

/// No mote may have it, in any letter case.
bool stands_for_sink(std::string_view name) {
  return std::ranges::equal(name, std::string_view("sink"), {}, [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
}

/// Text within a comment.
std::string in_comment(std::string_view text) {
  std::string out;
  for (const char c : text)
    out += c >= ' ' && c <= '~' ? c : '?';
  return out;
}

class toml_text {
public:
  toml_text(const imported& x, std::string_view source, std::string_view topology)
      : all_(x), plan_(x.plan), sink_(x.sink), source_(source), topology_(topology) {}

  std::string write(format from) {
    name_motes();
    head(from);
    ecology();
    std::visit([this](const auto& air) { radio(air); }, plan_.air);
    for (const auto& each : plan_.links)
      link(each);
    island();
    for (std::size_t i = 0; i < plan_.motes.size(); ++i)
      if (i != sink_)
        mote(i);
    for (const auto& each : plan_.changes)
      change(each);
    return std::move(out_);
  }

private:
  /// 0 is no mote's id: all are higher by one then.
  [[nodiscard]] std::uint32_t id_of(std::size_t i) const {
    return plan_.motes[i].number + (plan_.motes.front().number == 0 ? 1 : 0);
  }

  void name_motes() {
    std::set<std::string> taken;
    for (std::size_t i = 0; i < plan_.motes.size(); ++i) {
      const auto& x = plan_.motes[i];
      const auto plain = "node-" + std::to_string(x.number);
      auto name = x.name.empty() ? plain : as_name(x.name, plain);
      while (stands_for_sink(name) || !taken.insert(name).second)
        name += '-' + std::to_string(x.number);
      names_.push_back(i == sink_ ? "sink" : std::move(name));
    }
  }

  void line(const std::string& text) { out_ += text + '\n'; }

  void head(format from) {
    line("# Imported from " + in_comment(source_) + " (" + std::string(to_string(from)) + ").");
    if (!all_.notes.empty())
      line("# Not taken:");
    for (const auto& each : all_.notes)
      line("# - " + in_comment(each.what) +
           (each.at.line == 0 ? std::string() : " (line " + std::to_string(each.at.line) + ')'));
    line("#\n# The sink is " +
         (plan_.motes[sink_].name.empty() ? "node " + std::to_string(plan_.motes[sink_].number)
                                          : in_comment(plan_.motes[sink_].name)) +
         "; the program of the motes is an example.\n");
  }

  void ecology() {
    line("[ecology]");
    line("name = \"" + as_name(plan_.title, "imported") + '"');
    if (plan_.seed)
      line("seed = " + std::to_string(*plan_.seed));
    line("duration = \"" +
         std::to_string(std::chrono::ceil<std::chrono::seconds>(plan_.length).count()) + "s\"\n");
  }

  void radio(const disk& x) {
    line("[radio]");
    line("range = \"" + decimal(x.range_m) + "m\"");
    if (x.loss > 0)
      line("loss = " + decimal(x.loss));
    line("");
  }

  void radio(const listed_links&) {
    line("[radio.propagation]              # only the links below exist");
    line("model = \"log_distance\"");
    line("reference = \"200dB\"\n");
  }

  void radio(const topology_file& x) {
    line("[radio]                          # as TOSSIM has it");
    line("curve = \"tossim\"\nsensitivity = \"-110dBm\"\ncca_threshold = \"-72dBm\"");
    line("sensing = \"energy\"\ncutoff = \"-120dBm\"\n");
    line("[radio.propagation]\nmodel = \"gains\"");
    std::string escaped;
    for (const char c : topology_)
      escaped += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
    line("topology = \"" + escaped + '"');
    line("first_mote = " + std::string(x.first_node == 0 ? "1" : "0") + '\n');
    if (x.has_noise)
      line("[radio.noise]\nmodel = \"table\"\n");
  }

  [[nodiscard]] std::string ends(std::size_t from, std::size_t to) const {
    return "from = \"island/" + names_[from] + "\"\nto = \"island/" + names_[to] + "\"";
  }

  void link(const planned_link& x) {
    line("[[radio.link]]\n" + ends(x.from, x.to));
    if (x.loss)
      line("loss = " + decimal(*x.loss));
    if (x.gain_db)
      line("gain = \"" + decimal(*x.gain_db) + "dB\"");
    line("");
  }

  void island() {
    const auto& sink = plan_.motes[sink_];
    line("[mote_type.node]\ntype = 1");
    line("transducers.temperature = { model = \"constant\", value = 20.0, noise = 0.2, "
         "resolution = 0.1 }");
    line("apps = [{ app = \"sampler\", transducers = [\"temperature\"], every = \"30s\", "
         "jitter = \"10s\" }]\n");
    line("[[island]]\nid = 1\nname = \"island\"\n");
    line("[island.sink]\nid = " + std::to_string(id_of(sink_)));
    if (!std::holds_alternative<topology_file>(plan_.air))
      line("position_m = " + place_text(sink.place));
    line("");
  }

  void mote(std::size_t i) {
    const auto& x = plan_.motes[i];
    line("[[island.mote]]\nid = " + std::to_string(id_of(i)) + "\nname = \"" + names_[i] +
         "\"\ntype = \"node\"");
    if (!x.platform.empty())
      line("platform = \"" + x.platform + '"');
    if (!std::holds_alternative<topology_file>(plan_.air))
      line("position_m = " + place_text(x.place));
    std::string path;
    for (const auto& [at, where] : x.path)
      if (at > duration{}) // before that, position_m
        path += (path.empty() ? "[" : ", [") + time_text(at) + ", " + place_text(where) + ']';
    if (!path.empty())
      line("path = [" + path + ']');
    line("");
  }

  void change(const link_at& x) {
    line("[[change]]\nat = " + time_text(x.at) + "\nkind = \"link\"\n" + ends(x.from, x.to) +
         "\nloss = " + decimal(x.loss) + '\n');
  }

  const imported& all_;
  const ecology_plan& plan_;
  std::size_t sink_;
  std::string_view source_;
  std::string_view topology_;
  std::string out_;
  std::vector<std::string> names_;
};

} // namespace

std::string toml_of(const imported& x, format from, std::string_view source,
                    std::string_view topology) {
  return toml_text(x, source, topology).write(from);
}

std::string notes_text(const imported& x, std::string_view source) {
  std::string out;
  for (const auto& each : x.notes) {
    out += source;
    if (each.at.line > 0)
      out += ':' + std::to_string(each.at.line) + ':' + std::to_string(each.at.column);
    out += ": not taken: " + each.what + '\n';
  }
  return out;
}

} // namespace rubicon::imports
