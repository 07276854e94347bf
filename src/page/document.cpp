#include "page/markup.hpp"
#include "page/parts.hpp"
#include "report/figures.hpp"

namespace rubicon::page {

namespace {

/// Colours that remain distinct to the colour-blind (Okabe and Ito), lighter ones on dark.
constexpr std::string_view style = R"(
:root{--bg:#fff;--fg:#1b1f24;--soft:#57606a;--line:#d5dae0;--panel:#f5f7f9;--good:#0072b2;--fair:#3f9fd8;
--poor:#c98500;--bad:#d55e00;--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#cc79a7;--c4:#c98500;--c5:#56b4e9}
@media (prefers-color-scheme:dark){:root{--bg:#14171a;--fg:#e8eaed;--soft:#a6afb9;--line:#3a424b;--panel:#1d2227;
--good:#5ab4f0;--fair:#a3d6f7;--poor:#f0b429;--bad:#ff8a4c;--c0:#5ab4f0;--c1:#ff8a4c;--c2:#3fc79a;--c3:#e5a3c6;
--c4:#f0b429;--c5:#a3d6f7}}
*{box-sizing:border-box}
body{margin:0;background:var(--bg);color:var(--fg);font:15px/1.5 system-ui,sans-serif}
main{max-width:1180px;margin:0 auto;padding:16px}
h1{margin:0;font-size:1.7em;line-height:1.2;overflow-wrap:anywhere}
h2{margin:0 0 10px;font-size:1.15em}
h3{margin:12px 0 4px;font-size:1em}
section{margin:26px 0;border-top:1px solid var(--line);padding-top:14px}
p{margin:6px 0}
.soft,figcaption{color:var(--soft)}
.verdict{display:inline-block;margin:10px 0;padding:3px 12px;border-radius:5px;font-weight:600;color:var(--bg);
background:var(--good)}
.verdict.no{background:var(--bad)}
pre{margin:8px 0;padding:8px 12px;background:var(--panel);border:1px solid var(--line);border-radius:5px;
white-space:pre-wrap;overflow-wrap:anywhere;font-size:.9em}
.facts{display:flex;flex-wrap:wrap;gap:10px;margin:14px 0 0;padding:0}
.facts div{background:var(--panel);border:1px solid var(--line);border-radius:5px;padding:6px 12px;min-width:104px}
.facts dt{color:var(--soft);font-size:.85em}
.facts dd{margin:0;font-size:1.25em;font-weight:600;font-variant-numeric:tabular-nums}
.wide{overflow-x:auto}
.grid{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,330px),1fr));gap:14px}
figure{margin:0}
svg{display:block;width:100%;height:auto;font:12px system-ui,sans-serif}
.wide svg{min-width:860px}
svg text{fill:var(--fg)}
svg .soft{fill:var(--soft)}
.map text{font-size:15px;paint-order:stroke;stroke:var(--panel);stroke-width:4px;stroke-linejoin:round}
svg .grid{stroke:var(--line);stroke-width:1}
svg .frame{fill:var(--panel);stroke:var(--line)}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.93em;min-width:min(100%,520px)}
th,td{padding:3px 14px 3px 0;text-align:left;vertical-align:top;border-bottom:1px solid var(--line)}
th{color:var(--soft);font-weight:500;white-space:nowrap}
td.number,th.number{text-align:right;white-space:nowrap}
td.name{white-space:nowrap}
td.long{min-width:190px;overflow-wrap:anywhere}
.good,.met{color:var(--good)}.bad,.unmet{color:var(--bad);font-weight:600}.poor{color:var(--poor)}
details{margin:10px 0}
summary{cursor:pointer;color:var(--soft)}
.link{stroke:var(--soft);stroke-width:1;fill:none}
.link.good{stroke:var(--good);stroke-width:3}
.link.fair{stroke:var(--fair);stroke-width:2.4}
.link.poor{stroke:var(--poor);stroke-width:2;stroke-dasharray:9 3}
.link.bad{stroke:var(--bad);stroke-width:1.8;stroke-dasharray:3 3}
.link,.path,.dead,.curve,.event,svg .grid,svg .frame{vector-effect:non-scaling-stroke}
.cell.good{fill:var(--good)}.cell.fair{fill:var(--fair)}.cell.poor{fill:var(--poor)}.cell.bad{fill:var(--bad)}
.matrix text{font-size:8px}.wide svg.matrix{min-width:700px}
.mote{fill:var(--fg);stroke:var(--bg);stroke-width:1}
.mote.absent{fill:var(--bg);stroke:var(--fg);stroke-width:1.5}
.dead{stroke:var(--bad);stroke-width:2.5}
.sink{fill:var(--c2);stroke:var(--bg)}
.path{stroke:var(--soft);stroke-dasharray:2 4;fill:none}
svg text.strong{font-weight:700}
.event{stroke:var(--soft);stroke-width:1.5}
.event.good{stroke:var(--good);stroke-width:2}
.event.bad{stroke:var(--bad);stroke-width:2.5}
.fault{fill:var(--poor);stroke:var(--bg)}
.violated{fill:var(--bad);stroke:var(--bg)}
.curve{fill:none;stroke-width:1.8;stroke:var(--c0)}
.band{fill:var(--c0);opacity:.18;stroke:none}
.curve.c1{stroke:var(--c1)}.curve.c2{stroke:var(--c2)}.curve.c3{stroke:var(--c3)}.curve.c4{stroke:var(--c4)}
.curve.c5{stroke:var(--c5)}.curve.c6{stroke:var(--fg)}.curve.c7{stroke:var(--soft)}
.curve.c1,.curve.c5{stroke-dasharray:8 3}.curve.c2,.curve.c6{stroke-dasharray:3 3}.curve.c3,.curve.c7{stroke-dasharray:10 3 2 3}
.bar{height:.8em;min-width:2px;background:var(--c0);border-radius:2px;display:inline-block}
td.bars{width:45%;min-width:110px;white-space:nowrap}
.legend{display:flex;flex-wrap:wrap;gap:4px 18px;margin:8px 0;color:var(--soft);font-size:.9em}
.legend span{display:inline-flex;align-items:center;gap:6px}
.legend svg{width:34px;height:14px;flex:none}
@media print{section{break-inside:avoid-page}}
)";

} // namespace

std::string document(std::string_view title, std::string_view sections) {
  std::string out = "<!doctype html>\n<html lang='en'>\n<head>\n<meta charset='utf-8'>\n"
                    "<meta http-equiv='Content-Security-Policy' content=\"default-src 'none'; "
                    "style-src 'unsafe-inline'\">\n"
                    "<meta name='viewport' content='width=device-width, initial-scale=1'>\n"
                    "<meta name='color-scheme' content='light dark'>\n";
  out += element("title", title) + "\n<style>";
  out.append(style).append("</style>\n</head>\n<body>\n<main>\n");
  return out.append(sections).append("</main>\n</body>\n</html>\n");
}

std::string section(std::string_view id, std::string_view title, std::string_view content) {
  if (content.empty())
    return {};
  std::string out = "<section id='";
  out.append(id).append("'>\n").append(element("h2", title)).append("\n");
  return out.append(content).append("</section>\n");
}

std::string wide(std::string_view content) {
  return "<div class='wide'>" + std::string(content) + "</div>\n";
}

namespace {

std::string row_of(std::string_view tag, const std::vector<cell>& cells) {
  std::string out = "<tr>";
  for (const auto& x : cells) {
    std::string classes(x.look);
    if (x.is_number)
      classes += classes.empty() ? "number" : " number";
    out += element(tag, x.text, classes.empty() ? "" : "class='" + classes + '\'');
  }
  return out + "</tr>\n";
}

} // namespace

std::string head_row(const std::vector<cell>& cells) {
  return row_of("th", cells);
}

std::string row(const std::vector<cell>& cells) {
  return row_of("td", cells);
}

std::string_view class_of(std::optional<double> delivery) {
  if (!delivery)
    return "unknown";
  return *delivery >= 0.99   ? "good"
         : *delivery >= 0.95 ? "fair"
         : *delivery >= 0.8  ? "poor"
                             : "bad";
}

std::string share(std::optional<double> x) {
  return x ? report::percent(*x, 1) : "–";
}

} // namespace rubicon::page
