// The page of one table: everything of it is data, whatever names say.
#include "report/table_page.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace softarm::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TablePage example() {
  TablePage page;
  page.title = "Estimates of 2 trials";
  page.kicker = "softarm <batch>";
  page.verdict = "1 of 2 done";
  page.whole = false;
  page.figures = {{"1", "failed"}};
  page.columns = {{"job"}, {"frames", TablePage::Column::kNumbers}};
  page.rows = {
      {{{"</script><script>alert(1)</script>", std::nullopt, "jobs/a/log.txt"}, {"721", 721.0, ""}}, false},
      {{{"{{data}} \xff", std::nullopt, ""}, {"", std::nullopt, ""}}, true}};
  page.notes = {"A note."};
  return page;
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin) + begin.size();
  return text.substr(from, text.find(end, from) - from);
}

TEST(TablePage, IsOnePageThatNeedsNothingElse) {
  const std::string html = to_html(example(), read_table_page_files(SOFTARM_SOURCE_DIR "/config/report"));
  EXPECT_THAT(html, HasSubstr("<title>Estimates of 2 trials</title>"));
  EXPECT_THAT(html, HasSubstr("function table("));  // the report's own
  EXPECT_THAT(html, HasSubstr("td.number"));
  EXPECT_THAT(html, Not(HasSubstr("Plotly.")));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
}

TEST(TablePage, NamesAreData) {
  const std::string html = to_html(example(), read_table_page_files(SOFTARM_SOURCE_DIR "/config/report"));
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  const nlohmann::json data =
      nlohmann::json::parse(between(html, "<script type=\"application/json\" id=\"data\">", "</script>"));
  EXPECT_EQ(data["rows"][0]["cells"][0]["text"], "</script><script>alert(1)</script>");
  EXPECT_EQ(data["rows"][0]["cells"][1]["number"], 721.0);
  EXPECT_EQ(data["rows"][1]["cells"][0]["text"], "{{data}} \xEF\xBF\xBD");
  EXPECT_FALSE(data["rows"][1]["cells"][1].contains("number"));
  EXPECT_TRUE(data["rows"][1]["marked"]);
  const std::string text = between(html, "<noscript>", "</noscript>");
  EXPECT_THAT(text, HasSubstr("job: &lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;; frames: 721"));
}

}  // namespace
}  // namespace softarm::report
