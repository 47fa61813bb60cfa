#include "record/html.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"
#include "figures/animation.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <sstream>

namespace knap {
namespace {

constexpr std::size_t max_whole = 1'300'000;  // [byte] of pictures that are kept as they are
constexpr int small_width = 900;              // [pixel] of further ones

const char* const style = R"(
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #222; max-width: 60em; margin: 2em auto;
       padding: 0 1em }
h1 { font-size: 1.6em; margin: 0 }
h2 { font-size: 1.15em; margin: 1.8em 0 .5em; border-bottom: 1px solid #ccc }
.question { font-style: italic; margin: .3em 0 1em }
.bad { color: #a11 }
.bad li, .warn li { list-style: "\26A0  "; margin: .2em 0 }
table { border-collapse: collapse; font-size: .9em }
th, td { text-align: left; vertical-align: top; padding: .15em .9em .15em 0; border-bottom: 1px solid #e4e4e4 }
td { font-variant-numeric: tabular-nums; overflow-wrap: break-word }
figure { margin: 0 0 1em; break-inside: avoid }
img { max-width: 100%; height: auto }
figcaption { color: #555; font-size: .85em }
pre { white-space: pre-wrap; overflow-wrap: anywhere; background: #f6f6f6; padding: .6em; font-size: .85em }
input[type=range] { width: 100% }
.figures { display: grid; grid-template-columns: 1fr 1fr; gap: 0 1em }
.figures > :only-child { grid-column: 1 / -1 }
.short { white-space: nowrap }
@page { size: A4; margin: 15mm }
@media print {
  body { margin: 0; max-width: none; font-size: 10pt }
  .screen, details { display: none }
  tr { break-inside: avoid }
  h2 { break-after: avoid }
}
)";

const char* const moving = R"(
const box = document.getElementById("frames"), line = box.querySelector("input"), picture = box.querySelector("img");
const all = JSON.parse(document.getElementById("pictures").textContent);
const show = () => { const [address, words] = all[line.value]; picture.src = address;
                     box.querySelector("figcaption").textContent = words; };
let playing = 0;
line.oninput = show;
box.querySelector("button").onclick = () => {
  if (playing) { clearInterval(playing); playing = 0; return; }
  if (line.value == line.max) line.value = 0;
  playing = setInterval(() => { if (line.value == line.max) { clearInterval(playing); playing = 0; } else line.value++;
                                show(); }, 250);
};
addEventListener("beforeprint", () => { line.value = line.max; show(); });
)";

std::string base64(std::string_view bytes) {
    constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve(4 * (bytes.size() / 3 + 1));
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t k = 0; k < 3; ++k)
            three = three << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= n ? letters[three >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string address_of(const std::string& type, std::string_view bytes) {
    return "data:image/" + type + ";base64," + base64(bytes);
}

/// A string of JSON inside a <script>, which entities do not end and "</script>" would.
std::string json_text(const std::string& text) {
    std::string quoted;
    for (const char c : nlohmann::json(printable(text)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))
        quoted += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return quoted;
}

std::string cells(const HtmlRow& row, const char* kind) {
    constexpr std::size_t short_cell = 8;  // [character] as "161.3 ns", which must not go over two lines
    std::string text = "<tr>";
    for (const std::string& cell : row)
        text += std::string("<") + kind + (n_characters(cell) <= short_cell ? " class=\"short\">" : ">") +
                html_text(cell) + "</" + kind + ">";
    return text + "</tr>\n";
}

}  // namespace

std::string html_text(std::string_view text) {
    std::string escaped;
    for (const char c : printable(std::string(text)))
        escaped += c == '&'    ? std::string("&amp;")
                   : c == '<'  ? "&lt;"
                   : c == '>'  ? "&gt;"
                   : c == '"'  ? "&quot;"
                   : c == '\'' ? "&#39;"
                               : std::string(1, c);
    return escaped;
}

std::string html_table(const HtmlRow& header, const std::vector<HtmlRow>& rows) {
    if (rows.empty()) return "";
    std::string text = "<table>\n" + (header.empty() ? "" : "<thead>" + cells(header, "th") + "</thead>\n");
    for (const HtmlRow& row : rows) text += cells(row, "td");
    return text + "</table>\n";
}

std::string html_section(const std::string& heading, const std::string& content) {
    return content.empty() ? "" : "<h2>" + html_text(heading) + "</h2>\n" + content;
}

std::string html_list(const std::vector<std::string>& items, const std::string& style_name) {
    if (items.empty()) return "";
    std::string text = "<ul class=\"" + style_name + "\">\n";
    for (const std::string& item : items) text += "<li>" + html_text(item) + "</li>\n";
    return text + "</ul>\n";
}

std::string html_of_markdown(const std::string& markdown) {
    std::istringstream lines(markdown);
    std::string html;
    HtmlRow header, items;
    std::vector<HtmlRow> rows;
    const auto close = [&] {
        html += html_table(header, rows) + html_list(items);
        header.clear(), rows.clear(), items.clear();
    };
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("|--")) continue;
        if (line.starts_with("| ")) {
            HtmlRow row;
            std::istringstream parts(line.substr(1));
            for (std::string cell; std::getline(parts, cell, '|');) row.emplace_back(trimmed(cell));
            (header.empty() ? header : rows.emplace_back()) = row;
        } else if (line.starts_with("- ")) {
            items.push_back(line.substr(2));
        } else {
            close();
            if (!line.empty()) html += "<h3>" + html_text(line) + "</h3>\n";
        }
    }
    close();
    return html;
}

std::string html_slider(const std::vector<std::pair<std::string, std::string>>& pictures) {
    if (pictures.empty()) return "";
    std::string list;
    for (const auto& [bytes, caption] : pictures)
        list += (list.empty() ? "[\"" : ",\n[\"") + address_of("webp", bytes) + "\", " + json_text(caption) + "]";
    const std::string last = std::to_string(pictures.size() - 1), &caption = pictures.back().second;
    return "<figure id=\"frames\"><img alt=\"" + html_text(caption) + "\" src=\"" +
           address_of("webp", pictures.back().first) + "\">\n<figcaption>" + html_text(caption) +
           "</figcaption>\n<div class=\"screen\"><button type=\"button\">play / stop</button>\n"
           "<input type=\"range\" min=\"0\" max=\"" +
           last + "\" value=\"" + last +
           "\" aria-label=\"time\"></div></figure>\n<script type=\"application/json\" id=\"pictures\">[" + list +
           "]</script>\n<script>" + moving + "</script>\n";
}

std::string html_figures(const std::vector<std::filesystem::path>& files) {
    struct File {
        std::filesystem::path path;
        std::size_t size;
        bool whole = false;
    };
    std::vector<File> found;
    std::error_code gone;
    for (const auto& path : files) {
        const std::string ending = path.extension().string();
        const std::size_t size = std::filesystem::file_size(path, gone);
        if (!gone && (ending == ".png" || ending == ".svg" || ending == ".webp" || ending == ".gif"))
            found.push_back({path, size});
    }
    std::vector<File*> by_size;
    for (File& file : found) by_size.push_back(&file);
    std::ranges::stable_sort(by_size, {}, &File::size);
    std::size_t taken = 0;
    for (File* file : by_size) file->whole = (taken += file->size) <= max_whole;
    std::string text;
    for (const auto& [path, size, whole] : found) {
        const std::string ending = path.extension().string(), type = ending == ".svg" ? "svg+xml" : ending.substr(1);
        if (!whole && ending != ".png") continue;
        const std::string name = html_text(path.filename().string());
        text += "<figure><img alt=\"" + name + "\" src=\"" +
                (whole ? address_of(type, read_whole_file(path)) : address_of("webp", webp_of_png(path, small_width))) +
                "\">\n<figcaption>" + (path.parent_path().filename() == "figures" ? "figures/" : "") + name +
                "</figcaption></figure>\n";
    }
    return text.empty() ? "" : "<div class=\"figures\">\n" + text + "</div>\n";
}

std::string html_page(const std::string& title, const std::string& question, const std::string& body) {
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
           html_text(title) + "</title>\n<style>" + style + "</style>\n</head>\n<body>\n<h1>" + html_text(title) +
           "</h1>\n" + (question.empty() ? "" : "<p class=\"question\">" + html_text(question) + "</p>\n") + body +
           "</body>\n</html>\n";
}

std::string question_of(const std::string& scenario) {
    std::istringstream lines(scenario);
    std::string text;
    for (std::string line; std::getline(lines, line) && line.starts_with('#');) {
        const std::string words(trimmed(std::string_view(line).substr(1)));
        if (words.empty()) return "";
        text += (text.empty() ? "" : " ") + words;
        if (const std::size_t end = text.find('?'); end != std::string::npos) return text.substr(0, end + 1);
    }
    return "";
}

}  // namespace knap
