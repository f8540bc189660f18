#include "colmap_seapoint/page/html_page.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "colmap_seapoint/page/page_assets.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::json;

size_t CountOf(const std::string& text, const std::string& word) {
  size_t count = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(HtmlPage, TextsStayTexts) {
  const Json hostile = {{"answer", "</script><img src=x onerror=alert(1)><!-- {{style}} \" & "}};
  PageContent content;
  content.title = "<b>a & \"b\"</b> {{script}}";
  content.answer = "100 % <covered>";
  content.sections = {hostile.dump()};
  content.names = {"</script>"};
  content.job = hostile.dump();
  const std::string page = HtmlPage(content);
  EXPECT_EQ(page.find("<img src=x"), std::string::npos);
  EXPECT_EQ(page.find("<!-- {{style}}"), std::string::npos);
  EXPECT_NE(page.find("<title>&lt;b&gt;a &amp; &quot;b&quot;&lt;/b&gt; {{script}}</title>"),
            std::string::npos);
  EXPECT_NE(page.find("100 % &lt;covered&gt;"), std::string::npos);
  // A section, names, job, three.js, and the page's own script.
  EXPECT_EQ(CountOf(page, "<script"), 5u);
  EXPECT_EQ(CountOf(page, "</script>"), 5u);
  const auto sections = SectionsOfPage(page);
  ASSERT_EQ(sections.size(), 1u);
  EXPECT_EQ(Json::parse(sections[0]), hostile);
}

TEST(HtmlPage, SectionsComeBackInTheirOrder) {
  PageContent content;
  content.sections = {"{\"k\":1}", "{\"k\":2}", "{\"k\":3}"};
  content.names = {"0", "1", "2"};
  EXPECT_EQ(SectionsOfPage(HtmlPage(content)), content.sections);
  EXPECT_TRUE(SectionsOfPage("").empty());
  EXPECT_TRUE(SectionsOfPage("<script type=\"application/json\" class=\"section\">{").empty());
}

TEST(HtmlPage, IsWholeAndAsksForNothing) {
  const std::string page = HtmlPage({});
  EXPECT_EQ(page.find("{{"), std::string::npos);
  EXPECT_NE(page.find("The MIT License"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  for (const char* fetched : {"src=\"http", "href=\"http", "url(http", "@import"}) {
    const std::string ours = std::string(kPageTemplate) + kPageStyle + kPageScript;
    EXPECT_EQ(ours.find(fetched), std::string::npos) << fetched;
  }
}

TEST(HtmlPage, TooLargeAPageLosesTheLastClouds) {
  const std::string codes(11 << 20, 'A');
  const auto section = [&](int k) { return Json{{"k", k}, {"cloud", {{"codes", codes}}}}.dump(); };
  PageContent content;
  content.sections = {section(1), section(2), section(3)};
  content.names = {"0", "1", "2"};
  const std::string page = HtmlPage(content);
  EXPECT_LE(page.size(), kMaxPageBytes);
  const auto sections = SectionsOfPage(page);
  ASSERT_EQ(sections.size(), 3u);
  EXPECT_EQ(sections[0], content.sections[0]);
  EXPECT_EQ(sections[1], content.sections[1]);
  EXPECT_EQ(sections[2], "{\"k\":3}");
}

}  // namespace
}  // namespace colmap_seapoint
