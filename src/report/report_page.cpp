#include "page_data.h"
#include "page_text.h"
#include "softarm/report/report.h"

namespace softarm::report {
namespace {

constexpr const char* kPage = "page.html";

}  // namespace

PageFiles read_page_files(const std::filesystem::path& folder) {
  return read_page(folder, kPage);
}

std::string to_html(const diagnose::Diagnosis& diagnosis, const PageFiles& files, const Origin& origin) {
  const std::string data = inside_script(dump(page_data(diagnosis, origin), -1));
  const std::string nonce = nonce_of(data);
  return filled_page(files, kPage, [&](const std::string& place) -> std::optional<std::string> {
    if (place == "title") return escaped(as_utf8(diagnosis.arm));
    if (place == "text") return escaped(as_utf8(describe(diagnosis)));
    if (place == "data") return data;
    if (place == "nonce") return nonce;
    return std::nullopt;
  });
}

}  // namespace softarm::report
