#include "table_page.h"

#include <fmt/format.h>

#include "json.h"
#include "page_text.h"

namespace softarm::report {
namespace {

constexpr const char* kTablePage = "table.html";

Json data_of(const TablePage& page) {
  Json json{{"title", page.title}, {"kicker", page.kicker}, {"verdict", page.verdict}, {"whole", page.whole}};
  json["figures"] = Json::array();
  for (const auto& [value, meaning] : page.figures) json["figures"].push_back({value, meaning});
  json["columns"] = Json::array();
  for (const TablePage::Column& column : page.columns)
    json["columns"].push_back({{"heading", column.heading},
                               {"numbers", column.kind == TablePage::Column::kNumbers},
                               {"wide", column.kind == TablePage::Column::kWide}});
  json["rows"] = Json::array();
  for (const TablePage::Row& row : page.rows) {
    Json cells = Json::array();
    for (const TablePage::Cell& cell : row.cells) {
      cells.push_back({{"text", cell.text}});
      if (cell.number) cells.back()["number"] = *cell.number;
      if (!cell.link.empty()) cells.back()["link"] = cell.link;
    }
    json["rows"].push_back({{"cells", cells}, {"marked", row.marked}});
  }
  json["notes"] = page.notes;
  drop_not_finite(json);
  return json;
}

/// For a browser that runs no scripts.
std::string text_of(const TablePage& page) {
  std::string text = fmt::format("{}\n{}\n\n", page.title, page.verdict);
  for (const TablePage::Row& row : page.rows) {
    for (std::size_t i = 0; i < row.cells.size() && i < page.columns.size(); ++i)
      if (!row.cells[i].text.empty())
        text += fmt::format("{}{}: {}", i == 0 ? "" : "; ", page.columns[i].heading, row.cells[i].text);
    text += "\n";
  }
  return text;
}

}  // namespace

PageFiles read_table_page_files(const std::filesystem::path& folder) {
  return read_page(folder, kTablePage);
}

std::string to_html(const TablePage& page, const PageFiles& files) {
  const std::string data = inside_script(dump(data_of(page), -1));
  const std::string nonce = nonce_of(data);
  return filled_page(files, kTablePage, [&](const std::string& place) -> std::optional<std::string> {
    if (place == "title") return escaped(as_utf8(page.title));
    if (place == "text") return escaped(as_utf8(text_of(page)));
    if (place == "data") return data;
    if (place == "nonce") return nonce;
    return std::nullopt;
  });
}

}  // namespace softarm::report
