#include "observe/figures.hpp"

#include "base/error.hpp"
#include "observe/body_figures.hpp"
#include "observe/curve_figures.hpp"
#include "observe/rock_figures.hpp"
#include "observe/ticks.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

namespace {

bool among(const std::vector<std::string>& words, const std::string& word) { return std::find(words.begin(), words.end(), word) != words.end(); }

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

void check(const FigureOptions& options) {
    if (!among(figure_subjects(), options.show))
        throw UserError("figure-show", "`" + options.show + "` is nothing a figure can show", "known: " + joined(figure_subjects()));
    if (!among(figure_colours(), options.colour))
        throw UserError("figure-colour", "`" + options.colour + "` is nothing cracks can be coloured by", "known: " + joined(figure_colours()));
    if (!std::isfinite(options.deform)) throw UserError("figure-deform", "displacements cannot be drawn " + std::to_string(options.deform) + " times as large");
    if (options.range.size() == 2 && !(options.range[0] < options.range[1])) throw UserError("figure-range", "a colour range must ascend");
    if (options.box && !(options.box->low.array() < options.box->high.array()).all()) throw UserError("figure-box", "a box is given by its lower left and its upper right corner");
    if (options.width < 200 || options.width > 20000)
        throw UserError("figure-width", "a figure is 200 to 20000 pixels wide, not " + std::to_string(options.width));
}

/// With several times asked for, the one nearest to the frame's is put before the ending.
std::filesystem::path file_name(const FigureOptions& options, double time) {
    std::filesystem::path file = options.file;
    if (options.at.size() < 2) return file;
    const double asked = *std::min_element(options.at.begin(), options.at.end(),
                                           [&](double a, double b) { return std::abs(a - time) < std::abs(b - time); });
    return file.replace_filename(file.stem().string() + "_" + time_text(asked, true) + file.extension().string());
}

Chart chart_of(const FigureOptions& options, const Histories& histories, const FigureContext& context) {
    if (options.show == "energy") return energy_chart(histories.energy);
    if (options.show == "crack_length") return crack_length_chart(histories.cracks);
    if (options.show == "reactions") return reaction_chart(histories.reactions);
    if (options.show == "probes") return probe_chart(histories.probes);
    if (options.show == "stress_strain") return stress_strain_chart(histories.stress_strain);
    if (options.show == "breaks") return break_chart(histories.breaks, histories.energy.column("time").front(), histories.energy.column("time").back());
    if (options.show == "fragments") return fragment_size_chart(histories.fragments);
    return crack_speed_chart(histories.cracks, context.rayleigh_speed);
}

/// What a run did not write cannot be drawn afterwards.
void check_there(const std::string& show, const Histories& histories) {
    const auto needs = [&](const History& table, const char* note) {
        if (table.columns.empty()) throw UserError("nothing-to-show", "the run has nothing that `" + show + "` could show", note);
    };
    if (show == "stress_strain") needs(histories.stress_strain, "it needs a [specimen] in the scenario");
    if (show == "breaks" || show == "rose") needs(histories.breaks, "it needs output.breaks = true");
    if (show == "fragments") needs(histories.fragments, "fragments.csv is written at the end of a run");
}

}  // namespace

std::vector<std::string> figure_fields() {
    std::vector<std::string> names;
    for (const BodyField& field : body_fields()) names.push_back(field.name);
    return names;
}

std::vector<std::string> figure_subjects() {
    std::vector<std::string> names{"cracks", "materials"};
    for (const std::string& field : figure_fields()) names.push_back(field);
    names.insert(names.end(), {"energy", "crack_length", "crack_speed", "reactions", "probes", "stress_strain", "breaks", "rose", "fragments"});
    return names;
}

std::vector<std::string> figure_colours() { return {"opening", "beta"}; }

bool shows_body(const std::string& subject) { return subject == "cracks" || subject == "materials" || among(figure_fields(), subject); }

std::vector<std::filesystem::path> draw_figure(const FigureOptions& options, const Frame& frame, const Histories& histories,
                                               const FigureContext& context, const std::filesystem::path& directory) {
    check(options);
    const std::string title = options.title.empty() ? context.title : options.title;
    if (shows_body(options.show)) {
        const std::filesystem::path file = directory / file_name(options, frame.time);
        if (options.show == "materials") return {draw_materials(options, frame, context.materials, title, file).file};
        return {(options.show == "cracks" ? draw_cracks : draw_field)(options, frame, title, file).file};
    }
    check_there(options.show, histories);
    if (options.show == "rose") return {draw_rose(histories.breaks, title, directory / options.file, options.width).file};
    Chart chart = chart_of(options, histories, context);
    if (!title.empty()) chart.title = title;
    return {draw_chart(chart, directory / options.file, options.width).file};
}

}  // namespace knap
