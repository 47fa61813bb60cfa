#pragma once
// report.html: one page that holds its pictures, needs no network, and prints on A4.
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace knap {

/// report.css, report_live.js and report_frames.js of this folder.
extern const char *const report_style, *const report_live, *const report_frames;

/// The text with its special characters escaped.
std::string html_text(std::string_view text);

using HtmlRow = std::vector<std::string>;
/// Cells are texts.
std::string html_table(const HtmlRow& header, const std::vector<HtmlRow>& rows);

/// A heading with what follows; empty where nothing does.
std::string html_section(const std::string& heading, const std::string& content);

/// A list, as of warnings; empty without items.
std::string html_list(const std::vector<std::string>& items, const std::string& style = "");

/// The Markdown that the program writes itself: tables, lists and paragraphs.
std::string html_of_markdown(const std::string& text);

/// A slider over pictures of .webp, each with its caption; the last one is shown first and printed.
std::string html_slider(const std::vector<std::pair<std::string, std::string>>& pictures);

/// Pictures of files inside the page: the smallest ones as they are up to a total size, further ones smaller. Files of
/// other kinds, and files that no longer exist, are left out. `caption`: what a file shows, in words, or "".
std::string html_figures(const std::vector<std::filesystem::path>& files,
                         const std::function<std::string(const std::filesystem::path&)>& caption);

/// One picture of .webp.
std::string html_picture(const std::string& bytes, const std::string& caption);

/// All of it. `question`: below the title.
std::string html_page(const std::string& title, const std::string& question, const std::string& body);

/// A line about a run, study or sweep (`kind`) that goes on, with the time of day; the page loads itself again every
/// `period` [s]. Where it no longer changes it says that the run has ended, since one that was killed cannot, and what
/// the same command does: `again`. `part` of its work is done.
std::string html_live(const std::string& kind, const std::string& state, const std::string& again, double period,
                      double part);

/// The first comment of a scenario up to its question mark; empty where it does not ask.
std::string question_of(const std::string& scenario);

}  // namespace knap
