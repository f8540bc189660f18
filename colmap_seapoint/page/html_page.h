// The page: one file that opens from the disk, with no network.
#pragma once

#include <string>
#include <vector>

namespace colmap_seapoint {

struct PageContent {
  std::string title;                  // plain text, as the answer
  std::string answer;                 // readable without scripts
  std::vector<std::string> sections;  // SectionJson, one a model
  std::vector<std::string> names;     // of the sections: "0"
  std::string job;                    // JSON of the run: RunReport's, without its inputs
};

inline constexpr size_t kMaxPageBytes = 30 << 20;

// HTML with style, scripts, three.js and its licence inside. Whatever a text holds, it stays text.
// Of a page that would be larger than kMaxPageBytes the last models lose their cloud, and say so.
std::string HtmlPage(PageContent content);

// The sections of a page of ours, in their order; empty for anything else.
std::vector<std::string> SectionsOfPage(const std::string& html);

}  // namespace colmap_seapoint
