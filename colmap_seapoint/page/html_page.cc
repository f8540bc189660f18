#include "colmap_seapoint/page/html_page.h"

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/version.h"
#include "colmap_seapoint/page/page_assets.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kSectionBegin[] = "<script type=\"application/json\" class=\"section\">";
constexpr char kSectionEnd[] = "</script>\n";

std::string EscapedText(const std::string& text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

// JSON that ends no script element: '<' stands in texts alone.
std::string ScriptSafe(const std::string& json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

// {{name}} becomes values[name]; what is put in is not looked through again.
std::string Fill(const std::string& text, const std::map<std::string, std::string>& values) {
  std::string filled;
  size_t at = 0;
  for (;;) {
    const size_t begin = text.find("{{", at);
    if (begin == std::string::npos) return filled + text.substr(at);
    const size_t end = text.find("}}", begin);
    SEAPOINT_CHECK(end != std::string::npos);
    filled += text.substr(at, begin - at) + values.at(text.substr(begin + 2, end - begin - 2));
    at = end + 2;
  }
}

void DropCloud(std::string* section) {
  Json json = Json::parse(*section);
  json.erase("cloud");
  *section = json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void FitIntoPage(std::vector<std::string>* sections) {
  size_t size = std::strlen(kThreeScript) + std::strlen(kPageScript) + std::strlen(kPageStyle);
  for (const std::string& section : *sections) size += section.size();
  for (size_t i = sections->size(); i-- > 0 && size > kMaxPageBytes;) {
    std::string& section = (*sections)[i];
    size -= section.size();
    DropCloud(&section);
    size += section.size();
  }
}

}  // namespace

std::string HtmlPage(PageContent content) {
  FitIntoPage(&content.sections);
  std::string sections;
  for (const std::string& section : content.sections) {
    sections += kSectionBegin + ScriptSafe(section) + kSectionEnd;
  }
  const Json names = content.names;
  return Fill(kPageTemplate,
              {{"title", EscapedText(content.title)},
               {"answer", EscapedText(content.answer)},
               {"version", EscapedText(Version())},
               {"style", kPageStyle},
               {"sections", sections},
               {"names", ScriptSafe(names.dump(-1, ' ', false, Json::error_handler_t::replace))},
               {"job", ScriptSafe(content.job.empty() ? "null" : content.job)},
               {"three", kThreeScript},
               {"three_licence", EscapedText(kThreeLicence)},
               {"script", kPageScript}});
}

std::vector<std::string> SectionsOfPage(const std::string& html) {
  std::vector<std::string> sections;
  size_t at = 0;
  for (;;) {
    const size_t begin = html.find(kSectionBegin, at);
    if (begin == std::string::npos) return sections;
    const size_t text = begin + std::strlen(kSectionBegin);
    const size_t end = html.find(kSectionEnd, text);
    if (end == std::string::npos) return sections;
    sections.push_back(html.substr(text, end - text));
    at = end;
  }
}

}  // namespace colmap_seapoint
