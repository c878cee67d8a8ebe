// report.html in a real browser, offline: all is drawn, every choice works, nothing fails, and it prints.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "example_diagnosis.h"
#include "hostile_names.h"
#include "softarm/report/report.h"

namespace softarm::diagnose {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// Goes through the choices, prints, and leaves what it saw on the page's first element.
constexpr const char* kProbe = R"(
window.alert = () => errors.push('alert');
document.querySelectorAll('select').forEach(list => {
  for (const i of [list.options.length - 1, 1]) { list.selectedIndex = i; list.dispatchEvent(new Event('change')); }
});
window.dispatchEvent(new Event('beforeprint'));
window.dispatchEvent(new Event('afterprint'));
const seen = document.documentElement.dataset;
seen.sections = [...document.querySelectorAll('section')].map(one => one.id).join(' ');
seen.svgs = [...document.querySelectorAll('.picture')].map(one => one.querySelectorAll('.main-svg .trace, .main-svg .points').length > 0 ? 1 : 0).join('');
seen.foreign = document.querySelectorAll('#page img, #page script, #page iframe, #page a:not([href^="#"]):not(.modebar-btn):not([href^="https://doi.org/10."]):not([href^="https://openlibrary.org/isbn/"]), [onerror]').length;
seen.loaded = performance.getEntriesByType('resource').length;
seen.chosen = document.querySelectorAll('select option').length;
setTimeout(() => {  // the last choice is a film
  const film = document.getElementById('arm');
  if (!film) return;
  const at = () => Number(film.querySelector('input').value), play = film.querySelector('button');
  const instants = film.querySelector('select');
  instants.selectedIndex = instants.options.length - 1;
  instants.dispatchEvent(new Event('change'));
  [...film.querySelectorAll('button')].pop().click();  // in two planes: no graphics processor here
  play.click();
  setTimeout(() => { play.click(); seen.moved = at() > 0 ? 'yes' : 'no'; seen.errors = errors.join(' | '); }, 1000);
}, 100);
seen.beyond = document.documentElement.scrollWidth - document.documentElement.clientWidth;
seen.widest = [...document.querySelectorAll('#page *:not(.picture *)')].map(one => [one.getBoundingClientRect().right, one.tagName + '.' + one.className])
  .sort((a, b) => b[0] - a[0]).slice(0, 3).join(' ');
seen.width = innerWidth;
seen.pushed = [...document.querySelectorAll('.scroll')].filter(table => table.scrollWidth > table.clientWidth).length;
const places = (place, what) => [...place.querySelectorAll(what)].map(one => one.getBoundingClientRect()).filter(one => one.width > 0);
const meet = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 3 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 3;
seen.overlapping = [...document.querySelectorAll('.picture')].filter(place =>
  places(place, '.legend .legendtext').some(one => places(place, '.annotation text').some(other => meet(one, other)))).length;
seen.links = document.querySelectorAll('#ranking td a[href^="https://"]').length;
seen.names = document.querySelectorAll('#page bdi').length;
seen.clipped = [...document.querySelectorAll('.xtitle, .ytitle, .legendtext, .annotation text')].filter(title => {
  const words = title.getBoundingClientRect(), place = title.closest('.picture').getBoundingClientRect();
  return words.left < place.left - 1 || words.right > place.right + 1 || words.top < place.top - 1;
}).map(title => title.textContent).join(' | ');
seen.copies = [...document.querySelectorAll('.copy')].map(one => one.textContent.length > 0 ? 1 : 0).join('');
seen.words = document.getElementById('page').innerText.trim().split(/\s+/).length;
if (parent !== self) setInterval(() => Object.assign(parent.document.documentElement.dataset, seen), 50);
)";

/// Measures the page where what is for paper is shown on the screen: what is wider or higher than A4 with its
/// margins, what may break, and what only a screen can use.
constexpr const char* kPaperProbe = R"(
const seen = document.documentElement.dataset, paper = document.getElementById('page');
paper.style.width = '688px';
window.dispatchEvent(new Event('beforeprint'));
setTimeout(() => {
  const shown = what => [...document.querySelectorAll(what)].filter(one => one.getBoundingClientRect().width > 0);
  const edge = paper.getBoundingClientRect().right + 1;
  const named = list => list.map(one => one.tagName + '.' + (one.getAttribute('class') || '')).join(' | ');
  seen.wide = named(shown('#page *:not(.picture *), .picture .main-svg').filter(one => one.getBoundingClientRect().right > edge));
  seen.high = named(shown('.picture').filter(one => one.getBoundingClientRect().height > 900));
  seen.breaks = named(shown('.picture, .effect').filter(one => getComputedStyle(one).breakInside !== 'avoid'));
  seen.pictures = shown('.picture').length;
  seen.tools = named(shown('nav, button, input, .modebar-container'));
  seen.folded = named(shown('details:not([open])'));
  seen.errors = errors.join(' | ');
}, 1000);
)";

bool there_is(const std::string& program) {
  return std::system(fmt::format("command -v {} > /dev/null 2>&1", program).c_str()) == 0;
}

std::string browser() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
    if (there_is(name)) return name;
  }
  return "";
}

report::PageFiles page_files(bool with_plots, const std::string& probe) {
  report::PageFiles files = report::read_page_files(SOFTARM_SOURCE_DIR "/config/report");
  if (with_plots) {
    std::ifstream plotly(SOFTARM_PLOTLY, std::ios::binary);
    files[report::kPlotly] = std::string(std::istreambuf_iterator<char>(plotly), {});
  }
  files["main.js"] += probe;
  return files;
}

constexpr int kNarrowest = 500;  // window of the browser

const report::Origin kOrigin{"softarm diagnose --arm arm.yaml 'trial 1.bag' --out report",
                             "2026-05-04T12:30Z",
                             {{"arm.yaml", std::string(64, 'a')}, {"trial 1.bag", std::string(64, 'b')}}};

/// What a command says on standard output.
std::string output_of(const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  char buffer[65536];
  for (std::size_t n = 1; n > 0;) text.append(buffer, n = std::fread(buffer, 1, sizeof(buffer), pipe));
  const int status = pclose(pipe);
  EXPECT_EQ(WEXITSTATUS(status), 0) << command;
  return text;
}

/// What the browser says that sees a page of the folder, and no network.
std::string browsed(const fs::path& folder, const std::string& page, const std::string& options) {
  return output_of(fmt::format(
      "timeout 100 {} --headless --no-sandbox --disable-gpu --disable-extensions "
      "--disable-background-networking "
      "--no-first-run --allow-file-access-from-files --user-data-dir='{}' --host-resolver-rules='MAP * "
      "~NOTFOUND' --virtual-time-budget=3000 {} 'file://{}' 2> '{}'",
      browser(), (folder / "profile").string(), options, (folder / page).string(),
      (folder / "errors").string()));
}

/// A folder with the page.
fs::path folder_with(const diagnose::Diagnosis& d, const report::PageFiles& files) {
  const fs::path folder = fs::path(::testing::TempDir()) / fmt::format("report_{}", getpid());
  fs::create_directories(folder);
  std::ofstream(folder / "report.html") << report::to_html(d, files, kOrigin);
  return folder;
}

void remove_folder(const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
}

/// The first <html ...> of a page's text.
std::string html_of(const std::string& dom) {
  std::smatch found;
  const std::string head = dom.substr(0, 4000);
  return std::regex_search(head, found, std::regex("<html[^>]*>")) ? found[0].str() : "no page: " + head;
}

/// The page's <html ...> after its scripts ran.
std::string opened(const diagnose::Diagnosis& d, bool with_plots, int width = 1280) {
  const fs::path folder = folder_with(d, page_files(with_plots, kProbe));
  // A browser's own window is never as narrow as a telephone's.
  std::ofstream(folder / "frame.html") << fmt::format(
      "<html><body><iframe src='report.html' "
      "style='width:{}px;height:700px;border:0'></iframe></body></html>",
      width);
  const std::string dom =
      browsed(folder, width < kNarrowest ? "frame.html" : "report.html",
              fmt::format("--window-size={},720 --dump-dom", std::max(width, kNarrowest)));
  remove_folder(folder);
  return html_of(dom);
}

/// The same where the window shows what is for paper.
std::string opened_as_on_paper(const diagnose::Diagnosis& d) {
  report::PageFiles files = page_files(true, kPaperProbe);
  std::string& style = files["page.css"];
  const std::string print = "@media print", always = "@media all";
  const std::size_t at = style.find(print);
  if (at == std::string::npos) return "nothing is for paper";
  style.replace(at, print.size(), always);
  const fs::path folder = folder_with(d, files);
  const std::string dom = browsed(folder, "report.html", "--window-size=1280,720 --dump-dom");
  remove_folder(folder);
  return html_of(dom);
}

/// The text of each page of a PDF of it.
std::vector<std::string> printed(const diagnose::Diagnosis& d) {
  const fs::path folder = folder_with(d, page_files(true, ""));
  const std::string pdf = (folder / "report.pdf").string();
  browsed(folder, "report.html", "--no-pdf-header-footer --print-to-pdf='" + pdf + "'");
  const std::string text = output_of("pdftotext -layout -enc UTF-8 '" + pdf + "' -");
  remove_folder(folder);
  std::vector<std::string> pages;
  std::size_t start = 0;
  for (std::size_t end = text.find('\f'); end != std::string::npos; end = text.find('\f', start)) {
    pages.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return pages;
}

std::ptrdiff_t words_of(const std::string& text) {
  std::istringstream words(text);
  return std::distance(std::istream_iterator<std::string>(words), {});
}

/// A number that the probe left; -1 where it left none.
int number_of(const std::string& html, const std::string& name) {
  std::smatch found;
  const bool there = std::regex_search(html, found, std::regex(fmt::format("data-{}=\"([0-9]+)\"", name)));
  return there ? std::stoi(found[1].str()) : -1;
}

class ReportInBrowser : public ::testing::Test {
 protected:
  void SetUp() override {
    if (browser().empty()) GTEST_SKIP() << "no chromium";
  }
};

constexpr const char* kAll =
    "effects small stand-ins law next held-out shifts tip arm along time inputs ranking ladder "
    "parameter_variation "
    "left "
    "trials go-on notes origin";

TEST_F(ReportInBrowser, DrawsEverythingWhateverTheNamesAre) {
  if (std::string(SOFTARM_PLOTLY).empty()) GTEST_SKIP() << "no plotly.js";
  diagnose::Diagnosis d = testing::example_diagnosis();
  testing::rename_all(d);
  const std::string html = opened(d, true);
  EXPECT_THAT(html, HasSubstr("data-errors=\"\""));
  EXPECT_THAT(html, HasSubstr("data-plots=\"10\""));
  EXPECT_THAT(html, HasSubstr(fmt::format("data-sections=\"{}\"", kAll)));
  EXPECT_THAT(html, HasSubstr("data-svgs=\"1111111111\""));
  EXPECT_THAT(html, HasSubstr("data-foreign=\"0\""));
  EXPECT_THAT(html, HasSubstr("data-loaded=\"0\""));
  EXPECT_THAT(html,
              // 3 instants and 9 films, 2 residuals, 9 trials, 5 bodies and all, 3 inputs; tip: 9 trials, 3
              // inputs, 3 axes
              HasSubstr("data-chosen=\"47\""));
  EXPECT_THAT(html, HasSubstr("data-moved=\"yes\""));
  EXPECT_THAT(html, HasSubstr("data-links=\"10\""));  // all effects of this arm
  // 18 of trials and their worst bodies, 10 of inputs in what is left, 6 of variations, 4 of rivals, 4 of
  // shifts, 4 of the law, 2 of experiments, 2 of files, the arm and the trial of its picture.
  EXPECT_EQ(number_of(html, "names"), 52);
  EXPECT_THAT(html, HasSubstr("data-copies=\"111\""));
}

TEST_F(ReportInBrowser, IsWholeInANarrowWindow) {
  if (std::string(SOFTARM_PLOTLY).empty()) GTEST_SKIP() << "no plotly.js";
  const std::string html = opened(testing::example_diagnosis(), true, 400);
  EXPECT_THAT(html, HasSubstr("data-width=\"400\""));
  EXPECT_THAT(html, HasSubstr("data-errors=\"\""));
  EXPECT_THAT(html, HasSubstr("data-plots=\"10\""));
  EXPECT_THAT(html, HasSubstr("data-beyond=\"0\""));
  EXPECT_THAT(html, HasSubstr("data-clipped=\"\""));
  EXPECT_THAT(html, HasSubstr("data-pushed=\"0\""));
  EXPECT_THAT(html, HasSubstr("data-overlapping=\"0\""));
}

TEST_F(ReportInBrowser, EmptyPartsAndNoPlotsStayReadable) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  d.verdict = diagnose::Verdict::kUnknown;
  d.effects.clear();
  d.small_departures.clear();
  d.stand_ins.clear();
  d.discovered_law.reset();
  d.shifts.clear();
  d.next_experiment.reset();
  d.notes.clear();
  const std::string html = opened(d, false);
  EXPECT_THAT(html, HasSubstr("data-errors=\"\""));
  EXPECT_THAT(html, HasSubstr("data-plots=\"0\""));
  EXPECT_THAT(html, HasSubstr("data-sections=\"held-out ranking ladder left trials origin\""));
  EXPECT_GT(number_of(html, "words"), 600) << "it had 902 when this was written";
}

TEST_F(ReportInBrowser, OnPaperNothingIsCutOffAndNothingIsToBeClicked) {
  if (std::string(SOFTARM_PLOTLY).empty()) GTEST_SKIP() << "no plotly.js";
  diagnose::Diagnosis d = testing::example_diagnosis();
  d.trials[0].name = d.snapshots[0].trial = std::string(120, 'n');
  const std::string html = opened_as_on_paper(d);
  EXPECT_THAT(html, HasSubstr("data-errors=\"\""));
  EXPECT_THAT(html, HasSubstr("data-pictures=\"10\""));
  EXPECT_THAT(html, HasSubstr("data-wide=\"\""));
  EXPECT_THAT(html, HasSubstr("data-high=\"\""));
  EXPECT_THAT(html, HasSubstr("data-breaks=\"\""));
  EXPECT_THAT(html, HasSubstr("data-tools=\"\""));
  EXPECT_THAT(html, HasSubstr("data-folded=\"\""));
}

TEST_F(ReportInBrowser, PrintsAsAReportWithPlotsInOnePiece) {
  if (std::string(SOFTARM_PLOTLY).empty()) GTEST_SKIP() << "no plotly.js";
  if (!there_is("pdftotext")) GTEST_SKIP() << "no pdftotext";
  const std::vector<std::string> pages = printed(testing::example_diagnosis());
  ASSERT_GE(pages.size(), 2U);
  EXPECT_LE(pages.size(), 20U);
  EXPECT_THAT(pages[0], HasSubstr("EXPLAINED"));
  for (std::size_t i = 0; i < pages.size(); ++i)
    EXPECT_GT(words_of(pages[i]), 10) << "page " << i + 1;  // its number alone is three
  // A plot's last words are on the page of its heading.
  const std::vector<std::pair<std::string, std::string>> plots{
      {"How much better on unseen trials", "by a model fitted to the others / mm"},
      {"Estimates, before and with this in the model", "off the estimate with the effects in the model"},
      {"The tip, measured and predicted", "time / s"},
      {"The arm, before and after", "across that plane / mm"},
      {"Where along the arm", "s / mm"},
      {"With which input", "/ kPa"}};  // between marks of its name
  std::string all;
  for (const std::string& page : pages) {
    all += page;
    for (const auto& [heading, last] : plots) {
      if (page.find(heading) != std::string::npos) {
        EXPECT_THAT(page, HasSubstr(last)) << heading;
      }
    }
  }
  EXPECT_THAT(all, HasSubstr("base_compliance"));
  for (const auto& [heading, last] : plots) EXPECT_THAT(all, HasSubstr(heading));
  EXPECT_THAT(all, HasSubstr("doi:10.1111/j.1467-9868.2010.00740.x"));
  for (const char* tool : {"show in 3D", "copy the command", "copy arm_extended"})
    EXPECT_THAT(all, Not(HasSubstr(tool)));
}

}  // namespace
}  // namespace softarm::diagnose
