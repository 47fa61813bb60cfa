#include "record/html.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

namespace html_test {

using namespace knap;

TEST_CASE("the captions of a slider are read back as they were") {
    const std::string captions[]{"speed, t = 40 us", "a < b && \"c\"", "C:\\runs\\1", "</script><b>σ_{xx}</b>",
                                 "don't"};
    std::vector<std::pair<std::string, std::string>> pictures;
    for (const std::string& caption : captions) pictures.emplace_back("RIFF", caption);
    const std::string page = html_slider(pictures), start = "id=\"pictures\">";
    const std::size_t begin = page.find(start) + start.size();
    const std::string list = page.substr(begin, page.find("</script>", begin) - begin);
    const auto read = nlohmann::json::parse(list);  // as the script of the page does, without entities
    REQUIRE(read.size() == std::size(captions));
    for (std::size_t i = 0; i < read.size(); ++i) {
        CHECK(read[i][0] == "data:image/webp;base64,UklGRg==");
        CHECK(read[i][1] == captions[i]);
    }
    CHECK(page.find("<figcaption>don&#39;t</figcaption>") != std::string::npos);  // but the page itself has entities
}

}  // namespace html_test
