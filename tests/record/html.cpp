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

TEST_CASE("a live page loads itself again and a question is found below a line for editors") {
    const std::string page = html_page("t", "", html_live("sweep", "half <way>", "starts it again", 4, 0.25));
    CHECK(page.find("<progress aria-label=\"progress\" value=\"0.250\">") != std::string::npos);
    CHECK(page.find("half &lt;way&gt;") != std::string::npos);
    CHECK(page.find("location.reload()") != std::string::npos);
    CHECK(page.find("data-period=\"4\"") != std::string::npos);
    CHECK(page.find("data-again=\"starts it again\"") != std::string::npos);
    CHECK(html_page("t", "", "").find("reload") == std::string::npos);
    CHECK(question_of("#:schema knap.schema.json\n# Does it\n# run?\n") == "Does it run?");
}

}  // namespace html_test
