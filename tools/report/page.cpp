#include "tools/report/page.hpp"

#include <array>
#include <cstdio>

#include "tools/plot/svg.hpp"

namespace slamd::report {

using plot::escaped;

namespace {

constexpr const char* kStyle = R"css(
:root{color-scheme:light dark;--paper:#fff;--page:#f4f5f7;--ink:#1c2024;--soft:#5b6470;--line:#dfe3e8;--grid:#e3e6ea;
--good:#0a7a4f;--fair:#a65f00;--bad:#b3261e}
@media (prefers-color-scheme:dark){:root{--paper:#1a1e24;--page:#12151a;--ink:#e6e9ed;--soft:#9aa4b0;--line:#2d343d;
--grid:#2d343d;--good:#4cc38a;--fair:#f0b04a;--bad:#ff7a70}}
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);font:16px/1.5 system-ui,"DejaVu Sans",sans-serif}
main{max-width:1220px;margin:0 auto;padding:1rem}
h1{font-size:1.5rem;margin:.4rem 0 0;overflow-wrap:anywhere}
h2{font-size:1.1rem;margin:0 0 .8rem}
.made{color:var(--soft);margin:0 0 1rem}
.banner{border-left:6px solid var(--soft);background:var(--paper);padding:.7rem 1rem;border-radius:6px;margin:0 0 1rem}
.banner.good{border-color:var(--good)}.banner.fair{border-color:var(--fair)}.banner.bad{border-color:var(--bad)}
.banner strong{font-size:1.1rem}.banner ul{margin:.3rem 0 0;padding-left:1.2rem}
section{background:var(--paper);border-radius:6px;padding:1rem;margin:0 0 1rem}
dl.facts{display:grid;grid-template-columns:repeat(auto-fill,minmax(150px,1fr));gap:.8rem;margin:0}
dl.facts dt{color:var(--soft);font-size:.85rem}
dl.facts dd{margin:0;font-size:1.15rem;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}
.figures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,440px),1fr));gap:1.2rem;align-items:start}
figure{margin:0;min-width:0}figure.wide{grid-column:1/-1}
figure svg{width:100%;height:auto;display:block}
figure.wide svg{max-width:800px;margin:0 auto}
figure.tall{grid-row:span 2}
figcaption{color:var(--soft);font-size:.9rem;margin-top:.3rem}
.plot .paper{fill:var(--paper)}.plot .ink{fill:var(--ink)}.plot .grid{stroke:var(--grid)}.plot .truth{stroke:var(--ink)}
.plot .no-grid .grid{stroke:#fff}
.scroll{overflow-x:auto}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.95rem}
th,td{padding:.25rem .9rem .25rem 0;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th:first-child,td:first-child{text-align:left}
th{color:var(--soft);font-weight:600}
.tables{display:flex;flex-wrap:wrap;gap:1rem 2.5rem}
.figures+.tables{margin-top:1.4rem}
.tables h3{font-size:.95rem;margin:0 0 .3rem}
pre{overflow-x:auto;font-size:.85rem;margin:.6rem 0 0}
summary{cursor:pointer;font-weight:600}
@media (max-width:500px){body{font-size:15px}main{padding:.5rem}section{padding:.7rem}}
@media print{:root{--page:#fff;--paper:#fff;--ink:#000;--soft:#444;--line:#ccc;--grid:#ddd}
section,figure{break-inside:avoid}section{padding:.3rem 0}main{max-width:none}}
)css";

}  // namespace

std::string html_of(const HtmlTable& table) {
  const auto row = [](const std::vector<std::string>& cells, const std::string& tag) {
    std::string html = "<tr>";
    for (const std::string& cell : cells) {
      html += "<" + tag + ">" + escaped(cell) + "</" + tag + ">";
    }
    return html + "</tr>\n";
  };
  std::string html =
      "<div class=\"scroll\"><table>\n<thead>" + row(table.header, "th") + "</thead>\n<tbody>\n";
  for (const auto& cells : table.rows) {
    html += row(cells, "td");
  }
  return html + "</tbody></table></div>\n";
}

std::string figure(const std::string& svg, const std::string& caption, Shape shape) {
  const char* opening = shape == Shape::kWide   ? "<figure class=\"wide\">"
                        : shape == Shape::kTall ? "<figure class=\"tall\">"
                                                : "<figure>";
  return opening + svg + "<figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

std::string section(const std::string& heading, const std::string& body) {
  return "<section>\n<h2>" + escaped(heading) + "</h2>\n" + body + "</section>\n";
}

std::string page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escaped(title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<main>\n" +
         body + "</main>\n</body>\n</html>\n";
}

std::string number(double value, int digits) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

}  // namespace slamd::report
