#include "record/html.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"
#include "figures/animation.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <sstream>

namespace knap {
namespace {

constexpr std::size_t max_whole = 1'300'000;  // [byte] of pictures that are kept as they are
constexpr int small_width = 900;              // [pixel] of further ones

/// "2026-11-29 12:30:05 UTC"
std::string time_of_day(std::time_t when) {
    std::tm parts{};
    std::array<char, 32> text{};
    std::strftime(text.data(), text.size(), "%F %T UTC", gmtime_r(&when, &parts));
    return text.data();
}

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

/// Whether a cell does not go over two lines: a short one, or a number with its unit or its deviation.
bool stays_whole(const std::string& cell) {
    constexpr std::size_t short_cell = 8, longest_number = 24;  // [character] "161.3 ns", "-6.729e-16 kg m/s"
    const bool is_number = cell.find_first_of("0123456789") == cell.find_first_not_of("+-.");
    return n_characters(cell) <= (is_number ? longest_number : short_cell);
}

/// The text of a cell, whose names may break behind each underscore.
std::string cell_text(const std::string& cell) {
    std::string text;
    for (const char c : html_text(cell)) text += c == '_' ? std::string("_<wbr>") : std::string(1, c);
    return text;
}

/// Whether the columns fit A4 although no name breaks elsewhere.
bool fits_paper(const HtmlRow& header, const std::vector<HtmlRow>& rows) {
    constexpr std::size_t most = 125;  // [character] of 6.5 pt with their gaps
    std::size_t sum = 0;
    for (std::size_t k = 0; k < rows[0].size(); ++k) {
        std::size_t longest = 0, length = 0;
        const auto add = [&](const HtmlRow& row) {
            for (const char c : k < row.size() ? row[k] + ' ' : " ") {
                longest = std::max(longest, length += c == ' ' ? 0 : 1);
                if (c == ' ' || c == '_') length = 0;
            }
        };
        add(header);
        for (const HtmlRow& row : rows) add(row);
        sum += longest + 1;
    }
    return sum <= most;
}

std::string cells(const HtmlRow& row, const char* kind) {
    std::string text = "<tr>";
    for (const std::string& cell : row)
        text += std::string("<") + kind + (stays_whole(cell) ? " class=\"short\">" : ">") + cell_text(cell) + "</" +
                kind + ">";
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
    constexpr std::size_t widest_on_phones = 4;  // [column] a wider table scrolls, and is small on paper
    const std::string kind = rows[0].size() <= widest_on_phones ? ""
                             : fits_paper(header, rows)         ? " class=\"wide\""
                                                                : " class=\"wide widest\"";
    std::string text = "<div class=\"table\"><table" + kind + ">\n" +
                       (header.empty() ? "" : "<thead>" + cells(header, "th") + "</thead>\n");
    for (const HtmlRow& row : rows) text += cells(row, "td");
    return text + "</table></div>\n";
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
           "]</script>\n<script>" + report_frames + "</script>\n";
}

std::string html_picture(const std::string& bytes, const std::string& caption) {
    return "<figure><img alt=\"" + html_text(caption) + "\" src=\"" + address_of("webp", bytes) + "\">\n<figcaption>" +
           html_text(caption) + "</figcaption></figure>\n";
}

std::string html_figures(const std::vector<std::filesystem::path>& files,
                         const std::function<std::string(const std::filesystem::path&)>& caption) {
    struct File {
        std::filesystem::path path;
        std::size_t size;
        bool whole = false;
    };
    std::vector<File> found;
    std::error_code gone;
    const auto place_of = [](const std::filesystem::path& path) {
        return (path.parent_path().filename() == "figures" ? "figures/" : "") + html_text(path.filename().string());
    };
    std::string others;  // that no page shows, or that are too large for it
    const auto name_only = [&](const std::filesystem::path& path) {
        others += (others.empty() ? "" : ", ") + ("<a href=\"" + place_of(path) + "\">" + place_of(path) + "</a>");
    };
    for (const auto& path : files) {
        const std::string ending = path.extension().string();
        const std::size_t size = std::filesystem::file_size(path, gone);
        if (!gone && (ending == ".png" || ending == ".svg" || ending == ".webp" || ending == ".gif"))
            found.push_back({path, size});
        else if (!gone) name_only(path);
    }
    std::vector<File*> by_size;
    for (File& file : found) by_size.push_back(&file);
    std::ranges::stable_sort(by_size, {}, &File::size);
    std::size_t taken = 0;
    for (File* file : by_size) file->whole = (taken += file->size) <= max_whole;
    std::string text;
    for (const auto& [path, size, whole] : found) {
        const std::string ending = path.extension().string(), type = ending == ".svg" ? "svg+xml" : ending.substr(1);
        if (!whole && ending != ".png") {
            name_only(path);
            continue;
        }
        const std::string words = html_text(caption(path));
        text += "<figure><img alt=\"" + (words.empty() ? place_of(path) : words) + "\" src=\"" +
                (whole ? address_of(type, read_whole_file(path)) : address_of("webp", webp_of_png(path, small_width))) +
                "\">\n<figcaption>" + words + (words.empty() ? "" : " · ") + place_of(path) +
                "</figcaption></figure>\n";
    }
    return (text.empty() ? "" : "<div class=\"figures\">\n" + text + "</div>\n") +
           (others.empty() ? "" : "<p>Beside this page: " + others + "</p>\n");
}

std::string html_page(const std::string& title, const std::string& question, const std::string& body) {
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
           html_text(title) + "</title>\n<style>" + report_style + "</style>\n</head>\n<body>\n<h1>" +
           html_text(title) + "</h1>\n" +
           (question.empty() ? "" : "<p class=\"question\">" + html_text(question) + "</p>\n") + body +
           "</body>\n</html>\n";
}

std::string html_live(const std::string& kind, const std::string& state, const std::string& again, double period,
                      double part) {
    const std::string seconds = std::to_string(std::lround(std::max(period, 1.)));
    const std::time_t now = std::time(nullptr);
    return "<p id=\"live\" data-kind=\"" + kind + "\" data-written=\"" + std::to_string(now) + "\" data-period=\"" +
           seconds + "\" data-again=\"" + html_text(again) + "\"><span id=\"now\">This " + kind +
           " goes on, or was killed since: </span>" + html_text(state) + ". Written at " + time_of_day(now) +
           ".</p>\n<progress aria-label=\"progress\" value=\"" + formatted("%.3f", part) + "\"></progress>\n<script>" +
           report_live + "</script>\n<noscript><meta http-equiv=\"refresh\" content=\"" + seconds + "\"></noscript>\n";
}

std::string question_of(const std::string& scenario) {
    std::istringstream lines(scenario);
    std::string text;
    for (std::string line; std::getline(lines, line) && line.starts_with('#');) {
        if (line.starts_with("#:")) continue;  // for editors
        const std::string words(trimmed(std::string_view(line).substr(1)));
        if (words.empty()) return "";
        text += (text.empty() ? "" : " ") + words;
        if (const std::size_t end = text.find('?'); end != std::string::npos) return text.substr(0, end + 1);
    }
    return "";
}

}  // namespace knap
