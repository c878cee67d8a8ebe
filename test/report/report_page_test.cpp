// report.html as text: complete on its own, and safe whatever the names in bags and files are.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>

#include "effects/catalogue.h"
#include "example_diagnosis.h"
#include "hostile_names.h"
#include "softarm/report/report.h"

namespace softarm::diagnose {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kFolder = SOFTARM_SOURCE_DIR "/config/report";

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

std::string text_of_data(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const std::size_t start = page.find(open) + open.size();
  return page.substr(start, page.find("</script>", start) - start);
}

/// The JSON inside the page.
nlohmann::json data_of(const std::string& page) {
  return nlohmann::json::parse(text_of_data(page));
}

TEST(ReportPage, NeedsNothingElse) {
  report::PageFiles files = report::read_page_files(kFolder);
  files[report::kPlotly] = "window.Plotly = {};";
  const std::string page = report::to_html(testing::example_diagnosis(), files);
  EXPECT_THAT(page, Not(HasSubstr("{{")));
  EXPECT_THAT(page, HasSubstr("window.Plotly = {};"));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=['\"]?(https?:)?//")));
  EXPECT_FALSE(std::regex_search(page, std::regex("<link|@import|url\\(")));
}

TEST(ReportPage, HoldsWhatThePicturesNeed) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  const nlohmann::json data = data_of(report::to_html(d, report::read_page_files(kFolder)));
  EXPECT_EQ(data["report"]["verdict"], "explained");
  ASSERT_EQ(data["trials"].size(), 9U);
  const nlohmann::json& ring_4 = data["trials"][0]["bodies"][3];
  EXPECT_EQ(ring_4["name"], "ring_4");
  EXPECT_TRUE(ring_4["before"][140].is_null());
  EXPECT_NEAR(ring_4["before"][0].get<double>(), *d.trials[0].before_m.at("ring_4")[0], 5e-8);
  EXPECT_EQ(
      data["trials"][0]["inputs"][2],
      (nlohmann::json{{"name", "payload"}, {"unit", "kg"}, {"values", std::vector<double>(360, 0.05)}}));
  EXPECT_EQ(data["along"]["after"].size(), 3U);
  EXPECT_EQ(data["snapshots"][0]["before"][2].size(), 41U);
  EXPECT_NEAR(data["trials"][0]["tip"]["after"][2][7].get<double>(), d.trials[0].tip_after_m[7]->z(), 5e-6);
  ASSERT_EQ(data["trials"][0]["film"].size(), d.trials[0].film.size());
  EXPECT_NEAR(data["trials"][0]["film"][3]["bodies_after"][0][5].get<double>(),
              d.trials[0].film[3].bodies_after[5].x(), 5e-6);
  EXPECT_EQ(data["report"]["next_command"], d.next_command);
  EXPECT_EQ(data["parameter_variation"][0]["parameter"], "EI");
}

TEST(ReportPage, EveryEffectHasASourceWithALink) {
  // What cited() of config/report/basics.js makes a link of.
  const std::regex link(R"(\b(doi:10\.\d{4,}/[-\w.()/]+|isbn:\d{9}[\dX])$)");
  for (const auto& effect : effects::catalogue())
    EXPECT_TRUE(std::regex_search(effect->info().source, link))
        << effect->info().id << ": '" << effect->info().source << "'";
  const nlohmann::json data =
      data_of(report::to_html(testing::example_diagnosis(), report::read_page_files(kFolder)));
  for (const auto& candidate : data["report"]["ranking"])
    EXPECT_TRUE(std::regex_search(candidate["source"].get<std::string>(), link)) << candidate["name"];
}

TEST(ReportPage, TheLearntLawIsAnEquationWithItsSources) {
  const diagnose::DiscoveredLaw law = testing::example_law();
  const nlohmann::json said = data_of(report::to_html(
      testing::example_diagnosis(), report::read_page_files(kFolder)))["report"]["discovered_law"];
  EXPECT_EQ(said["source"], law.source);
  ASSERT_EQ(said["terms"].size(), law.terms.size());
  for (std::size_t i = 0; i < law.terms.size(); ++i) {
    EXPECT_EQ(said["terms"][i]["equation"], law.terms[i].law);
    EXPECT_EQ(said["terms"][i]["symbols"], law.terms[i].symbols);
    EXPECT_EQ(said["terms"][i]["source"], law.terms[i].source);
  }
}

TEST(ReportPage, NumbersThatAreNoneAreAbsent) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  d.parameter_variation[0].value[3] = std::nan("");
  d.parameter_variation[0].p = std::nan("");
  d.snapshots[0].measured[1].x() = INFINITY;
  const nlohmann::json data = data_of(report::to_html(d, report::read_page_files(kFolder)));
  EXPECT_TRUE(data["parameter_variation"][0]["value"][3].is_null());
  EXPECT_FALSE(data["parameter_variation"][0].contains("p"));
  EXPECT_TRUE(data["snapshots"][0]["measured"][0][1].is_null());
}

TEST(ReportPage, NamesCannotLeaveTheirPlace) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  testing::rename_all(d);
  const report::PageFiles files = report::read_page_files(kFolder);
  const std::string page = report::to_html(d, files),
                    harmless = report::to_html(testing::example_diagnosis(), files);
  for (const char* what : {"<script", "</script", "<img", "<a ", "<!--"})
    EXPECT_EQ(count(page, what), count(harmless, what)) << what;
  const std::string name = data_of(page)["trials"][0]["name"];
  EXPECT_THAT(name, HasSubstr("</script><img src=x onerror=alert(1)>"));
  EXPECT_THAT(name, HasSubstr("\xE2\x80\xA8'\"&lt;b&gt;\xEF\xBF\xBD 0"));
  EXPECT_THAT(text_of_data(page), Not(HasSubstr("\xE2\x80\xA8")));
  EXPECT_THAT(page, HasSubstr("<title>Diagnosis of &lt;/script&gt;"));
}

TEST(ReportPage, ScriptsCannotEndThemselves) {
  report::PageFiles files = report::read_page_files(kFolder);
  files[report::kPlotly] = "var a = '</script><!--';";
  EXPECT_THAT(report::to_html(diagnose::Diagnosis(), files), HasSubstr("var a = '<\\/script><\\!--';"));
}

TEST(ReportPage, PlacesInNamesAreNotFilledIn) {
  diagnose::Diagnosis d;
  d.arm = "{{data}}";
  d.summary = "{{page.css}}";
  const std::string page = report::to_html(d, report::read_page_files(kFolder));
  EXPECT_THAT(page, HasSubstr("Diagnosis of {{data}}"));
  EXPECT_EQ(data_of(page)["report"]["summary"], "{{page.css}}");
}

TEST(ReportPage, IsTheSameEachTime) {
  const report::PageFiles files = report::read_page_files(kFolder);
  EXPECT_EQ(report::to_html(testing::example_diagnosis(), files),
            report::to_html(testing::example_diagnosis(), files));
}

TEST(ReportPage, MissingFilesAreNamed) {
  report::PageFiles files = report::read_page_files(kFolder);
  files.erase("main.js");
  EXPECT_THROW(report::to_html(diagnose::Diagnosis(), files), std::invalid_argument);
  EXPECT_THROW(report::to_html(diagnose::Diagnosis(), {}), std::invalid_argument);
  EXPECT_THAT([] { report::read_page_files("/nowhere"); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("/nowhere/page.html")));
}

}  // namespace
}  // namespace softarm::diagnose
